//! Outputs where nothing may be written, or where there is no folder.

use super::folder_with_model;
use ddl_tests::mount::Mount;
use ddl_tests::{figures, folder_contents, program};

const EVALUATE: &str = "evaluate --model run --protocol fair --test-walkers 20 --threads 1 --out";

fn outputs(folder: &str) -> Vec<String> {
    vec![
        format!("train --convention simulated --fold plaza --threads 1 --out {folder}/new"),
        format!("forecast --model run tracks.csv --output {folder}/forecasts.csv"),
        format!("goals --model run tracks.csv --whole --output {folder}/goals.csv"),
        format!("pack --model run --out {folder}/packed"),
        format!("windows --convention simulated --fold corridor --output {folder}/windows.jsonl"),
        format!("{EVALUATE} {folder}/report"),
        format!("report run --out {folder}/page"),
        format!("forecast - --frame-step 1 --model run --output {folder}/live.csv"),
    ]
}

#[test]
fn a_read_only_directory_is_named() {
    let folder = folder_with_model();
    let here = folder.path();
    let fixed = here.join("fixed");
    // results to make a report of
    let _ = program::run(here, &format!("{EVALUATE} made")).succeeds();
    std::fs::rename(here.join("run"), here.join("fixed")).unwrap();
    std::os::unix::fs::symlink("fixed", here.join("run")).unwrap();
    let Some(_mounted) = Mount::read_only(&fixed) else {
        return;
    };
    let before = folder_contents::read(&fixed);
    for command in outputs("fixed") {
        let message = program::run(here, &command).fails();
        assert!(
            message.contains("fixed") && message.contains("choose a place"),
            "{message}"
        );
    }
    // a model there is read as anywhere, and measured again without writing
    let _ = program::run(here, "forecast --model run tracks.csv").succeeds();
    let _ = program::run(here, &format!("{EVALUATE} again")).succeeds();
    let after = folder_contents::read(&fixed);
    assert_eq!(
        folder_contents::differences(&before, &after),
        Vec::<String>::new()
    );
    figures::tell(
        "output on a read-only file system",
        format!("{} commands", outputs("").len()),
        "each named, nothing written; models there are read",
    );
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let folder = folder_with_model();
    let here = folder.path();
    let _ = program::run(here, &format!("{EVALUATE} made")).succeeds();
    let before = folder_contents::read(here);
    for command in outputs("tracks.csv") {
        let message = program::run(here, &command).fails();
        assert!(message.contains("tracks.csv"), "{message}");
    }
    // folders of runs and reports are made, those of single files are not
    let single: Vec<String> = outputs("nowhere")
        .into_iter()
        .filter(|command| {
            !["train", "evaluate", "report"]
                .iter()
                .any(|made| command.starts_with(made))
        })
        .collect();
    for command in &single {
        let message = program::run(here, command).fails();
        assert!(message.contains("nowhere"), "{message}");
    }
    let after = folder_contents::read(here);
    assert_eq!(
        folder_contents::differences(&before, &after),
        Vec::<String>::new()
    );
    figures::tell(
        "output below a file, or in a folder that is not there",
        format!("{} commands", outputs("").len() + single.len()),
        "each named, nothing written",
    );
}
