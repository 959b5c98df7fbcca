//! What every command of the program keeps to: help, completions, manual pages, JSON for programs.

use ddl::Variant;
use ddl_tests::{own_tracks, program, tiny_model};
use std::path::Path;

/// A terminal of old.
const LINES: usize = 24;
const COLUMNS: usize = 80;

fn commands(folder: &Path) -> Vec<String> {
    let help = program::run(folder, "--help").succeeds();
    help.lines()
        .filter_map(|line| line.strip_prefix("  "))
        .filter_map(|line| line.split_whitespace().next())
        .map(str::to_owned)
        .collect()
}

#[test]
fn help_fits_a_screen_and_names_the_exit_codes() {
    let place = tempfile::tempdir().unwrap();
    let help = program::run(place.path(), "--help").succeeds();
    assert!(help.lines().count() <= LINES, "{help}");
    for line in help.lines() {
        assert!(line.chars().count() <= COLUMNS, "{line}");
    }
    for words in [
        "Exit codes: 0 done, or whoever read",
        "130 interrupted",
        "forecast",
        "view",
    ] {
        assert!(help.contains(words), "{words}: {help}");
    }
    // Without a command the same is said, as a mistake.
    let bare = program::run(place.path(), "");
    assert_eq!((bare.code, bare.stdout.as_str()), (Some(2), ""));
    assert_eq!(bare.stderr.trim_end(), help.trim_end());
}

#[test]
fn every_command_has_help_completions_and_a_manual_page() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let commands = commands(folder);
    assert!(commands.len() >= 13, "{commands:?}");
    let completions = program::run(folder, "completions bash").succeeds();
    let _ = program::run(folder, "man pages").succeeds();
    for command in &commands {
        let help = program::run(folder, &format!("{command} --help")).succeeds();
        assert!(help.contains("Usage: ddl"), "{command}: {help}");
        assert!(
            completions.contains(&format!("ddl,{command})")),
            "{command}"
        );
        let page = folder.join(format!("pages/ddl-{command}.1"));
        let page = std::fs::read_to_string(page).unwrap();
        assert!(page.contains(".TH"), "{command}: {page}");
    }
    for shell in ["zsh", "fish", "powershell", "elvish"] {
        let script = program::run(folder, &format!("completions {shell}")).succeeds();
        assert!(script.contains("forecast"), "{shell}");
    }
}

#[test]
fn commands_that_report_also_speak_json() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(22);
    std::fs::write(folder.path().join("tracks.csv"), own_tracks::csv(&rows)).unwrap();
    for command_line in [
        "info --json",
        "info . --json",
        "info hotel --json",
        "data tracks.csv --json",
        "pack --model . --out packed.safetensors --json",
        "evaluate --model . --protocol single --test-walkers 8 --threads 1 --json",
        "report . --out report --json",
        "baselines --convention simulated --fold plaza --protocol single --test-walkers 8 --json",
        "goals --model . --measure test --threads 1 --json",
    ] {
        let told = program::run(folder.path(), command_line).succeeds();
        let parsed: Result<serde_json::Value, _> = serde_json::from_str(&told);
        assert!(parsed.is_ok(), "{command_line}: {told}");
    }
}

#[test]
fn nothing_but_plain_text_goes_into_a_pipe() {
    let folder = tiny_model::folder(Variant::Full);
    for command_line in ["--help", "info .", "train --help", "nonsense"] {
        let finished = program::run(folder.path(), command_line);
        let all = finished.stdout + &finished.stderr;
        assert!(!all.contains('\u{1b}'), "{command_line}: {all:?}");
    }
}

#[test]
fn results_name_the_commit_that_the_program_was_built_from() {
    let place = tempfile::tempdir().unwrap();
    let info = program::run(place.path(), "info --json").succeeds();
    let info: serde_json::Value = serde_json::from_str(&info).unwrap();
    let commit = info["commit"].as_str().unwrap();
    let checkout = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.git");
    if checkout.exists() {
        // of a checkout that was changed since
        let hash = commit.strip_suffix("-dirty").unwrap_or(commit);
        let is_hash = hash.chars().all(|c| c.is_ascii_hexdigit());
        assert!(hash.len() >= 12 && is_hash, "{commit}");
    } else {
        assert_eq!(commit, "unknown");
    }
}

/// What is told to people is in the facts for programs too.
#[test]
fn what_looks_wrong_is_in_the_json() {
    let place = tempfile::tempdir().unwrap();
    let rows: Vec<own_tracks::Row> = (0..9).map(|t| (t, 1, 30.0 * t as f64, 0.0)).collect();
    std::fs::write(place.path().join("pixels.csv"), own_tracks::csv(&rows)).unwrap();
    let told = program::run(place.path(), "data pixels.csv --json").succeeds();
    let facts: serde_json::Value = serde_json::from_str(&told).unwrap();
    let facts = &facts["recordings"][0];
    assert_eq!(facts["file"], "pixels.csv");
    let doubts = facts["doubts"].as_array().unwrap();
    assert_eq!(doubts.len(), 2);
    assert!(doubts[0].as_str().unwrap().contains("metres"), "{told}");
}

#[test]
fn an_error_names_its_place_once() {
    let place = tempfile::tempdir().unwrap();
    let message = program::run(place.path(), "forecast nowhere.csv").fails();
    assert_eq!(
        message,
        "cannot read nowhere.csv: No such file or directory (os error 2)"
    );
}

#[test]
fn frames_are_numbered_as_the_tracks_number_them() {
    let place = tempfile::tempdir().unwrap();
    // 24 frames a second: a step of 0.4 s is 9.6 frames.
    let mut rows: Vec<own_tracks::Row> = (0..200).map(|t| (t, 1, 0.05 * t as f64, 0.0)).collect();
    rows.extend((0..200).map(|t| (t, 2, 0.05 * t as f64 + if t < 96 { 0.0 } else { 90.0 }, 3.0)));
    std::fs::write(place.path().join("tracks.csv"), own_tracks::csv(&rows)).unwrap();
    let told = program::run(place.path(), "data tracks.csv --fps 24").succeeds();
    assert!(told.contains("(7 to 199, 9.6 a step of 0.4 s"), "{told}");
    let at = told.split("(pedestrian 2 at frame ").nth(1).unwrap();
    let frame: i64 = at.split(')').next().unwrap().parse().unwrap();
    assert!((95..=106).contains(&frame), "{told}");
    let jump = told.split("jumps at frame ").nth(1).unwrap();
    let frame: i64 = jump.split(',').next().unwrap().parse().unwrap();
    assert!((95..=106).contains(&frame), "{told}");
}
