//! The windows of a recording under a rule.

use std::ops::Range;

use ddl_core::{PedestrianId, Position, WINDOW, Window};

use crate::recording::Recording;
use crate::rule::WindowRule;

/// Step at which the published loader requires a pedestrian to be seen again: one beyond the window.
const STEPS_AHEAD: i64 = 20;

impl Recording {
    /// All windows of the recording under a rule, in order of their start frame. This includes the window of the first
    /// frame, which a *fold* leaves out ([`Fold::test_windows`](crate::Fold::test_windows)).
    #[must_use]
    pub fn windows(&self, rule: WindowRule) -> Vec<Window> {
        if rule == WindowRule::Observed {
            return self.windows_with_futures();
        }
        let links = Links::new(self, rule);
        let starts = 0..self.frames().len();
        starts.filter_map(|index| links.window(index)).collect()
    }
}

/// For each observation, the observation of the same pedestrian one step later.
struct Links<'a> {
    recording: &'a Recording,
    rule: WindowRule,
    next: Vec<Option<usize>>,
    /// Number of steps, this one included, for which the pedestrian is present without a gap.
    run: Vec<usize>,
}

impl<'a> Links<'a> {
    fn new(recording: &'a Recording, rule: WindowRule) -> Self {
        let count = recording.observations().len();
        let mut links = Self { recording, rule, next: vec![None; count], run: vec![0; count] };
        for frame_index in (0..recording.frames().len()).rev() {
            let here = recording.range_of(frame_index);
            for (from, to) in links.pairs(here.clone(), links.frame_after(frame_index)) {
                links.next[from] = Some(to);
            }
            for from in here {
                if !links.counts(from) {
                    continue;
                }
                links.run[from] = 1 + links.next[from].map_or(0, |to| links.run[to]);
            }
        }
        links
    }

    fn frame_after(&self, index: usize) -> Range<usize> {
        match self.rule {
            WindowRule::Published | WindowRule::Complete | WindowRule::Observed => {
                self.recording.range_at(self.recording.frames()[index] + self.recording.frame_step())
            }
            WindowRule::SocialGan { .. } if index + 1 < self.recording.frames().len() => {
                self.recording.range_of(index + 1)
            }
            WindowRule::SocialGan { .. } => 0..0,
        }
    }

    fn counts(&self, observation: usize) -> bool {
        self.rule != WindowRule::Published || self.recording.observations()[observation].position != [0.0, 0.0]
    }

    /// The pairs of observations of two frames that show the same pedestrian; both frames are sorted by pedestrian.
    fn pairs(&self, from: Range<usize>, to: Range<usize>) -> Vec<(usize, usize)> {
        let pedestrian = |i: usize| self.recording.observations()[i].pedestrian;
        let mut pairs = Vec::with_capacity(from.len().min(to.len()));
        let mut later = to.start;
        for earlier in from.filter(|&i| self.counts(i)) {
            while later < to.end && pedestrian(later) < pedestrian(earlier) {
                later += 1;
            }
            if later < to.end && pedestrian(later) == pedestrian(earlier) && self.counts(later) {
                pairs.push((earlier, later));
            }
        }
        pairs
    }

    /// Whether the rule allows the `index`-th annotated frame to start a window.
    fn may_start(&self, index: usize) -> bool {
        if self.rule != WindowRule::Published {
            return true;
        }
        let frames = self.recording.frames();
        let beyond = frames[index] + STEPS_AHEAD * self.recording.frame_step();
        let (here, beyond) = (self.recording.range_of(index), self.recording.range_at(beyond));
        !self.pairs(here, beyond).is_empty()
    }

    fn window(&self, index: usize) -> Option<Window> {
        let first: Vec<usize> = self.recording.range_of(index).filter(|&i| self.run[i] >= WINDOW).collect();
        let fewest = match self.rule {
            WindowRule::SocialGan { min_pedestrians } => min_pedestrians.max(1),
            WindowRule::Published | WindowRule::Complete | WindowRule::Observed => 1,
        };
        if first.len() < fewest || !self.may_start(index) {
            return None;
        }
        let observations = self.recording.observations();
        let follow =
            |start: usize| std::iter::successors(Some(start), |&i| self.next[i]).take(WINDOW).map(|i| &observations[i]);
        let frames = follow(first[0]).map(|o| o.frame).collect();
        let pedestrians: Vec<PedestrianId> = first.iter().map(|&i| observations[i].pedestrian).collect();
        let positions: Vec<Position> = first.iter().flat_map(|&i| follow(i)).map(|o| o.position).collect();
        let name = self.recording.shared_name();
        let window = Window::cut(name, self.recording.frame_step(), frames, pedestrians, positions);
        Some(window.with_names(self.recording.names().clone()))
    }
}
