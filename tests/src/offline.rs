//! The program without a network, with the means of Linux.

use crate::place::Place;
use crate::program::{self, Finished};
use std::path::Path;
use std::process::Command;

/// The command that runs a program without the network.
pub type Way = &'static [&'static str];

/// The `unshare` command with the options that this user needs; `None`, with the reason printed, if it is not
/// permitted.
pub fn way() -> Option<Way> {
    let ways: [Way; 2] = [&["unshare", "-n"], &["unshare", "-r", "-n"]];
    for way in ways {
        let mut command = Command::new(way[0]);
        let output = command.args(&way[1..]).args(["cat", "/proc/net/dev"]).output();
        if let Some(output) = output.ok().filter(|output| output.status.success()) {
            let interface_table = String::from_utf8_lossy(&output.stdout);
            let lines = interface_table.lines().skip(2);
            let names: Vec<_> = lines.filter_map(|line| line.trim().split(':').next()).collect();
            assert_eq!(names, ["lo"], "more than the loopback interface, which is down");
            return Some(way);
        }
    }
    eprintln!("skipped: a process may not leave the network here (`unshare -n`)");
    None
}

/// Runs the program without a network.
pub fn run(way: Way, place: &Place, line: &str) -> Finished {
    let mut command = program::undisturbed(Path::new(way[0]), place.path(), "");
    let command = command.args(&way[1..]).arg(program::path()).args(line.split_whitespace());
    let output = command.output().expect("`unshare` can be started");
    Finished::new(format!("without a network: ddl {line}"), &output)
}
