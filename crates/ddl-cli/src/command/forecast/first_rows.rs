//! The first rows of a stream, which show whether its units and its rate can be right.

use crate::recordings;
use ddl::data::{Observation, PedestrianId, PlausibilityWarning, Position, Recording, SceneName};

/// Rows that show as much as a whole recording does.
const ENOUGH: usize = 2000;

/// Collects rows of the first scene, until a warning is given or there are enough.
#[derive(Debug, Default)]
pub(super) struct FirstRows {
    /// The scene, and its ticks in 0.4 s.
    of: Option<(Option<SceneName>, i64)>,
    rows: Vec<Observation>,
    is_looked_at: bool,
}

impl FirstRows {
    pub(super) fn add(
        &mut self,
        scene: Option<&SceneName>,
        (tick, frame_step): (i64, i64),
        pedestrians: &[(PedestrianId, Position)],
    ) {
        let of = self.of.get_or_insert_with(|| (scene.cloned(), frame_step));
        if self.is_looked_at || of.0.as_ref() != scene {
            return;
        }
        let rows = pedestrians.iter().map(|&(id, at)| Observation::new(tick, id, at));
        self.rows.extend(rows);
        if self.rows.len() >= ENOUGH {
            self.warn();
        }
    }

    /// Warns of positions or a rate that cannot be right, as soon as somebody was seen for 8 steps.
    pub(super) fn warn_if_fast(&mut self) {
        let warning = self
            .warning()
            .filter(|it| matches!(it, PlausibilityWarning::Fast { .. }));
        if let Some(warning) = warning {
            recordings::warn_of(&warning);
            self.end();
        }
    }

    /// Warns as of a file. A jump is told as a row that does not fit, and that nobody is forecast at the end.
    pub(super) fn warn(&mut self) {
        match self.warning() {
            None | Some(PlausibilityWarning::Jump(_) | PlausibilityWarning::NoSteps { .. }) => {}
            Some(warning) => recordings::warn_of(&warning),
        }
        self.end();
    }

    fn warning(&self) -> Option<PlausibilityWarning> {
        let (_, frame_step) = self.of.as_ref().filter(|_| !self.is_looked_at)?;
        let recording = Recording::new("standard input", *frame_step, self.rows.clone());
        // Cannot fail: the tracks took these rows.
        recording.ok()?.speed_warning()
    }

    fn end(&mut self) {
        self.rows = Vec::new();
        self.is_looked_at = true;
    }
}
