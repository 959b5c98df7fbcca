//! The program `ddl` as a console script of the package.

use pyo3::prelude::*;
use std::io::Write as _;

/// Runs the program with these arguments, starting with its name, and returns its exit code. The caller must remove
/// Python's handler of Ctrl-C first.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, arguments: Vec<String>) -> u8 {
    py.detach(|| {
        let code = ddl_cli::run(arguments);
        // The program has words of its own.
        crate::errors::word_settings();
        // Python's exit does not flush Rust's standard output. An error means that the reader has closed the output.
        let _ = std::io::stdout().flush();
        code
    })
}
