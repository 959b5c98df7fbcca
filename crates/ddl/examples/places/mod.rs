//! Recordings of places that no model was trained on, folder by folder.

use ddl::data::{Format, Recording, Window, WindowRule, parse_recording};
use std::error::Error;
use std::path::{Path, PathBuf};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "each example uses one part")]
pub(crate) enum Part {
    /// Data for fitting constants: every other file, starting with the first, or the first half of the windows of a
    /// single file.
    Calibration,
    /// The others, for the final evaluation.
    Rest,
}

pub(crate) struct Place {
    pub(crate) name: String,
    #[allow(dead_code, reason = "for tables")]
    pub(crate) rate: String,
    #[allow(dead_code, reason = "for tables")]
    pub(crate) recordings: Vec<Recording>,
    pub(crate) windows: Vec<Window>,
}

/// Folder and frame rate of `FOLDER=FPS`.
fn parts(place: &str) -> Result<(&str, &str), Box<dyn Error>> {
    Ok(place.split_once('=').ok_or("a place is FOLDER=FPS")?)
}

/// All recordings of `FOLDER=FPS`, from csv files in metres, by name, in steps of 0.4 s.
pub(crate) fn recordings(place: &str) -> Result<Vec<Recording>, Box<dyn Error>> {
    let (folder, rate) = parts(place)?;
    let frame_time = 1.0 / rate.parse::<f64>()?;
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)?
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<_>>()?;
    files.sort();
    let recordings = files.iter().map(|file| {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let recording = parse_recording(&std::fs::read(file)?, &name, Format::Table)?;
        Ok(recording.resampled_to_steps(frame_time)?.recording)
    });
    recordings.collect()
}

impl Place {
    /// Evenly spread windows of `FOLDER=FPS` that hold about `pedestrians`, from csv files in metres, in steps of 0.4
    /// s.
    pub(crate) fn read(place: &str, part: Part, pedestrians: usize) -> Result<Self, Box<dyn Error>> {
        let all = recordings(place)?;
        let (alone, rest) = (all.len() == 1, part == Part::Rest);
        let of_part = all
            .into_iter()
            .enumerate()
            .filter(|(at, _)| alone || (at % 2 == 1) == rest);
        let recordings: Vec<Recording> = of_part.map(|(_, recording)| recording).collect();
        let (folder, rate) = parts(place)?;
        let mut windows: Vec<Window> = recordings
            .iter()
            .flat_map(|r| r.windows(WindowRule::Complete))
            .collect();
        if alone {
            let later = windows.split_off(windows.len() / 2);
            windows = if rest { later } else { windows };
        }
        let all: usize = windows.iter().map(Window::len).sum();
        let every = all.div_ceil(pedestrians).max(1);
        let name = Path::new(folder).file_name().unwrap_or_default();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            rate: rate.to_owned(),
            recordings,
            windows: windows.into_iter().step_by(every).collect(),
        })
    }
}
