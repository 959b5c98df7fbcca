//! Folders of sample files, the layout that the evaluator of "Joint Metrics Matter" (Weng et al., ICCV 2023) reads, and
//! that `AgentFormer` and others write:
//!
//! ```text
//! METHOD/SCENE/frame_000850/obs.txt                           8 rows for each pedestrian
//!                           gt.txt                            12 rows: the true future
//!                           sample_000.txt ... sample_019.txt 12 rows: one future of the whole scene each
//! ```
//!
//! SCENE is the recording, the folder's number its last observed frame. A row is `frame pedestrian x y`, in numbers
//! with spaces between them, metres; rows of one pedestrian stand together in order of time. Futures have no weights,
//! so those read have equal ones. Other writers print three decimals; here all digits are printed, so reading gives the
//! same bits.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufReader, Error, ErrorKind};
use std::path::{Component, Path, PathBuf};

use ddl_core::{Forecast, HORIZON, OBSERVED, PedestrianName, Position, Window, write_atomically};
use ddl_data::{Convention, Fault};

use crate::error::EvaluationError;
use crate::external::error::ExternalError;
use crate::external::expected::{ExpectedForecasts, PedestrianForecast};
use crate::external::lines::{lines_of, within_bounds, wrong_length};
use crate::external::matched::{Coverage, Matched};
use crate::external::pedestrian_key::{PedestrianKey, frames_ahead, last_observed, wrong_frames};
use crate::external::table::{finite, whole_number};
use crate::protocol::Protocol;

/// Writes the observations, true futures and forecasts of windows as sample files into a new folder METHOD.
///
/// Hypothesis k of all pedestrians becomes `sample_00k.txt`; weights and goals are not written.
///
/// # Errors
/// The folder holds files, or cannot be written; windows and forecasts have different pedestrians; the pedestrians of a
/// recording are named by words.
pub fn write_samples(windows: &[Window], forecasts: &[Forecast], folder: &Path) -> Result<(), ExternalError> {
    EvaluationError::unless_one_each(windows, forecasts.len())?;
    if fs::read_dir(folder).is_ok_and(|mut files| files.next().is_some()) {
        return Err(in_folder(folder, "is not empty; give a new folder"));
    }
    for (window, forecast) in windows.iter().zip(forecasts) {
        EvaluationError::unless_same_pedestrians(window, forecast.pedestrians())?;
        let name = window.recording();
        if !Path::new(name).components().eq([Component::Normal(name.as_ref())]) {
            return Err(in_folder(folder, format!("recording `{name}` cannot be the name of a folder")));
        }
        let moment = folder.join(scene_name(name)).join(format!("frame_{:06}", last_observed(window)));
        fs::create_dir_all(&moment).map_err(|source| of_file(&moment, source))?;
        let [ahead, _] = frames_ahead(window);
        let paths = |path: &dyn Fn(usize) -> Vec<Position>| (0..window.len()).map(path).collect::<Vec<_>>();
        let observed = paths(&|i| window.observed(i).to_vec());
        write(&moment.join("obs.txt"), window, &window.frames()[..OBSERVED], &observed)?;
        if window.has_future() {
            write(&moment.join("gt.txt"), window, &ahead, &paths(&|i| window.future(i).to_vec()))?;
        }
        for k in 0..forecast.hypotheses() {
            let future = paths(&|i| forecast.hypothesis(i, k).to_vec());
            write(&moment.join(sample_name(k)), window, &ahead, &future)?;
        }
    }
    Ok(())
}

fn write(file: &Path, window: &Window, frames: &[i64], paths: &[Vec<Position>]) -> Result<(), ExternalError> {
    let mut text = String::new();
    for (i, path) in paths.iter().enumerate() {
        let PedestrianName::Number(pedestrian) = window.name(i) else {
            let problem = "pedestrians have numbers in this layout, and words in the recording";
            return Err(in_folder(file, problem));
        };
        for (frame, [x, y]) in frames.iter().zip(path) {
            let _ = writeln!(text, "{frame} {pedestrian} {x} {y}");
        }
    }
    write_atomically(file, text.as_bytes()).map_err(|source| of_file(file, source))
}

