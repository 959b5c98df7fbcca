//! From rows, each with its place in the file, to a recording.

use std::collections::{BTreeMap, BTreeSet};

use ddl_core::{Numbering, PedestrianId, PedestrianName, PedestrianNames, Position, Setting};

use crate::clock::{STAMPS_A_SECOND, TimeUnit};
use crate::file_error::DataError;
use crate::format::fault::{FilePlace, FormatError};
use crate::format::problem::{EMPTY, MIXED_TIMES, duplicate};
use crate::observation::Observation;
use crate::observe::LONGEST_GAP;
use crate::recording::Recording;
use crate::scene_name::SceneName;

#[derive(Debug)]
pub(super) struct TrackRow {
    /// The scene that the line names, if it does.
    pub(super) scene: Option<SceneName>,
    /// A frame number, or microseconds.
    pub(super) frame: i64,
    /// What the field of the time counts; `None` for frame numbers.
    pub(super) unit: Option<TimeUnit>,
    pub(super) pedestrian: PedestrianName,
    pub(super) position: Position,
    pub(super) place: FilePlace,
}

impl TrackRow {
    /// A row with numbers alone.
    pub(super) fn numbered(frame: i64, pedestrian: i64, position: Position, place: FilePlace) -> Self {
        Self { scene: None, frame, unit: None, pedestrian: PedestrianName::Number(pedestrian), position, place }
    }
}

type Placed = (Observation, FilePlace);

/// The recording of all rows, with an inferred frame step. `advice_on_same` is advice on two lines with one pedestrian
/// in one frame.
pub(super) fn into_recording(
    rows: Vec<TrackRow>,
    origin: &str,
    advice_on_same: impl Fn([usize; 2]) -> String,
) -> Result<Recording, DataError> {
    let (restarts, unit) = (restarts(&rows), rows.first().and_then(|row| row.unit));
    let (observations, names) = observations(rows, unit, advice_on_same).map_err(|error| error.in_text(origin))?;
    let recording = Recording::in_usual_step(origin, observations);
    let mut recording = recording.map_err(|source| DataError::Recording { name: origin.to_owned(), source })?;
    recording.restarts = restarts;
    Ok(recording.with_names(names).with_time_unit(unit))
}

/// The observations of the rows of one recording, all of this unit, each pedestrian at most once in a frame.
fn observations(
    rows: Vec<TrackRow>,
    unit: Option<TimeUnit>,
    advice_on_same: impl Fn([usize; 2]) -> String,
) -> Result<(Vec<Observation>, PedestrianNames), FormatError> {
    if rows.is_empty() {
        return Err(FilePlace::line(1).wrong(EMPTY));
    }
    if let Some(row) = rows.iter().find(|row| row.scene != rows[0].scene) {
        let keep = Setting::Keep.to("scene=NAME");
        let problem = format!(
            "a file holds one recording, but this row is of another scene than the first; read it as a stream, make a \
             file of each scene, or read one scene of a table ({keep})"
        );
        return Err(row.place.wrong(problem));
    }
    if let Some(row) = rows.iter().find(|row| row.unit != unit) {
        return Err(row.place.wrong(MIXED_TIMES));
    }
    let (mut placed, names) = numbered(rows);
    if let Some([first, again]) = first_duplicate(&mut placed) {
        let (seen, place) = again;
        let lines = [first.1, *place].map(FilePlace::line_number);
        let problem = duplicate(names.of(seen.pedestrian), (seen.frame, unit), lines[0]);
        return Err(place.wrong(problem + &advice_on_same(lines)));
    }
    Ok((placed.into_iter().map(|(seen, _)| seen).collect(), names))
}

/// The observations with pedestrian numbers: those of the file and, for words, others in the order of first appearance.
fn numbered(rows: Vec<TrackRow>) -> (Vec<Placed>, PedestrianNames) {
    // In order of time, as a stream gives them: later rows change no number.
    let mut rows = rows;
    rows.sort_by_key(|row| row.frame);
    let mut numbering = Numbering::remembering(usize::MAX);
    let mut names = BTreeMap::new();
    let placed = rows.into_iter().map(|row| {
        let pedestrian = match row.pedestrian {
            PedestrianName::Number(number) => PedestrianId(number),
            PedestrianName::Word(word) => {
                let (id, word) = numbering.number(&word);
                names.entry(id).or_insert(word);
                id
            }
        };
        (Observation::new(row.frame, pedestrian, row.position), row.place)
    });
    (placed.collect(), PedestrianNames::new(names))
}

/// How often the frames of a file begin again. A row up to 2 s, or five of the smallest frame steps, before the last
/// one is only out of order.
fn restarts(rows: &[TrackRow]) -> usize {
    let rises = rows.array_windows().map(|[before, row]| row.frame - before.frame);
    let disorder = match rows.first().and_then(|row| row.unit) {
        Some(_) => (LONGEST_GAP * STAMPS_A_SECOND as f64) as i64,
        None => 5 * rises.filter(|rise| *rise > 0).min().unwrap_or(1),
    };
    let parts: Vec<&[TrackRow]> = rows.chunk_by(|row, next| row.frame - next.frame <= disorder).collect();
    // Pedestrians take turns, instead of following each other.
    let is_crowd = |part: &&[TrackRow]| {
        let changes = part.array_windows().filter(|[before, row]| before.pedestrian != row.pedestrian);
        let pedestrians: BTreeSet<&PedestrianName> = part.iter().map(|row| &row.pedestrian).collect();
        changes.count() >= pedestrians.len()
    };
    match parts.len() {
        0 | 1 => 0,
        count if parts.iter().all(is_crowd) => count - 1,
        _ => restarts_of_tracks(rows, disorder),
    }
}

/// The same for a file in another order, such as one pedestrian after the other. It is 0 unless the rows of every
/// pedestrian form parts in order of time, and each part is wholly earlier than the part before it.
fn restarts_of_tracks(rows: &[TrackRow], disorder: i64) -> usize {
    let mut tracks: BTreeMap<&PedestrianName, Vec<i64>> = BTreeMap::new();
    for row in rows {
        tracks.entry(&row.pedestrian).or_default().push(row.frame);
    }
    let restarts = tracks.values().map(|frames| {
        let parts: Vec<&[i64]> = frames.chunk_by(|frame, next| frame < next).collect();
        let begins_again =
            |[part, next]: &[&[i64]; 2]| next.last() < part.first() && part[part.len() - 1] - next[0] > disorder;
        parts.array_windows().all(begins_again).then_some(parts.len() - 1)
    });
    restarts.reduce(|most, count| Some(most?.max(count?))).flatten().unwrap_or(0)
}

/// Sorts the rows by frame and pedestrian, and finds the first of the file that repeats both of another.
fn first_duplicate(rows: &mut [Placed]) -> Option<&[Placed; 2]> {
    let key = |(seen, _): &Placed| (seen.frame, seen.pedestrian);
    rows.sort_unstable_by_key(|row| (key(row), row.1));
    rows.array_windows().filter(|[first, again]| key(first) == key(again)).min_by_key(|[_, again]| again.1)
}
