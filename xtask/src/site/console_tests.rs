//! Every `cargo xtask` line of the documentation is understood by this program.

use std::path::PathBuf;

use clap::Parser as _;

use super::console;
use crate::Arguments;
use crate::workspace::Workspace;

/// Every page that shows commands.
fn pages(workspace: &Workspace) -> Vec<PathBuf> {
    let files = workspace.files().unwrap();
    files
        .into_iter()
        .filter(|file| file.extension().is_some_and(|extension| extension == "md"))
        .collect()
}

#[test]
fn every_call_of_this_program_in_the_documentation_is_one() {
    let workspace = Workspace::find().unwrap();
    let mut understood = 0;
    for page in pages(&workspace) {
        let text = std::fs::read_to_string(workspace.root().join(&page)).unwrap();
        for command in console::commands(&text) {
            let place = format!("{}:{}: {}", page.display(), command.line, command.typed);
            let Some(words) = command.words() else {
                continue;
            };
            let (["cargo", "xtask", arguments @ ..] | ["./xtask", arguments @ ..]) =
                words.as_slice()
            else {
                continue;
            };
            let parsed = Arguments::try_parse_from(["cargo xtask"].iter().chain(arguments));
            assert!(parsed.is_ok(), "{place}\n{}", parsed.unwrap_err());
            understood += 1;
        }
    }
    assert!(understood > 10, "only {understood} calls were found");
}

#[test]
fn a_call_that_is_none_is_seen() {
    assert!(Arguments::try_parse_from(["cargo xtask", "docs", "--no-such-option"]).is_err());
}
