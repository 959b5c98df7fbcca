//! A temporary folder in which a test writes files and runs the program.

use crate::own_tracks::{self, Row};
use crate::program::{self, Finished};
use crate::{drawn_model, folder_contents};
use ddl::Variant;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use tempfile::TempDir;

/// The folder, removed at the end of the test.
#[derive(Debug)]
pub struct Place(TempDir);

impl Place {
    /// An empty folder.
    pub fn empty() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder can be made"))
    }

    /// A folder with a [drawn model](drawn_model) in `run`, and tracks of three pedestrians for 9 frames in
    /// `tracks.csv`.
    pub fn with_model() -> Self {
        Self::with_variant(Variant::Full)
    }

    /// As [`with_model`](Self::with_model), with a model of another variant.
    pub fn with_variant(variant: Variant) -> Self {
        let place = Self::empty();
        folder_contents::write(drawn_model::contents(variant), &place.at("run"));
        place.write_tracks("tracks.csv", &own_tracks::three_pedestrians(9));
        place
    }

    /// A folder with [recordings](Self::write_recordings).
    pub fn with_recordings() -> Self {
        let place = Self::empty();
        place.write_recordings();
        place
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// The path of a file in it.
    pub fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Writes a file, and creates its folder.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let file = self.at(name);
        let folder = file.parent().expect("a file is in a folder");
        std::fs::create_dir_all(folder).expect("a folder can be made");
        std::fs::write(file, content).expect("a file can be written");
    }

    /// Writes tracks as CSV.
    pub fn write_tracks(&self, name: &str, rows: &[Row]) {
        self.write(name, own_tracks::csv(rows));
    }

    /// The folder `film`: three recordings in pixels at 23.98 frames per second, and their homography.
    pub fn write_film(&self) {
        for (name, scene) in [("hall", "corridor"), ("lobby", "plaza"), ("yard", "crossing")] {
            // A frame of the crowd is 0.04 s, one of the film 1 / 23.98 s: nearly the same.
            let mut rows = own_tracks::of_scene(scene, 0..900);
            for (.., x, y) in &mut rows {
                (*x, *y) = (50.0 * *x, 50.0 * *y);
            }
            self.write_tracks(&format!("film/{name}.csv"), &rows);
        }
        // A file beside the recordings that is not a recording.
        self.write("film/H.txt", "0.02 0 0\n0 0.02 0\n0 0 1\n");
    }

    /// The folder `mine`: two recordings of a minute, as CSV, and a file that is not a recording.
    pub fn write_recordings(&self) {
        for (name, scene) in [("lobby", "corridor"), ("yard", "plaza")] {
            self.write_tracks(&format!("mine/{name}.csv"), &own_tracks::of_scene(scene, 0..1500));
        }
        self.write("mine/README.md", "not a recording");
    }

    /// The folder `clips`: a simulated crowd cut into `count` clips of `frames` frames (10 per step).
    pub fn write_clips(&self, frames: i64, count: i64) {
        for clip in 0..count {
            let rows = own_tracks::of_scene("plaza", clip * frames..(clip + 1) * frames);
            self.write_tracks(&format!("clips/clip{clip}.csv"), &rows);
        }
    }

    /// The bytes of a file.
    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.at(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The text of a file.
    pub fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).expect("the file is text")
    }

    /// Removes a file.
    pub fn remove(&self, name: &str) {
        std::fs::remove_file(self.at(name)).expect("the file can be removed");
    }

    /// Runs the program here.
    pub fn run(&self, line: &str) -> Finished {
        program::run(self.path(), line)
    }

    /// Runs the program, which must succeed, and returns its standard output.
    pub fn ok(&self, line: &str) -> String {
        self.run(line).succeeds()
    }

    /// Runs the program and parses its standard output as JSON.
    pub fn json(&self, line: &str) -> Value {
        json(&self.ok(line))
    }

    /// Runs the program, which must fail, write nothing, and print all of `needles`.
    pub fn fails(&self, line: &str, needles: &[&str]) {
        let before = folder_contents::read(self.path());
        let message = self.run(line).fails();
        self.assert_unchanged_since(&before);
        for needle in needles {
            assert!(message.contains(needle), "{line}: `{needle}` is not in: {message}");
        }
    }

    /// Commands that must fail and begin alike, each with words of the message: lines `REST OF THE COMMAND => WORDS`.
    pub fn all_fail(&self, start: &str, cases: &str) {
        for case in cases.trim().lines() {
            let (rest, words) = case.split_once(" => ").expect("a command and words");
            self.fails(&format!("{start} {rest}"), &[words]);
        }
    }

    /// Asserts that nothing was written since.
    pub fn assert_unchanged_since(&self, before: &folder_contents::Contents) {
        folder_contents::assert_same(before, &folder_contents::read(self.path()));
    }

    /// Runs the program with this text as its standard input.
    pub fn run_on(&self, input: &str, line: &str) -> Finished {
        self.write("standard input", input);
        let input = std::fs::File::open(self.at("standard input")).expect("it was just written");
        let mut command = program::command(self.path(), line);
        let output = command.stdin(Stdio::from(input)).output();
        Finished::new(line.to_owned(), &output.expect("the program can be started"))
    }

    /// Starts the program with pipes for its outputs.
    pub fn start(&self, line: &str) -> Child {
        let mut command = program::command(self.path(), line);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program can be started")
    }

    /// Forecasts tracks with complete observations, with the model in `run`.
    pub fn forecast(&self, rows: &[Row], options: &str) -> Finished {
        self.write_tracks("tracks.csv", rows);
        let line = "forecast --model run tracks.csv --whole --threads 1";
        self.run(&format!("{line} {options}"))
    }
}

/// Parses JSON.
pub fn json<T: DeserializeOwned>(text: &str) -> T {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Parses JSON lines, one value per line.
pub fn json_lines<T: DeserializeOwned>(text: &str) -> Vec<T> {
    text.lines().map(json).collect()
}
