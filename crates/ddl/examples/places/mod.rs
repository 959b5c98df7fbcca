//! Recordings of places that no model was trained on.

use ddl::data::{Format, Recording, parse_recording};
use std::error::Error;
use std::path::PathBuf;

/// All recordings of `FOLDER=FPS`, from csv files in metres, by name, in steps of 0.4 s.
pub(crate) fn recordings(place: &str) -> Result<Vec<Recording>, Box<dyn Error>> {
    let (folder, rate) = place.split_once('=').ok_or("a place is FOLDER=FPS")?;
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
