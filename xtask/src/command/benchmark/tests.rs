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
    assert_eq!(chosen(&[]).unwrap(), ["fair", "single"]);
    let all = ["--protocol", "single,fair,published"];
    assert_eq!(chosen(&all).unwrap(), ["published", "fair", "single"]);
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

/// What a command line trains, and where the results go.
#[test]
fn the_recipe_and_the_folder_follow_the_protocols() {
    let workspace = Workspace::find().unwrap();
    let chosen = Chosen {
        convention: Convention::Star,
        folder: None,
        reason: "a test".to_owned(),
    };
    let planned = |words: &str| {
        let words = std::iter::once("benchmark").chain(words.split_whitespace());
        let arguments = Line::try_parse_from(words).unwrap().arguments;
        let plan = arguments.plan(&workspace, &chosen).unwrap();
        let out = arguments.out_folder(&workspace, &plan).unwrap();
        let out = out.strip_prefix(workspace.path("runs")).unwrap();
        let train = plan.train_arguments(&plan.tasks[0], Path::new(""), 1);
        let (_, train) = train.split_at(9); // convention, fold, variant and seed
        let end = train.iter().position(|word| word == "--out").unwrap();
        let settings = &plan.settings;
        let scored = settings
            .test_walkers
            .map_or("all".to_owned(), |n| n.to_string());
        format!(
            "{} {} {scored}: {}",
            out.display(),
            plan.tasks.len(),
            train[..end].join(" ")
        )
    };
    let all = "--protocol published,fair,single --profile";
    for (words, expected) in [
        ("", "star-quick 5 2500: --epochs 10 --recipe recommended"),
        (
            "--profile smoke",
            "star-smoke 2 150: --epochs 1 --train-walkers 600 --proposal-steps 40 --recipe recommended",
        ),
        (
            "--profile evening",
            "star-evening 5 all: --epochs 20 --recipe recommended",
        ),
        (
            "--profile paper --protocol single",
            "star-paper 5 all: --epochs 20 --recipe recommended",
        ),
        (
            "--epochs 3 --train-walkers 70 --test-walkers 80",
            "star-quick 5 80: --epochs 3 --train-walkers 70 --recipe recommended",
        ),
        (
            &format!("{all} smoke"),
            "star-smoke-published 2 150: --epochs 1 --train-walkers 600 --proposal-steps 40 --recipe published \
             --batch-walkers 256 --learning-rate 0.0015 --learning-rate-schedule constant",
        ),
        (
            &format!("{all} quick"),
            "star-quick-published 5 2500: --epochs 10 --train-walkers 4000 --recipe published --batch-walkers 16 \
             --learning-rate 0.001 --learning-rate-schedule cosine",
        ),
        (
            &format!("{all} evening"),
            "star-evening-published 5 all: --epochs 60 --recipe published --batch-walkers 256 --learning-rate 0.0015 \
             --learning-rate-schedule cosine",
        ),
        (
            "--profile paper --protocol published",
            "star-paper-published 5 all: --epochs 200 --recipe published --batch-walkers 256 --learning-rate 0.0015 \
             --learning-rate-schedule constant",
        ),
    ] {
        assert_eq!(planned(words), expected, "{words}");
    }
}
