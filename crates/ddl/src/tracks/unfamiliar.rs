//! Motions unlike the training motions, in words.

use crate::note::Note;
use crate::tracks::moment::Moment;
use crate::trust::familiarity::UNFAMILIAR_THRESHOLD;

/// The motions of forecasts so far, and those unlike the training motions.
#[derive(Debug, Default)]
pub struct UnfamiliarMotions {
    motions: usize,
    unfamiliar: usize,
    /// Whose motion was the first, and when.
    first: Option<String>,
    is_told: bool,
}

impl UnfamiliarMotions {
    /// Counts the motions of these moments.
    pub fn add(&mut self, moments: &[Moment<'_>]) {
        for moment in moments {
            for i in 0..moment.window.len() {
                self.motions += 1;
                let familiarity = moment.answer.forecast().familiarity(i);
                if familiarity.is_some_and(|f| f < UNFAMILIAR_THRESHOLD) {
                    self.unfamiliar += 1;
                    let first = || format!("{} observed until {}", moment.who(i), moment.when());
                    self.first.get_or_insert_with(first);
                }
            }
        }
    }

    /// A warning, if there are such motions; only once.
    pub fn warning(&mut self) -> Option<Note> {
        let first = self.first.as_ref().filter(|_| !self.is_told)?;
        self.is_told = true;
        Some(Note::Unfamiliar { count: self.unfamiliar, of: self.motions, first: first.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_core::{Forecast, PedestrianId, Window};
    use ddl_data::{Clock, FrameNumber, SceneName};

    /// 7 frames a second: 5 ticks a frame, 14 a step. The window ends at tick 7 * 14 + 70 = 168, frame 33.6, after 4.8
    /// s.
    #[test]
    fn moments_count_frames_and_the_unfamiliar_are_told_once() {
        let clock = Clock::with_frame_time(1.0 / 7.0).unwrap();
        let ids = vec![PedestrianId(4), PedestrianId(2)];
        let window = Window::new("yard", 70, 14, ids, vec![vec![[0.0, 1.0]; 8]; 2]).unwrap();
        let forecast = Forecast::with_equal_weights(2, 1, vec![[0.0; 2]; 24]).unwrap();
        let answer = forecast.with_familiarity(vec![0.010_1, 0.009_9]).unwrap().into();
        let hall = SceneName::new("hall").unwrap();
        let moment = Moment { scene: Some(&hall), ..Moment::new(&window, &answer, clock) };
        assert_eq!((moment.microseconds(), moment.observed_until()), (4_800_000, FrameNumber::Between(33.6)));
        let frames = moment.frames();
        assert_eq!((frames.len(), frames[0], frames[4]), (12, FrameNumber::Between(36.4), FrameNumber::Between(47.6)));
        let mut motions = UnfamiliarMotions::default();
        motions.add(&[moment, moment]);
        let told = motions.warning().unwrap().line();
        assert!(
            told.contains("2 of 4 motions") && told.contains("pedestrian 2 of scene hall observed until frame 33.6")
        );
        assert!(motions.warning().is_none());
    }
}
