//! What the cross-crate and command-line tests share: recordings, crowds, a tiny trained model, the
//! program `ddl`, and what the tests compare.
//!
//! The test target `it` needs no libtorch; `it_torch` does (feature `torch`, on by default), and runs
//! the program, which `cargo build -p ddl-cli` builds, and so does `faults`, which breaks what can break.

pub mod answer;
pub mod bits;
pub mod console;
pub mod crowd;
pub mod example;
pub mod figures;
pub mod folder_contents;
pub mod goal_lines;
#[cfg(unix)]
pub mod mount;
pub mod other_program;
pub mod outside_bytes;
pub mod own_tracks;
pub mod page_inputs;
pub mod page_run;
pub mod processes;
pub mod program;
pub mod python_packages;
pub mod recordings;
pub mod safetensors_file;
#[cfg(feature = "torch")]
pub mod tiny_model;
pub mod training_result;
pub mod wild_future;
