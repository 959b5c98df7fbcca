//! TrajNet++ ndjson: scenes of 8 or 9 observed and 12 forecast frames with their forecast tracks.
//!
//! A scene belongs to the window that starts at its first frame or, with 9 observed frames, at its second. A
//! neighbour's forecast counts if no scene of the window has it as primary; pedestrians outside the window are ignored.
//! Hypothesis k of a window is composed of the forecasts k of its scenes.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::io::BufRead;

use ddl_core::{HORIZON, OBSERVED, PedestrianName, Position, TIME_STEP, Window};
use serde::Deserialize;

use crate::external::error::ExternalError;
use crate::external::expected::{ExpectedForecasts, PedestrianForecast};
use crate::external::json::{self, Whole};
use crate::external::lines::{Lines, Wrong, in_field, missing, within_bounds, wrong_length};
use crate::external::pedestrian_key::{HypothesisNumbering, PedestrianKey, frames_ahead, in_short, wrong_frames};
use crate::protocol::Protocol;

/// Lines and fields of other names are ignored.
#[derive(Debug, Deserialize)]
struct NdjsonLine {
    scene: Option<NdjsonScene>,
    track: Option<NdjsonTrack>,
}

/// `recording` is an extension for folds of several recordings.
#[derive(Debug, Clone, Deserialize)]
struct NdjsonScene {
    #[serde(deserialize_with = "json::whole")]
    id: i64,
    #[serde(deserialize_with = "json::pedestrian")]
    p: PedestrianName,
    #[serde(deserialize_with = "json::whole")]
    s: i64,
    #[serde(deserialize_with = "json::whole")]
    e: i64,
    recording: Option<String>,
}

#[derive(Debug, Deserialize)]
struct NdjsonTrack {
    #[serde(deserialize_with = "json::whole")]
    f: i64,
    #[serde(deserialize_with = "json::pedestrian")]
    p: PedestrianName,
    x: f64,
    y: f64,
    prediction_number: Option<Whole>,
    scene_id: Option<Whole>,
}

type Predictions = BTreeMap<i64, Vec<(i64, Position)>>;

struct OpenScene<'a> {
    scene: NdjsonScene,
    window: Option<&'a Window>,
    tracks: BTreeMap<PedestrianName, (usize, Predictions)>,
}

pub(super) fn read(mut lines: Lines<impl BufRead>, expected: &mut ExpectedForecasts<'_>) -> Result<(), ExternalError> {
    let mut reading = Reading::new(expected);
    while let Some((number, text)) = lines.next_line()? {
        let taken = json::read(text)
            .map_err(|wrong| (number, wrong))
            .and_then(|line| reading.take(line, number));
        if let Err((number, wrong)) = taken {
            return Err(lines.wrong(number, wrong));
        }
    }
    let closed = reading.close();
    closed.map_err(|(number, wrong)| lines.wrong(number, wrong))
}

struct Reading<'w, 'a> {
    expected: &'w mut ExpectedForecasts<'a>,
    /// Index of the window by index of the recording and first frame.
    by_start: HashMap<(usize, i64), usize>,
    scenes: HashMap<i64, NdjsonScene>,
    finished: HashSet<i64>,
    open: Option<OpenScene<'a>>,
    numbering: HypothesisNumbering,
}

impl<'w, 'a> Reading<'w, 'a> {
    fn new(expected: &'w mut ExpectedForecasts<'a>) -> Self {
        let windows = expected.windows.iter().enumerate();
        let by_start = windows
            .filter_map(|(index, window)| {
                let recording = expected.recordings.iter().position(|&r| r == window.recording())?;
                Some(((recording, window.start_frame()), index))
            })
            .collect();
        Self {
            expected,
            by_start,
            scenes: HashMap::new(),
            finished: HashSet::new(),
            open: None,
            numbering: HypothesisNumbering::default(),
        }
    }

    fn take(&mut self, line: NdjsonLine, number: usize) -> Result<(), (usize, Wrong)> {
        if let Some(scene) = line.scene {
            let id = scene.id;
            if self.scenes.insert(id, scene).is_some() {
                return Err((number, scattered("scene.id", id)));
            }
        }
        let Some(track) = line.track else {
            return Ok(());
        };
        // Tracks without a number were observed.
        let Some(Whole(prediction)) = track.prediction_number else {
            return Ok(());
        };
        let Whole(id) = track.scene_id.ok_or_else(|| (number, missing("track.scene_id")))?;
        if self.open.as_ref().is_none_or(|open| open.scene.id != id) {
            self.close()?;
            if self.finished.contains(&id) {
                return Err((number, scattered("track.scene_id", id)));
            }
            let Some(scene) = self.scenes.get(&id).cloned() else {
                let problem = format!("scene {id} has no scene line before its tracks");
                return Err((number, in_field("track.scene_id", problem)));
            };
            let open = self.open(scene).map_err(|wrong| (number, wrong))?;
            self.open = Some(open);
        }
        let Some(mut open) = self.open.take() else {
            return Ok(());
        };
        let added = self.add(&mut open, &track, prediction, number);
        self.open = Some(open);
        added.map_err(|wrong| (number, wrong))
    }

