//! A user's own recordings: one per file, in folders or named individually.

use crate::telling::{self, tell};
use crate::units::{ReadRecording, Units};
use anyhow::{Context as _, bail};
use ddl::{Note, TimedRecording, in_frames, misfits_of};
use std::path::{Path, PathBuf};

/// Extensions of recordings; other files in a folder are ignored.
pub(crate) const EXTENSIONS: [&str; 5] = ["csv", "tsv", "txt", "ndjson", "mcap"];
/// Number of unreadable files that are reported individually.
const MOST_REPORTED: usize = 10;

/// The recordings in these folders, by name, and the files among `paths`.
pub(crate) fn files(paths: &[PathBuf], units: &Units) -> anyhow::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() && !ddl_mcap::is_log(path) {
            files.extend(in_folder(path, units)?);
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

fn in_folder(folder: &Path, units: &Units) -> anyhow::Result<Vec<PathBuf>> {
    let unreadable = || format!("cannot list {}", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(unreadable)? {
        let path = entry.with_context(unreadable)?.path();
        let hidden = path.file_name().unwrap_or_default().to_string_lossy().starts_with('.');
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let of_tracks = EXTENSIONS.iter().any(|of_tracks| extension == *of_tracks);
        if path.is_file() && !hidden && of_tracks && !units.are_from(&path) {
            files.push(path);
        }
    }
    if files.is_empty() {
        bail!(
            "{} holds no recordings: it needs files that end in .csv, .tsv, .txt, .ndjson or .mcap (subfolders are not \
             read)",
            folder.display()
        );
    }
    files.sort();
    Ok(files)
}

pub(crate) fn read(files: &[PathBuf], units: &Units) -> anyhow::Result<Vec<ReadRecording>> {
    let (read, errors) = read_each(files, units);
    all_read(errors, files.len())?;
    Ok(read.into_iter().map(|(_, recording)| recording).collect())
}

/// Prints messages about recordings; a message about several is printed once.
fn tell_grouped<'a>(kind: &str, messages: impl IntoIterator<Item = (&'a str, String)>) {
    let mut grouped: Vec<(String, Vec<&str>)> = Vec::new();
    for (name, words) in messages {
        match grouped.iter_mut().find(|(message, _)| *message == words) {
            Some((_, names)) => names.push(name),
            None => grouped.push((words, vec![name])),
        }
    }
    for (words, names) in grouped {
        match names[..] {
            [one] => tell(format_args!("{kind}: {one}: {words}")),
            _ => tell(format_args!("{kind}: {} recordings: {words}", names.len())),
        }
    }
}

pub(crate) fn tell_notes<'a>(read: impl IntoIterator<Item = &'a ReadRecording>) {
    let notes = read.into_iter().flat_map(|ReadRecording { timed, .. }| {
        timed.notes.iter().chain(&timed.guessed).map(move |note| (timed.recording.name(), note.to_string()))
    });
    tell_grouped("note", notes);
}

/// Says what the frame numbers of windows and results count, where that is not what the files count.
pub(crate) fn tell_ticks(read: &[ReadRecording]) {
    let finer = read.iter().filter(|read| !read.timed.clock.counts_frames());
    let counted = finer.map(|ReadRecording { timed, .. }| {
        let counted = match timed.clock.tick(1) {
            Ok(ticks) if ticks > 1 => format!("parts of a frame, {ticks} in each"),
            _ => "microseconds".to_owned(),
        };
        let words = format!("the frames of windows and results count {counted}");
        (timed.recording.name(), words)
    });
    tell_grouped("note", counted);
}

pub(crate) fn read_each<'f>(
    files: &'f [PathBuf],
    units: &Units,
) -> (Vec<(&'f Path, ReadRecording)>, Vec<anyhow::Error>) {
    let mut read = Vec::new();
    let mut errors = Vec::new();
    for file in files {
        match units.read(file) {
            Ok(recording) => read.push((file.as_path(), recording)),
            Err(error) => errors.push(error),
        }
    }
    (read, errors)
}

/// Reports all files that could not be read together.
pub(crate) fn all_read(mut errors: Vec<anyhow::Error>, files: usize) -> anyhow::Result<()> {
    if errors.len() < 2 {
        return errors.pop().map_or(Ok(()), Err);
    }
    for error in errors.iter().take(MOST_REPORTED) {
        tell(format_args!("error: {}", telling::words(error)));
    }
    let listed = if errors.len() > MOST_REPORTED {
        format!("; the first {MOST_REPORTED} are listed above")
    } else {
        String::new()
    };
    bail!("{} of {files} files cannot be read{listed}", errors.len());
}

/// Warns of suspicious speeds: with wrong units, training and evaluation are meaningless.
pub(crate) fn warn_of_implausible(read: &[ReadRecording]) {
    let (mut warnings, mut notes) = (Vec::new(), Vec::new());
    for TimedRecording { recording, clock, .. } in read.iter().map(|read| &read.timed) {
        let observed = recording.observe_each(recording.live_tracks(), |_| ());
        let warning = recording.speed_warning();
        let misfits = misfits_of(recording, *clock, &observed.misfits, warning.as_ref());
        let doubts = warning.map(|warning| Note::Implausible(in_frames(*clock, warning))).into_iter().chain(misfits);
        warnings.extend(doubts.map(|note| (recording.name(), note.to_string())));
        notes.extend((!observed.has_common_frames).then(|| (recording.name(), Note::OwnClocks.to_string())));
    }
    tell_grouped("note", notes);
    tell_grouped("warning", warnings);
}
