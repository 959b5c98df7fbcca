//! A test that makes `cargo test --workspace` build the program, which the tests of the workspace run.

use std::process::Command;

#[test]
fn the_program_starts() {
    let status = Command::new(env!("CARGO_BIN_EXE_ddl")).arg("--version").status();
    assert!(status.is_ok_and(|status| status.success()));
}
