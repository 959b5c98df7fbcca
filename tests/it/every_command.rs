//! What all commands have in common: help, completions, JSON output, quick start.

use ddl_tests::place::Place;

/// The size of a classic terminal.
const LINES: usize = 24;
const COLUMNS: usize = 80;
#[test]
fn help_fits_a_screen_and_lists_the_exit_codes() {
    let place = Place::empty();
    let help = place.ok("--help");
    assert!(help.lines().count() <= LINES, "{help}");
    assert!(help.lines().all(|line| line.chars().count() <= COLUMNS), "{help}");
    for words in ["Exit codes: 0 success", "130 interrupted", "forecast", "view"] {
        assert!(help.contains(words), "{words}: {help}");
    }
    // Without a command the help is printed as an error.
    let bare = place.run("");
    assert_eq!((bare.code, bare.stdout.as_str()), (Some(2), ""));
    assert_eq!(bare.stderr.trim_end(), help.trim_end());
}

#[test]
fn every_command_has_help_and_completions() {
    let place = Place::empty();
    let help = place.ok("--help");
    let lines = help.lines().filter_map(|line| line.strip_prefix("  "));
    let commands: Vec<&str> = lines.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() >= 13, "{commands:?}");
    let completions = place.ok("completions bash");
    for command in commands {
        let help = place.ok(&format!("{command} --help"));
        assert!(help.contains("Usage: ddl"), "{command}: {help}");
        assert!(completions.contains(&format!("ddl,{command})")), "{command}");
    }
    for shell in ["zsh", "fish", "powershell", "elvish"] {
        let script = place.ok(&format!("completions {shell}"));
        assert!(script.contains("forecast"), "{shell}");
    }
}

#[test]
fn commands_that_report_also_speak_json() {
    let place = Place::with_model();
    for line in [
        "info",
        "info run",
        "info hotel",
        "data tracks.csv",
        "pack --model run --out packed.safetensors",
        "evaluate --model run --protocol single --test-pedestrians 8 --threads 1",
        "report run --out report",
        "goals --model run --measure test --threads 1",
    ] {
        let _ = place.json(&format!("{line} --json --progress none"));
    }
    for line in ["--help", "info run", "train --help", "nonsense"] {
        let finished = place.run(line);
        let output = finished.stdout + &finished.stderr;
        assert!(!output.contains('\u{1b}'), "{line}: {output:?}");
    }
}

#[cfg(all(target_os = "linux", not(feature = "torch")))]
#[test]
fn only_system_libraries_are_loaded() {
    use ddl_tests::{own_tracks, program};
    use std::collections::BTreeSet;
    use std::process::Stdio;

    let place = Place::empty();
    place.write_tracks("tracks.csv", &own_tracks::three_pedestrians(8));
    for line in ["--help", "forecast tracks.csv", "info --json"] {
        let mut command = program::command(place.path(), line);
        command.env("LD_DEBUG", "libs").env("LD_DEBUG_OUTPUT", place.at("loaded"));
        let mut child = command.stdout(Stdio::null()).spawn().unwrap();
        assert!(child.wait().unwrap().success());
        // The system's loader reports every library by its path.
        let loader_log = place.text(&format!("loaded.{}", child.id()));
        let paths = loader_log.lines().filter_map(|line| Some(line.split_once("calling init: ")?.1));
        let name = |path: &str| Some(path.rsplit('/').next()?.split(".so").next()?.to_owned());
        let mut loaded: BTreeSet<String> = paths.filter_map(name).collect();
        assert!(loaded.contains("libc"), "{line}: {loader_log}");
        loaded.retain(|name| !["libc", "libm", "libgcc_s"].contains(&&**name) && !name.starts_with("ld-linux"));
        assert!(loaded.is_empty(), "{line}: {loaded:?}");
    }
}

#[test]
fn an_empty_path_is_refused_before_any_work() {
    let place = Place::empty();
    let lines =
        ["forecast - --memory=", "forecast - --output=", "occupancy a --folder=", "train --out=", "data --svg="];
    for line in lines.into_iter().chain(["evaluate --model=", "pack --benchmark=", "forecast --homography="]) {
        let refused = place.run(line);
        assert!(refused.code == Some(2) && refused.stderr.contains("a value is required"), "{line}: {refused:?}");
    }
}
