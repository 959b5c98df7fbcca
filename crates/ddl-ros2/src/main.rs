#![doc = include_str!("../README.md")]

mod graph;
mod health;
mod node;
mod options;
mod place;
mod ros_arguments;
mod transforms;

use ddl_ros::Message as _;
use ddl_ros::msg::{Detection3DArray, People, TrackedPersons};
use std::io::Write as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    let ended = |options: &options::NodeArguments| match options.r#type.as_str() {
        People::TYPE => node::run::<People>(options),
        TrackedPersons::TYPE => node::run::<TrackedPersons>(options),
        _ => node::run::<Detection3DArray>(options),
    };
    match ros_arguments::parse(std::env::args_os()).and_then(|options| ended(&options)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tell(&format!("error: {error:#}"));
            ExitCode::FAILURE
        }
    }
}

/// Writes a line to standard error. A closed standard error is ignored; `eprintln!` would panic.
pub(crate) fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "ddl-ros2: {line}");
}
