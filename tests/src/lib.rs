//! What the cross-crate and command-line tests share: recordings, crowds, a tiny trained model, the
//! program `ddl`, and what the tests compare.
//!
//! The test target `it` needs no libtorch; `it_torch` does (feature `torch`, on by default), and runs
//! the program, which `cargo build -p ddl-cli` builds.

pub mod bits;
pub mod crowd;
pub mod folder_contents;
pub mod goal_lines;
pub mod other_program;
pub mod own_tracks;
pub mod processes;
pub mod program;
pub mod recordings;
#[cfg(feature = "torch")]
pub mod tiny_model;
pub mod wild_future;
