//! The examples of the crates, run as their head comments describe.

use crate::program::{self, Finished};
use std::collections::BTreeSet;
use std::path::Path;

/// Runs an example of a crate in `folder`, with the arguments of a command line, separated by blanks.
pub fn run(package: &str, example: &str, folder: &Path, command_line: &str) -> Finished {
    let place = Path::new("examples").join(example);
    let mut target = vec!["-p", package, "--example", example];
    if package == "ddl-forecast" {
        target.extend(["--features", "report"]);
    }
    let path = program::built(&place, &target);
    let output = program::undisturbed(&path, folder, command_line).output();
    let output = output.expect("the example can be started");
    Finished::new(format!("{example} {command_line}"), &output)
}

/// The names of a crate's examples: `examples/NAME.rs` and `examples/NAME/main.rs`; none without a folder of them.
pub fn all_of(folder: &Path) -> BTreeSet<String> {
    let folder = folder.join("examples");
    if !folder.is_dir() {
        return BTreeSet::new();
    }
    let entries = std::fs::read_dir(&folder).expect("a folder can be listed");
    let name = |path: &Path| -> Option<String> {
        let is_one = path.extension().is_some_and(|e| e == "rs") || path.join("main.rs").is_file();
        is_one.then(|| path.file_stem().unwrap_or_default().to_string_lossy().into_owned())
    };
    entries
        .filter_map(|entry| name(&entry.expect("a folder can be listed").path()))
        .collect()
}
