//! Texts in a model file are never opened as paths.

use super::EVALUATE;
use ddl_tests::nightly;
use ddl_tests::place::{Place, json};
use serde_json::Value;
use std::fmt::Display;
use std::process::Command;
use std::time::{Duration, Instant};

/// Whether the program ends within this time. A program that opens a pipe without a writer would wait forever; it is
/// ended here.
fn ends(place: &Place, line: &str, within: Duration) -> bool {
    let mut child = place.start(line);
    drop((child.stdout.take(), child.stderr.take()));
    let begun = Instant::now();
    while begun.elapsed() < within {
        if child.try_wait().unwrap().is_some() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    false
}

fn pipe(place: &Place) -> String {
    let pipe = place.at("pipe");
    let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    pipe.display().to_string()
}

/// The pointers of the texts in a value.
fn texts(value: &Value, pointer: &str) -> Vec<String> {
    let below = |name: &dyn Display, value| texts(value, &format!("{pointer}/{name}"));
    match value {
        Value::String(_) => vec![pointer.to_owned()],
        Value::Object(fields) => fields.iter().flat_map(|(name, value)| below(name, value)).collect(),
        Value::Array(items) => items.iter().enumerate().flat_map(|(i, item)| below(&i, item)).collect(),
        _ => Vec::new(),
    }
}

/// Every text of `config.json` is replaced, one after the other, by the path of a pipe that blocks when it is opened.
#[test]
fn no_text_of_a_configuration_is_opened() {
    let place = Place::with_model();
    let forged = pipe(&place);
    // Checks that the test notices such a pipe.
    let opened = format!("forecast --model run {forged}");
    assert!(!ends(&place, &opened, Duration::from_secs(2)));
    let config: Value = json(&place.text("run/config.json"));
    let pointers = texts(&config, "");
    assert!(pointers.len() > 8, "{pointers:?}");
    let commands = ["forecast --model run tracks.csv", "info --model run"];
    let commands = &commands[..nightly::rounds(1, 2)];
    for pointer in &pointers {
        let mut config = config.clone();
        *config.pointer_mut(pointer).unwrap() = Value::from(forged.clone());
        place.write("run/config.json", config.to_string());
        for command in commands {
            let ended = ends(&place, command, Duration::from_secs(30));
            assert!(ended, "{pointer} was opened by: {command}");
        }
    }
}

#[test]
fn nothing_is_written_through_a_link() {
    let place = Place::with_model();
    let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, place.at(name)).unwrap();
    let forecast = "forecast --model run tracks.csv";
    std::fs::rename(place.at("run/model.safetensors"), place.at("elsewhere")).unwrap();
    link("../elsewhere", "run/model.safetensors");
    let canary = place.at("canary").display().to_string();
    for (line, name) in [
        (&format!("{forecast} --output out")[..], "out"),
        ("pack --model run --out packed", "packed"),
        (EVALUATE, "run/report.json"),
    ] {
        place.write("canary", "untouched");
        link(&canary, name);
        let _ = place.ok(line);
        assert_eq!(place.text("canary"), "untouched", "{line}");
        assert!(!place.at(name).is_symlink(), "{line}");
    }
    // A link to a missing file is not a model, and does not create one.
    place.remove("elsewhere");
    place.fails(forecast, &["not finished"]);
}
