//! Which arguments are refused, and what a given program means.

use super::*;
use clap::Parser;

#[derive(Debug, Parser)]
struct Line {
    #[command(flatten)]
    arguments: Arguments,
}

#[test]
fn a_given_program_is_taken_as_it_is_and_not_published() {
    let parse = |words: &[&str]| {
        let line = Line::try_parse_from(std::iter::once(&"benchmark").chain(words));
        line.map(|line| line.arguments)
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ddl");
    let workspace = Workspace::at(folder.path()).unwrap();
    let path = file.to_str().unwrap();
    let given = parse(&["--program", path]).unwrap();
    assert!(given.has_program() && !parse(&[]).unwrap().has_program());
    let message = given.program(&workspace).unwrap_err().to_string();
    assert!(
        message.contains("is no file: --program takes a built ddl"),
        "{message}"
    );
    // Nothing is set up or built: there is no workspace in that folder.
    fs::write(&file, "").unwrap();
    let (program, commit) = given.program(&workspace).unwrap();
    assert_eq!(program, file);
    assert!(!commit.is_empty());
    assert!(parse(&["--program", path, "--publish"]).is_err());
    assert!(parse(&["--program", path, "--cargo-profile", "dev"]).is_err());
}

#[test]
fn protocols_are_taken_once_in_the_usual_order() {
    let chosen = |words: &[&str]| {
        let line = Line::try_parse_from(std::iter::once(&"benchmark").chain(words)).unwrap();
        protocols(&line.arguments.protocol)
    };
    assert_eq!(chosen(&[]).unwrap(), ["published", "fair", "single"]);
    assert_eq!(chosen(&["--protocol", "fair"]).unwrap(), ["fair"]);
    let words = ["--protocol", "single,fair", "--protocol", "fair"];
    assert_eq!(chosen(&words).unwrap(), ["fair", "single"]);
    let message = chosen(&["--protocol", "honest"]).unwrap_err().to_string();
    assert_eq!(
        message,
        "there is no protocol \"honest\": choose from published, fair, single"
    );
}

#[test]
fn unknown_names_are_refused_with_the_known_ones() {
    let known = VARIANTS.map(str::to_owned);
    check_names("variant", &["star".to_owned()], &known).unwrap();
    let message = check_names("variant", &["ful".to_owned()], &known)
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "there is no variant \"ful\": choose from full, no-goal-shift, no-dynamics, star"
    );
}