/// Reads the folder METHOD of sample files and matches it with windows. Scenes of other recordings are not read, nor
/// are `obs.txt` and `gt.txt`.
///
/// # Errors
/// As [`read`](super::read); also when a window has other samples than 000 to K - 1, 20 at most, or another K.
pub fn read_samples(folder: &Path, windows: &[Window], coverage: Coverage) -> Result<Matched, ExternalError> {
    let mut expected = ExpectedForecasts::of(windows, &folder.display().to_string())?;
    let mut first: Option<(usize, PathBuf)> = None;
    for recording in expected.recordings.clone() {
        let names = [recording, scene_name(recording)].map(|name| folder.join(name));
        let Some(scene) = names.iter().find(|scene| scene.is_dir()) else { continue };
        for (frame, moment) in numbered::<i64>(scene, "frame_", "")? {
            let samples = samples_of(&moment)?;
            let (count, of_first) = first.get_or_insert_with(|| (samples.len(), moment.clone()));
            if *count != samples.len() {
                let (found, of_first) = (samples.len(), of_first.display());
                let problem = format!("holds {found} samples, but {of_first} holds {count}; the best of K needs one K");
                return Err(in_folder(&moment, problem));
            }
            read_window(&mut expected, recording, frame, &samples)?;
        }
    }
    if first.is_none() {
        let scenes: Vec<&str> = expected.recordings.iter().map(|name| scene_name(name)).collect();
        let scenes = scenes.join(", ");
        let problem = format!("holds no folder SCENE/frame_NNNNNN of sample files, where SCENE is one of {scenes}");
        return Err(in_folder(folder, problem));
    }
    let mut matched = expected.matched(coverage)?;
    matched.file = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(matched)
}

/// A future of a window: the pedestrians, each with its first line, its frames and positions.
type SampleFile = BTreeMap<PedestrianName, (usize, Vec<i64>, Vec<Position>)>;

fn read_window(
    expected: &mut ExpectedForecasts<'_>,
    recording: &str,
    observed_until: i64,
    samples: &[PathBuf],
) -> Result<(), ExternalError> {
    let mut all: BTreeMap<PedestrianName, (usize, PedestrianForecast)> = BTreeMap::new();
    for (k, file) in samples.iter().enumerate() {
        let origin = file.display().to_string();
        let sample = read_sample(file, &origin)?;
        let lacks = all.keys().find(|name| !sample.contains_key(name));
        if let Some(name) = lacks {
            let problem = format!("pedestrian {name} is missing, which sample_000.txt has");
            return Err(Fault::from(problem).in_line(&origin, 1).into());
        }
        for (name, (line, frames, positions)) in sample {
            let problem = if positions.len() != HORIZON {
                Some(Fault::from(wrong_length(positions.len())))
            } else if k > 0 && !all.contains_key(&name) {
                Some(Fault::named("pedestrian", format!("{name} is not in sample_000.txt")))
            } else {
                let (_, forecast) = all.entry(name).or_insert_with(|| (line, PedestrianForecast::default()));
                forecast.positions.extend(positions);
                let known = forecast.frames.get_or_insert_with(|| frames.clone());
                (*known != frames).then(|| Fault::named("frame", wrong_frames(&frames, known)))
            };
            if let Some(problem) = problem {
                return Err(problem.in_line(&origin, line).into());
            }
        }
    }
    for (pedestrian, (line, forecast)) in all {
        let who = PedestrianKey { recording: Some(recording.to_owned()), observed_until, pedestrian };
        expected.put(&who, forecast, line).map_err(|fault| fault.in_line(&samples[0].display().to_string(), line))?;
    }
    Ok(())
}

