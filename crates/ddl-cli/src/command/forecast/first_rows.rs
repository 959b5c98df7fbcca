//! The first rows of each scene of a stream, which show whether its units and its rate can be right.

#![expect(clippy::ref_option, reason = "the keys of the map of scenes")]

use crate::telling::tell_note;
use ddl::Note;
use ddl::data::{LiveTracks, Observation, PedestrianId, PlausibilityWarning, Position, Recording, SceneName};
use std::collections::{BTreeMap, BTreeSet};

/// Steps of 0.4 s, rows, and pedestrians that show as much as a whole recording does.
const ENOUGH_STEPS: i64 = 50;
const ENOUGH_ROWS: usize = 2000;
const PEDESTRIANS: usize = 100;
/// Limits of what is kept, for any rate and any number of scenes.
const MOST_ROWS: usize = 200_000;
const MOST_SCENES: usize = 20;

/// Collects rows until a warning is given, or there are enough.
#[derive(Debug, Default)]
pub(super) struct FirstRows {
    scenes: BTreeMap<Option<SceneName>, FirstSceneRows>,
    is_told: bool,
}

#[derive(Debug, Default)]
struct FirstSceneRows {
    frame_step: i64,
    rows: Vec<Observation>,
    pedestrians: BTreeSet<PedestrianId>,
    /// Whether it was looked at when somebody was seen for 8 steps.
    is_looked_at: bool,
    is_done: bool,
}

impl FirstRows {
    /// Whether the rows of this scene are still wanted.
    pub(super) fn watches(&self, scene: &Option<SceneName>) -> bool {
        let room = || self.scenes.len() < MOST_SCENES;
        !self.is_told && self.scenes.get(scene).map_or_else(room, |rows| !rows.is_done)
    }

    /// Adds the rows of the last frame of these tracks.
    pub(super) fn add(
        &mut self,
        scene: &Option<SceneName>,
        tracks: &LiveTracks,
        pedestrians: &[(PedestrianId, Position)],
    ) {
        let Some(tick) = tracks.last_frame().filter(|_| self.watches(scene)) else {
            return;
        };
        let of_scene = self.scenes.entry(scene.clone()).or_default();
        of_scene.frame_step = tracks.clock().frame_step();
        for &(id, position) in pedestrians {
            if of_scene.pedestrians.len() < PEDESTRIANS {
                of_scene.pedestrians.insert(id);
            }
            if of_scene.pedestrians.contains(&id) {
                of_scene.rows.push(Observation::new(tick, id, position));
            }
        }
        let first = of_scene.rows.first();
        let steps = first.map_or(0, |first| (tick - first.frame) / of_scene.frame_step);
        let rows = of_scene.rows.len();
        if (rows >= ENOUGH_ROWS && steps >= ENOUGH_STEPS) || rows >= MOST_ROWS {
            self.is_told |= of_scene.warn();
        }
    }

    /// Warns of positions or a rate that cannot be right, as soon as somebody of a scene was seen for 8 steps.
    pub(super) fn warn_if_fast(&mut self, scene: &Option<SceneName>) {
        let is_wanted = |rows: &&mut FirstSceneRows| !rows.is_looked_at && !rows.is_done;
        if let Some(rows) = self.scenes.get_mut(scene).filter(is_wanted) {
            rows.is_looked_at = true;
            if let Some(warning @ PlausibilityWarning::Fast { .. }) = rows.warning().filter(|_| !self.is_told) {
                tell_note(&Note::Implausible(warning));
                self.is_told = true;
            }
        }
    }

    /// Warns at the end of the stream.
    pub(super) fn warn(&mut self) {
        for rows in self.scenes.values_mut() {
            if !self.is_told && !rows.is_done {
                self.is_told = rows.warn();
            }
        }
    }
}

impl FirstSceneRows {
    /// Gives the warning that a file with these rows gets, and returns whether there was one. Two kinds are left out: a
    /// single jump, because the position is reported as left out, and rows that are never 0.4 s apart, because the end
    /// of the stream reports that no pedestrian was observed long enough.
    fn warn(&mut self) -> bool {
        let warning = self.warning();
        *self = Self { is_done: true, ..Self::default() };
        match warning {
            None | Some(PlausibilityWarning::Jump { .. } | PlausibilityWarning::NoSteps) => false,
            Some(warning) => {
                tell_note(&Note::Implausible(warning));
                true
            }
        }
    }

    fn warning(&self) -> Option<PlausibilityWarning> {
        let recording = Recording::new("standard input", self.frame_step, self.rows.clone());
        // Fails only without rows: the tracks took these.
        recording.ok()?.speed_warning()
    }
}
