//! The program `ddl`, as a console script of the package.

use pyo3::prelude::*;
use std::io::Write as _;

/// Runs the program with these arguments, the first of which is its name, and returns its exit code. Python's handler of Ctrl-C must
/// have been taken away before.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, arguments: Vec<String>) -> u8 {
    py.detach(|| {
        let code = ddl_cli::run(arguments);
        // No one else does when the process ends as Python does. Where nobody reads on there is nobody to tell.
        let _ = std::io::stdout().flush();
        code
    })
}