fn read_sample(file: &Path, origin: &str) -> Result<SampleFile, ExternalError> {
    let reader = BufReader::new(File::open(file).map_err(|source| of_file(file, source))?);
    let (mut lines, mut sample) = (lines_of(reader, origin), SampleFile::new());
    let mut last = None;
    while let Some(text) = lines.next_filled()? {
        let (name, frame, position) = row(text).map_err(|fault| lines.wrong(fault))?;
        if last.as_ref() != Some(&name) && sample.contains_key(&name) {
            return Err(lines.wrong(format!("the rows of pedestrian {name} must stand together")).into());
        }
        last = Some(name.clone());
        let (_, frames, positions) = sample.entry(name).or_insert_with(|| (lines.number(), Vec::new(), Vec::new()));
        frames.push(frame);
        positions.push(position);
    }
    Ok(sample)
}

fn row(text: &str) -> Result<(PedestrianName, i64, Position), Fault> {
    let fields: Vec<&str> = text.split_ascii_whitespace().collect();
    let &[frame, pedestrian, x, y] = fields.as_slice() else {
        let found = fields.len();
        return Err(Fault::from(format!("{found} numbers; a row is `frame pedestrian x y`, with spaces between them")));
    };
    let position = [finite(x, "x")?, finite(y, "y")?];
    within_bounds(position, || "x, y".to_owned())?;
    Ok((PedestrianName::Number(whole_number(pedestrian, "pedestrian")?), whole_number(frame, "frame")?, position))
}

/// The files `sample_000.txt` ... of a window, of which none is left out.
fn samples_of(moment: &Path) -> Result<Vec<PathBuf>, ExternalError> {
    let samples = numbered::<usize>(moment, "sample_", ".txt")?;
    if samples.len() > Protocol::MAX_HYPOTHESES {
        let (found, allowed) = (samples.len(), Protocol::MAX_HYPOTHESES);
        let problem = format!("holds {found} samples; {allowed} are allowed, chosen without the true future");
        return Err(in_folder(moment, problem));
    }
    let gap = (0..).zip(&samples).find(|(k, (number, _))| k != number);
    let missing = gap.map(|(k, _)| k).or(samples.is_empty().then_some(0));
    match missing {
        Some(k) => Err(in_folder(moment, format!("{} is missing; samples are numbered from 000", sample_name(k)))),
        None => Ok(samples.into_iter().map(|(_, file)| file).collect()),
    }
}

/// What a folder holds under names of a number between these two texts, by number.
fn numbered<N: std::str::FromStr + Ord>(
    folder: &Path,
    start: &str,
    end: &str,
) -> Result<Vec<(N, PathBuf)>, ExternalError> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(|source| of_file(folder, source))? {
        let path = entry.map_err(|source| of_file(folder, source))?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let number = name.strip_prefix(start).and_then(|rest| rest.strip_suffix(end));
        if let Some(number) = number.and_then(|number| number.parse().ok()) {
            found.push((number, path));
        }
    }
    found.sort();
    Ok(found)
}

/// The literature's name of a recording: that of its `social-gan` file, such as `biwi_eth`; for others their own name.
fn scene_name(recording: &str) -> &str {
    let stems = Convention::SocialGan.file_names().filter_map(|file| file.strip_suffix(".txt"));
    let mut named = stems.filter(|stem| stem.split_once('_').is_some_and(|(_, name)| name == recording));
    named.next().unwrap_or(recording)
}

fn sample_name(k: usize) -> String {
    format!("sample_{k:03}.txt")
}

fn in_folder(path: &Path, problem: impl Into<String>) -> ExternalError {
    of_file(path, Error::new(ErrorKind::InvalidInput, problem.into()))
}

fn of_file(path: &Path, source: Error) -> ExternalError {
    ExternalError::Io { origin: path.display().to_string(), source }
}
