//! Tests that the program starts and refuses impossible arguments. This test also makes `cargo test --workspace` build
//! the program, which the tests of the workspace run.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::process::Command;

#[test]
fn options_of_the_network_do_not_go_with_forecasts_of_another_program() {
    for option in [["--device", "cpu"], ["--threads", "1"]] {
        let output = Command::new(env!("CARGO_BIN_EXE_ddl"))
            .args(["evaluate", "--fold", "plaza", "--convention", "simulated"])
            .args(["--forecasts", "no such file.jsonl"])
            .args(option)
            .output()
            .unwrap();
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{complaint}");
        assert!(
            complaint.contains("cannot be used with") && complaint.contains(option[0]),
            "{complaint}"
        );
    }
}

#[cfg(not(feature = "torch"))]
#[test]
fn without_libtorch_a_benchmark_tells_how_to_get_it() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_ddl"))
        .args(["benchmark", "--convention", "simulated"])
        .current_dir(&folder)
        .output()
        .unwrap();
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{complaint}");
    let said = complaint.starts_with("error: training needs libtorch, and this program is built without it");
    assert!(said && complaint.lines().count() == 1, "{complaint}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
