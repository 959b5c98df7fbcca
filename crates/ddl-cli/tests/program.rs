//! The program starts, names itself and its commands. That this test exists also makes `cargo test
//! --workspace` build the program, which the tests of the workspace run.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::process::Command;

fn ddl(argument: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_ddl"))
        .arg(argument)
        .output()
        .unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn it_names_its_version_and_commands() {
    assert_eq!(
        ddl("--version"),
        format!("ddl {}\n", env!("CARGO_PKG_VERSION"))
    );
    let help = ddl("--help");
    for command in [
        "train", "evaluate", "report", "forecast", "goals", "windows", "info",
    ] {
        assert!(help.contains(command), "{command}");
    }
}
