//! No file is named by what stands in a model file.

use super::folder_with_model;
use ddl_tests::{figures, processes, program, safetensors_file};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Runs the program. Who opens a pipe that nobody writes to waits for ever, and is ended here.
fn ends(folder: &Path, line: &str) -> bool {
    let mut command = program::command(folder, line);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(30) {
        if child.try_wait().unwrap().is_some() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    processes::signal(child.id(), "KILL");
    child.wait().unwrap();
    false
}

fn pipe(folder: &Path) -> String {
    let pipe = folder.join("pipe");
    let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    pipe.display().to_string()
}

/// Texts of a JSON value, by pointer.
fn texts(value: &Value, pointer: &str, found: &mut Vec<String>) {
    match value {
        Value::String(_) => found.push(pointer.to_owned()),
        Value::Object(fields) => fields
            .iter()
            .for_each(|(name, value)| texts(value, &format!("{pointer}/{name}"), found)),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .for_each(|(i, item)| texts(item, &format!("{pointer}/{i}"), found)),
        _ => {}
    }
}

/// Every text of `config.json`, one after the other, is the path of a pipe: opening it would never end.
#[test]
fn no_text_of_a_configuration_is_opened() {
    let folder = folder_with_model();
    let here = folder.path();
    let forged = pipe(here);
    // that such a pipe is noticed
    assert!(!ends_soon(here, &format!("forecast --model run {forged}")));
    let file = here.join("run/config.json");
    let whole = std::fs::read(&file).unwrap();
    let config: Value = serde_json::from_slice(&whole).unwrap();
    let mut pointers = Vec::new();
    texts(&config, "", &mut pointers);
    assert!(pointers.len() > 8, "{pointers:?}");
    let mut tried = 0;
    for pointer in &pointers {
        let mut config = config.clone();
        *config.pointer_mut(pointer).unwrap() = Value::from(forged.clone());
        std::fs::write(&file, config.to_string()).unwrap();
        let commands = ["forecast --model run tracks.csv", "info --model run"];
        let commands = commands.iter().take(figures::rounds(1, 2));
        for command in commands {
            assert!(ends(here, command), "{pointer} was opened by: {command}");
            tried += 1;
        }
    }
    figures::tell(
        "paths in a configuration",
        format!(
            "{} texts, each the path of a pipe that blocks who opens it; {tried} commands",
            pointers.len()
        ),
        "none was opened",
    );
}

/// A model forged throughout, so that it loads: its names of fold, recordings, commit, device are paths.
#[test]
fn a_model_with_paths_for_names_forecasts_as_before() {
    let folder = folder_with_model();
    let here = folder.path();
    let forecast = "forecast --model run tracks.csv --threads 1";
    let expected = program::run(here, forecast).succeeds();
    let paths = [
        pipe(here),
        "../../etc/passwd".to_owned(),
        "/etc/passwd\u{0}x".to_owned(),
    ];
    let run = here.join("run");
    let original = std::fs::read(run.join("config.json")).unwrap();
    for path in &paths {
        let mut config: Value = serde_json::from_slice(&original).unwrap();
        for pointer in [
            "/data/fold",
            "/data/sha256",
            "/commit",
            "/libtorch",
            "/device",
        ] {
            *config.pointer_mut(pointer).unwrap() = Value::from(path.clone());
        }
        config["data"]["validation_recordings"] = Value::from(vec![path.clone()]);
        std::fs::write(run.join("config.json"), config.to_string()).unwrap();
        for name in ["model", "proposal", "experts"] {
            let file = run.join(format!("{name}.safetensors"));
            let bytes = std::fs::read(&file).unwrap();
            let (mut header, numbers) = safetensors_file::parts(&bytes).unwrap();
            let origin = header["__metadata__"]["origin"].as_str().unwrap();
            let mut origin: Value = serde_json::from_str(origin).unwrap();
            for fact in ["data.fold", "data.sha256"] {
                origin[fact] = Value::from(path.clone());
            }
            origin["data.validation_recordings"] =
                Value::from(config["data"]["validation_recordings"].to_string());
            header["__metadata__"]["origin"] = Value::from(origin.to_string());
            let forged = safetensors_file::join(&header, numbers);
            std::fs::write(&file, forged).unwrap();
        }
        assert!(ends(here, forecast), "{path} was opened");
        assert_eq!(program::run(here, forecast).succeeds(), expected);
        assert!(
            ends(here, "pack --model run --out packed"),
            "{path} was opened"
        );
        let _ = program::run(here, "forecast --model packed tracks.csv").succeeds();
        // data is looked for by the names of the convention alone: there is no such fold
        let message = program::run(here, "evaluate --model run --threads 1").fails();
        assert!(message.contains("corridor"), "{message}");
    }
    figures::tell(
        "a model forged to load, with paths for names",
        format!(
            "{} kinds of paths in 6 fields and 3 headers, run and packed",
            paths.len()
        ),
        "the same forecasts; no path was opened",
    );
}

/// A file of a run that is a link: read through, as everything the system names; written over, not through.
#[test]
fn nothing_is_written_through_a_link() {
    let folder = folder_with_model();
    let here = folder.path();
    let (model, elsewhere) = (here.join("run/model.safetensors"), here.join("elsewhere"));
    std::fs::rename(&model, &elsewhere).unwrap();
    std::os::unix::fs::symlink("../elsewhere", &model).unwrap();
    let _ = program::run(here, "forecast --model run tracks.csv").succeeds();
    for (line, name) in [
        ("forecast --model run tracks.csv --output out", "out"),
        ("pack --model run --out packed", "packed"),
        (
            "evaluate --model run --protocol fair --test-walkers 20 --threads 1",
            "run/report.json",
        ),
    ] {
        let canary = here.join("canary");
        std::fs::write(&canary, "untouched").unwrap();
        std::os::unix::fs::symlink(&canary, here.join(name)).unwrap();
        let _ = program::run(here, line).succeeds();
        assert_eq!(std::fs::read(&canary).unwrap(), b"untouched", "{line}");
        assert!(!here.join(name).is_symlink(), "{line}");
    }
    // a link to nowhere is no model, and makes none
    std::fs::remove_file(&elsewhere).unwrap();
    let message = program::run(here, "forecast --model run tracks.csv").fails();
    assert!(message.contains("not finished"), "{message}");
    figures::tell(
        "links among the files of a run",
        "3 outputs and a model",
        "read through, never written through",
    );
}

/// Whether it ends within two seconds.
fn ends_soon(folder: &Path, line: &str) -> bool {
    let mut command = program::command(folder, line);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_secs(2));
    let ended = child.try_wait().unwrap().is_some();
    processes::signal(child.id(), "KILL");
    child.wait().unwrap();
    ended
}
