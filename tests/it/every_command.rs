//! What all commands have in common: help, completions, manual pages, JSON output, quick start.

use ddl::Variant;
use ddl_tests::own_tracks;
use ddl_tests::place::Place;
use ddl_tests::{crowd, drawn_model, processes, program};
use serde_json::Value;
#[cfg(all(target_os = "linux", not(feature = "torch")))]
use std::collections::BTreeSet;
use std::io::Read as _;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// The size of a classic terminal.
const LINES: usize = 24;
const COLUMNS: usize = 80;
/// The documented time for a release build with an expert library of 12,000 simulated pedestrians; a debug build gets
/// more.
const SOON: Duration = Duration::from_secs(if cfg!(debug_assertions) { 2 } else { 1 });
/// The best of several runs counts; the others were delayed by other processes.
const RUNS: usize = 3;

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
fn every_command_has_help_completions_and_a_manual_page() {
    let place = Place::empty();
    let help = place.ok("--help");
    let lines = help.lines().filter_map(|line| line.strip_prefix("  "));
    let commands: Vec<&str> = lines.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() >= 13, "{commands:?}");
    let completions = place.ok("completions bash");
    let _ = place.ok("man pages");
    for command in commands {
        let help = place.ok(&format!("{command} --help"));
        assert!(help.contains("Usage: ddl"), "{command}: {help}");
        assert!(completions.contains(&format!("ddl,{command})")), "{command}");
        let page = place.text(&format!("pages/ddl-{command}.1"));
        assert!(page.contains(".TH"), "{command}: {page}");
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
        "baselines --convention simulated --fold plaza --protocol single --test-pedestrians 8",
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

#[test]
fn info_describes_the_program() {
    let info = Place::empty().json("info --json");
    assert_eq!(info["version"], env!("CARGO_PKG_VERSION"));
    assert!(info["cuda"].is_string());
    assert_eq!(info["models"].as_array().unwrap().len(), 6);
    // Results name the commit that the program was built from, even if the checkout has changed since.
    let commit = info["commit"].as_str().unwrap();
    if Path::new(env!("CARGO_MANIFEST_DIR")).join("../.git").exists() {
        let hash = commit.strip_suffix("-dirty").unwrap_or(commit);
        let is_hash = hash.chars().all(|c| c.is_ascii_hexdigit());
        assert!(hash.len() >= 12 && is_hash, "{commit}");
    } else {
        assert_eq!(commit, "unknown");
    }
}

#[test]
fn info_describes_models() {
    let place = Place::with_variant(Variant::NoGoalShift);
    let info = place.json("info --model run --json");
    let config: Value = serde_json::from_str(&place.text("run/config.json")).unwrap();
    assert_eq!(info["config"], config);
    assert_eq!(info["epochs"].as_array().unwrap().len(), 1);
    assert_eq!(info["experts"], config["data"]["pedestrians"]);
    let parameters = info["parameters"].as_u64().unwrap();
    // Four bytes per parameter, and a header.
    let bytes = place.read("run/model.safetensors").len() as u64;
    assert!(parameters > 10_000 && (4 * parameters..4 * parameters + 65_536).contains(&bytes));
    let for_people = place.ok("info run");
    let pedestrians = &config["data"]["pedestrians"];
    let sentence = format!(
        "run: variant no-goal-shift, trained on {pedestrians} pedestrian-windows of 20 steps (convention simulated, \
         without \
         corridor); goals "
    );
    assert!(for_people.starts_with(&sentence), "{for_people}");
    assert!(for_people.contains("variant: no-goal-shift"), "{for_people}");
    place.remove("run/model.safetensors");
    let unfinished = place.ok("info run");
    let sentence = sentence.replace("trained on", "to be trained on");
    assert!(unfinished.starts_with(&sentence), "{unfinished}");
    assert_eq!(
        place.json("info --model zara1 --json")["config"]["data"]["fold"],
        "zara1"
    );
}

/// Processor time until the first byte of output, or slightly later, because the process continues. Processor time is
/// independent of other load on the machine.
fn until_first_output(place: &Place, line: &str) -> Option<Duration> {
    let mut command = program::command(place.path(), line);
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut output = child.stdout.take().unwrap();
    let mut first = [0];
    output.read_exact(&mut first).unwrap();
    let time = processes::processor_time(child.id());
    let mut rest = String::new();
    output.read_to_string(&mut rest).unwrap();
    assert!(child.wait().unwrap().success());
    assert!(rest.lines().count() > 100, "no forecast: {rest}");
    time
}

#[test]
fn the_first_output_comes_quickly() {
    let place = Place::empty();
    place.write_tracks("tracks.csv", &own_tracks::three_pedestrians(8));
    let config = drawn_model::config(Variant::Full);
    drawn_model::write(config, &crowd::training_windows(), &place.at("run"));
    let line = "forecast --model run tracks.csv --threads 1";
    let runs: Vec<_> = (0..RUNS).map(|_| until_first_output(&place, line)).collect();
    let Some(best) = runs.iter().min().copied().flatten() else {
        eprintln!("skipped: this system does not report the processor time of a process");
        return;
    };
    assert!(best <= SOON, "{runs:?} of processor time, at most {SOON:?}");
}

#[cfg(all(target_os = "linux", not(feature = "torch")))]
#[test]
fn only_system_libraries_are_loaded() {
    let place = Place::empty();
    place.write_tracks("tracks.csv", &own_tracks::three_pedestrians(8));
    for line in ["--help", "forecast tracks.csv", "info --json"] {
        let mut command = program::command(place.path(), line);
        command
            .env("LD_DEBUG", "libs")
            .env("LD_DEBUG_OUTPUT", place.at("loaded"));
        let mut child = command.stdout(Stdio::null()).spawn().unwrap();
        assert!(child.wait().unwrap().success());
        // The system's loader reports every library by its path.
        let loader_log = place.text(&format!("loaded.{}", child.id()));
        let paths = loader_log
            .lines()
            .filter_map(|line| Some(line.split_once("calling init: ")?.1));
        let name = |path: &str| {
            path.rsplit('/')
                .next()
                .unwrap_or(path)
                .split(".so")
                .next()
                .map(str::to_owned)
        };
        let mut loaded: BTreeSet<String> = paths.filter_map(name).collect();
        assert!(loaded.contains("libc"), "{line}: {loader_log}");
        loaded.retain(|name| !["libc", "libm", "libgcc_s"].contains(&&**name) && !name.starts_with("ld-linux"));
        assert!(loaded.is_empty(), "{line}: {loaded:?}");
    }
}