    fn open(&self, scene: NdjsonScene) -> Result<OpenScene<'a>, Wrong> {
        let recording = self.expected.recording(scene.recording.as_deref())?;
        let starting_at = |frame: i64| -> Option<&'a Window> {
            let index = *self.by_start.get(&(recording?, frame))?;
            Some(&self.expected.windows[index])
        };
        let at_first = starting_at(scene.s);
        let at_second = starting_at(scene.s.saturating_add(self.step()));
        let ends = |window: &&Window| ends_at(window, scene.e);
        let window = at_first.filter(ends).or(at_second.filter(ends));
        if let (None, Some(first)) = (window, at_first) {
            return Err(wrong_end(first, &scene));
        }
        let tracks = BTreeMap::new();
        Ok(OpenScene { scene, window, tracks })
    }

    fn add(&self, open: &mut OpenScene<'a>, track: &NdjsonTrack, prediction: i64, number: usize) -> Result<(), Wrong> {
        let in_window = |w: &Window| w.named(&track.p).is_some();
        if track.p != open.scene.p && !open.window.is_some_and(in_window) {
            return Ok(());
        }
        let who = || self.who(&open.scene, open.window, track.p.clone());
        let (_, predictions) = open
            .tracks
            .entry(track.p.clone())
            .or_insert_with(|| (number, Predictions::new()));
        if predictions.len() == Protocol::MAX_HYPOTHESES && !predictions.contains_key(&prediction) {
            let problem = who().too_many_hypotheses();
            return Err(in_field("track.prediction_number", problem));
        }
        let rows = predictions.entry(prediction).or_default();
        if rows.len() == HORIZON {
            let path = format!("prediction_number {prediction}");
            return Err(in_field(path, wrong_length(HORIZON + 1)));
        }
        let position = [track.x, track.y];
        within_bounds(position, || "track.x, track.y".to_owned())?;
        rows.push((track.f, position));
        Ok(())
    }

    fn who(&self, scene: &NdjsonScene, window: Option<&Window>, pedestrian: PedestrianName) -> PedestrianKey {
        PedestrianKey {
            recording: scene.recording.clone(),
            observed_until: window.map_or_else(|| self.unknown_last(scene), |w| w.frames()[OBSERVED - 1]),
            pedestrian,
        }
    }

    fn close(&mut self) -> Result<(), (usize, Wrong)> {
        let Some(open) = self.open.take() else {
            return Ok(());
        };
        let OpenScene { scene, window, tracks } = open;
        self.finished.insert(scene.id);
        for (pedestrian, (line, predictions)) in tracks {
            let primary = pedestrian == scene.p;
            let who = self.who(&scene, window, pedestrian);
            let numbers: Vec<i64> = predictions.keys().copied().collect();
            let numbered = self.numbering.check(&numbers, &who.named());
            numbered.map_err(|problem| (line, in_field("prediction_number", problem)))?;
            let ahead = window.map_or_else(
                || vec![self.unknown_ahead(&scene)],
                |window| frames_ahead(window).into(),
            );
            let forecast = forecast(predictions, &ahead).map_err(|wrong| (line, wrong))?;
            let put = self.expected.put(&who, forecast, line, primary);
            put.map_err(|wrong| (line, wrong))?;
        }
        Ok(())
    }

    fn unknown_last(&self, scene: &NdjsonScene) -> i64 {
        scene.e.saturating_sub(HORIZON as i64 * self.step())
    }

    /// The forecast frames of a scene that starts with no window.
    fn unknown_ahead(&self, scene: &NdjsonScene) -> Vec<i64> {
        let last = self.unknown_last(scene);
        let steps = 1..=HORIZON as i64;
        steps.map(|step| last.saturating_add(step * self.step())).collect()
    }

    fn step(&self) -> i64 {
        self.expected.windows.first().map_or(1, Window::frame_step)
    }
}

fn ends_at(window: &Window, frame: i64) -> bool {
    let last = frames_ahead(window).map(|frames| frames.last().copied());
    last.contains(&Some(frame))
}

fn scattered(field: &str, scene: i64) -> Wrong {
    let problem = "ended on an earlier line; the tracks of a scene must be consecutive";
    in_field(field, format!("scene {scene} {problem}"))
}

/// A scene needs 8 or 9 observed and 12 forecast frames to match the window that starts with it.
fn wrong_end(window: &Window, scene: &NdjsonScene) -> Wrong {
    let problem = format!(
        "the scene has the frames {} to {}; the window that starts there has the observed frames {} and the forecast \
         frames {}: a scene has 8 or 9 observed and 12 forecast frames, {TIME_STEP} s apart",
        scene.s,
        scene.e,
        in_short(&window.frames()[..OBSERVED]),
        in_short(&frames_ahead(window)[0]),
    );
    in_field(format!("scene {}", scene.id), problem)
}

/// The forecast of a pedestrian, at any of these frames.
fn forecast(predictions: Predictions, ahead: &[Vec<i64>]) -> Result<PedestrianForecast, Wrong> {
    let mut forecast = PedestrianForecast::default();
    for (number, mut rows) in predictions {
        let path = || format!("prediction_number {number}");
        rows.sort_by_key(|&(frame, _)| frame);
        if rows.len() != HORIZON {
            return Err(in_field(path(), wrong_length(rows.len())));
        }
        let frames: Vec<i64> = rows.iter().map(|&(frame, _)| frame).collect();
        if !ahead.contains(&frames) {
            return Err(in_field(path(), wrong_frames(&frames, &ahead[0])));
        }
        forecast
            .positions
            .extend(rows.into_iter().map(|(_, position)| position));
    }
    Ok(forecast)
}
