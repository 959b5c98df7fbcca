//! Shared code of the cross-crate and command-line tests. The test target `it` needs no libtorch; `it_torch` trains
//! (feature `torch`).

#![allow(clippy::missing_panics_doc, reason = "a test may panic")]

pub mod bits;
pub mod chance;
pub mod console;
pub mod crowd;
pub mod drawn_model;
pub mod folder_contents;
pub mod golden;
pub mod guide;
pub mod made;
#[cfg(unix)]
pub mod mount;
pub mod nightly;
#[cfg(unix)]
pub mod offline;
pub mod outside_bytes;
pub mod own_tracks;
pub mod place;
pub mod processes;
pub mod program;
pub mod progress;
pub mod recordings;
pub mod safetensors_file;
pub mod skip;
#[cfg(feature = "torch")]
pub mod trained_model;
