//! Forecasts that match no pedestrian, and their likely reason.

use crate::external::pedestrian_key::{PedestrianKey, named};

pub(super) const NAMED: usize = 3;

#[derive(Debug, Default)]
pub(super) struct Unknown {
    pub(super) count: usize,
    pub(super) first: Vec<String>,
    recordings: Vec<String>,
    /// Number of forecasts that would match if the frame were the first one of the window.
    as_first_frame: usize,
    /// Number of forecasts that would match if the frame were the first forecast frame.
    as_next_frame: usize,
    frames: Option<(i64, i64)>,
}

impl Unknown {
    pub(super) fn remember(
        &mut self,
        who: &PedestrianKey,
        recording: Option<&str>,
        as_first_frame: bool,
        as_next_frame: bool,
    ) {
        self.count += 1;
        let name = who.recording.as_deref().or(recording);
        if self.first.len() < NAMED {
            self.first.push(named(name, who.observed_until, &who.pedestrian));
        }
        if let (None, Some(name)) = (recording, name)
            && self.recordings.len() < NAMED
            && !self.recordings.iter().any(|other| other == name)
        {
            self.recordings.push(name.to_owned());
        }
        self.as_first_frame += usize::from(as_first_frame);
        self.as_next_frame += usize::from(as_next_frame);
        let frame = who.observed_until;
        let (least, greatest) = self.frames.unwrap_or((frame, frame));
        self.frames = Some((least.min(frame), greatest.max(frame)));
    }

    /// A likely reason why the forecasts match no pedestrian, given how many others match.
    pub(super) fn hint(&self, recordings: &[&str], range: Option<(i64, i64)>, fitting: usize) -> String {
        if !self.recordings.is_empty() {
            return format!(
                "the windows are of {}, the file also of {}; is it of another fold?",
                recordings.join(" and "),
                self.recordings.join(" and ")
            );
        }
        // If more forecasts match without a shift, the frame is not the reason.
        let most = fitting.max(self.count / 2);
        for (count, frame) in
            [(self.as_first_frame, "first frame of a window"), (self.as_next_frame, "first frame forecast")]
        {
            if count > most {
                return format!(
                    "most would match if observed_until were the {frame}; it must be the last observed one"
                );
            }
        }
        match (self.frames, range) {
            (Some((from, to)), Some((least, greatest))) => format!(
                "their frames run from {from} to {to}, those of the windows from {least} to {greatest}; is the \
                 file of another fold, data convention or window rule?"
            ),
            _ => "is the file of another fold, data convention or window rule?".to_owned(),
        }
    }
}
