//! Summary and picture of the memory of a place.

use crate::output::write_output;
use crate::paths::OutputFile;
use crate::telling::many;
use anyhow::bail;
use clap::Args;
use ddl::data::Position;
use ddl::memory::SceneMemory;
use ddl::report::figure;
use serde_json::{Value, json};
use std::fmt::{Display, Formatter};
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Bytes that distinguish a memory from tracks.
const FIRST: u64 = 16;

pub(super) struct MemoryOfFile {
    file: PathBuf,
    memory: SceneMemory,
}

/// The file for the picture of a memory.
#[derive(Debug, Args)]
pub(super) struct MemoryPicture {
    /// Draw the memory of a place as SVG: where many pedestrians walk, appear and disappear
    #[arg(long, value_name = "FILE", value_hint = clap::ValueHint::AnyPath)]
    svg: Option<OutputFile>,
}

/// Whether a file holds a memory. Pipes are not tested: reading consumes them.
pub(super) fn is_in(file: &Path) -> bool {
    let mut first = Vec::new();
    let read = |file: File| file.take(FIRST).read_to_end(&mut first);
    file.is_file() && File::open(file).and_then(read).is_ok() && SceneMemory::begins(&first)
}

pub(super) fn read_each(files: Vec<PathBuf>) -> (Vec<MemoryOfFile>, Vec<anyhow::Error>) {
    let (mut memories, mut errors) = (Vec::new(), Vec::new());
    for file in files {
        match SceneMemory::read(&file) {
            Ok(memory) => memories.push(MemoryOfFile { file, memory }),
            Err(error) => errors.push(error.into()),
        }
    }
    (memories, errors)
}

impl MemoryOfFile {
    pub(super) fn facts(&self) -> Value {
        let summary = self.memory.summary();
        let [low, high] = summary.extent.map_or([None; 2], |corners| corners.map(Some));
        json!({
            "file": self.file.display().to_string(),
            "stretches": summary.segments,
            "capacity": self.memory.capacity(),
            "tracks": summary.tracks,
            "pedestrians": summary.pedestrians,
            "frames": summary.frames,
            "seconds": summary.seconds,
            "frame_step": self.memory.frame_step(),
            "low": low,
            "high": high,
        })
    }

    /// The size of the memory and of the observations in it.
    fn numbers(&self) -> String {
        let summary = self.memory.summary();
        format!(
            "{} of at most {} segments, of {}; {} seen in {}",
            summary.segments,
            self.memory.capacity(),
            many(summary.tracks, "track"),
            many(summary.pedestrians, "pedestrian"),
            duration(summary.seconds),
        )
    }
}

fn duration(seconds: f64) -> String {
    if seconds < 6000.0 { format!("{:.1} minutes", seconds / 60.0) } else { format!("{:.1} hours", seconds / 3600.0) }
}

impl Display for MemoryOfFile {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}, the memory of a place", self.file.display())?;
        writeln!(f, "  {}", self.numbers())?;
        write!(f, "  {} frames a step of 0.4 s; ", self.memory.frame_step())?;
        match self.memory.summary().extent {
            None => write!(f, "no pedestrian was observed"),
            Some([low, high]) => {
                write!(f, "x from {:.2} to {:.2} m, y from {:.2} to {:.2} m", low[0], high[0], low[1], high[1])
            }
        }
    }
}

impl MemoryPicture {
    pub(super) fn draw(&self, memories: &[MemoryOfFile]) -> anyhow::Result<()> {
        let Some(picture) = &self.svg else {
            return Ok(());
        };
        let [MemoryOfFile { file, memory }] = memories else {
            bail!(
                "--svg draws the memory of one place, but {} were given; give one file that `ddl forecast - --memory \
                 FILE` wrote",
                memories.len()
            );
        };
        let tracks: Vec<Vec<Position>> = memory.tracks().collect();
        let title = file.file_name().unwrap_or_default().to_string_lossy();
        let drawn = figure::place(&title, &memories[0].numbers(), &tracks);
        write_output(Some(picture), &drawn)
    }
}
