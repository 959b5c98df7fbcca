//! Summary of a recording, with plausibility checks.

use std::collections::BTreeMap;

use ddl_core::{PedestrianId, PedestrianName, Position, TIME_STEP, bounds};
use serde::Serialize;

use crate::live::Completeness;
use crate::observation::Observation;
use crate::observe::Misfit;
use crate::plausibility::{Fastest, OFTEN, PlausibilityWarning, is_frozen, restarted};
use crate::recording::Recording;

/// Summary of a recording, in steps of 0.4 s.
///
/// ```
/// use ddl_core::PedestrianId;
/// use ddl_data::{Observation, Recording};
///
/// let walk = (0..20).map(|t| Observation::new(10 * t, PedestrianId(1), [0.5 * t as f64, 2.0]));
/// let summary = Recording::new("yard", 10, walk.collect())?.summary();
/// assert_eq!((summary.pedestrians, summary.to_learn_from, summary.to_forecast), (1, 1, 20));
/// assert_eq!((summary.seconds, summary.median_speed), (7.6, Some(1.25)));
/// assert!(summary.warnings().is_empty());
/// # Ok::<(), ddl_data::RecordingError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Summary {
    /// Name of the recording.
    pub recording: String,
    /// Number of annotated frames.
    pub frames: usize,
    /// First raw frame number.
    pub first_frame: i64,
    /// Last raw frame number.
    pub last_frame: i64,
    /// Raw frames per step of 0.4 s.
    pub frame_step: i64,
    /// Time from the first frame to the last, s.
    pub seconds: f64,
    /// Rows of a pedestrian per second, by the median time between two of them; `None` if no pedestrian has two rows.
    pub rows_a_second: Option<f64>,
    /// Median deviation of that time (s) from its median, where no row is missing.
    pub jitter: f64,
    /// Whether pedestrians are seen at common frames, or each on a clock of its own.
    pub common_frames: bool,
    /// Standard deviation of the noise of a coordinate, m.
    pub noise: f64,
    /// The rows that are left out, or begin a track anew.
    #[serde(skip)]
    pub misfits: Vec<Misfit>,
    /// Number of pedestrians.
    pub pedestrians: usize,
    /// Number of observations.
    pub observations: usize,
    /// Least x and y, m.
    pub low: Position,
    /// Largest x and y, m.
    pub high: Position,
    /// Number of pairs of positions of one pedestrian that are one step apart.
    pub steps: usize,
    /// Median speed over single steps, m/s; `None` where no pedestrian was seen at two frames one step apart.
    pub median_speed: Option<f64>,
    /// Largest distance between the first and last position of any pedestrian, m.
    pub farthest: f64,
    /// The fastest single step and its pedestrian.
    pub fastest: Option<Fastest>,
    /// The 90 % quantile of the step speeds of tracks that end more than 2 m from their start, m/s.
    pub brisk_speed: Option<f64>,
    /// Number of tracks that walk, and then repeat one position for 4 s or longer, to their end.
    pub frozen: usize,
    /// How often the frame numbers of the file begin again.
    pub restarts: usize,
    /// Share of missing rows between the first and last of each pedestrian, by the usual time between two rows.
    pub unseen: f64,
    /// Number of gaps: a pedestrian was not seen for some steps and then again.
    pub holes: usize,
    /// The longest gap.
    pub longest_hole: Option<Gap>,
    /// Number of observations from which a pedestrian can be forecast, from the first on ([`Completeness::Partial`]).
    pub to_forecast: usize,
    /// Of these, the number tracked for all 8 steps.
    pub seen_whole: usize,
    /// Windows of 8 observed and 12 further steps ([`WindowRule::Observed`](crate::WindowRule::Observed)).
    pub windows: usize,
    /// Pedestrians in these windows, each counted once per window: the samples for training and evaluation.
    pub to_learn_from: usize,
    #[serde(skip)]
    of_speeds: Option<PlausibilityWarning>,
}

/// A gap in the observations of one pedestrian.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Gap {
    /// The pedestrian that was not seen.
    pub pedestrian: PedestrianName,
    /// The raw frame of the last observation before the gap.
    pub after: i64,
    /// Time from that frame to the next observation, s.
    pub seconds: f64,
}

impl Summary {
    /// Plausibility warnings; empty for a plausible recording.
    #[must_use]
    pub fn warnings(&self) -> Vec<PlausibilityWarning> {
        let (count, share) = (self.frozen, self.unseen);
        let learning = self.to_learn_from == 0 && self.median_speed.is_some();
        restarted(self.restarts)
            .into_iter()
            .chain(self.of_speeds.clone())
            .chain((count > 0).then_some(PlausibilityWarning::Frozen { count }))
            .chain((share >= OFTEN).then_some(PlausibilityWarning::Unseen { share }))
            .chain(learning.then_some(PlausibilityWarning::NothingToLearnFrom))
            .collect()
    }
}

impl Recording {
    fn unseen(&self, tracks: &BTreeMap<PedestrianId, Vec<&Observation>>) -> f64 {
        let Some(spacing) = self.usual_spacing() else { return 0.0 };
        let span = |track: &Vec<&Observation>| (track[track.len() - 1].frame - track[0].frame) as f64;
        let expected: f64 = tracks.values().map(|track| 1.0 + (span(track) / spacing as f64).round()).sum();
        (1.0 - self.observations().len() as f64 / expected).max(0.0)
    }

    /// Median deviation of the time between two rows of a pedestrian from its median, in ticks.
    fn jitter(&self) -> i64 {
        let Some(spacing) = self.usual_spacing() else { return 0 };
        let off = self.differences().into_iter().map(|difference| (difference - spacing).abs());
        let mut off: Vec<i64> = off.filter(|off| 2 * off < spacing).collect();
        off.sort_unstable();
        off.get(off.len() / 2).copied().unwrap_or(0)
    }

    /// The least and the largest coordinates.
    pub(crate) fn corners(&self) -> [Position; 2] {
        bounds(self.observations().iter().map(|seen| seen.position)).unwrap_or_default()
    }

    /// A summary of the recording.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let (tracks, step) = (self.tracks(), self.frame_step());
        let (speeds, spacing) = (self.speeds(&tracks), self.usual_spacing().unwrap_or(step));
        let [low, high] = self.corners();
        let (first_frame, last_frame) = (self.frames()[0], self.frames()[self.frames().len() - 1]);
        let seconds = |ticks: i64| ticks as f64 * TIME_STEP / step as f64;
        let gaps: Vec<Gap> = tracks
            .values()
            .flat_map(|track| track.windows(2))
            .filter(|pair| {
                let apart = pair[1].frame - pair[0].frame;
                apart > step && 2 * apart > 3 * spacing
            })
            .map(|pair| Gap {
                pedestrian: self.names().of(pair[0].pedestrian),
                after: pair[0].frame,
                seconds: seconds(pair[1].frame - pair[0].frame),
            })
            .collect();
        let futures = self.futures();
        let (mut to_forecast, mut seen_whole, mut windows, mut to_learn_from) = (0, 0, 0, 0);
        let observed = self.observe_each(self.live_tracks().with_completeness(Completeness::Partial), |window| {
            to_forecast += window.len();
            seen_whole += (0..window.len()).filter(|&i| window.quality(i).is_whole()).count();
            if let Some(whole) = self.with_future(&window, &futures) {
                windows += 1;
                to_learn_from += whole.len();
            }
        });
        Summary {
            of_speeds: speeds.warning(),
            recording: self.name().to_owned(),
            frames: self.frames().len(),
            first_frame,
            last_frame,
            frame_step: step,
            seconds: seconds(last_frame - first_frame),
            rows_a_second: self.usual_spacing().map(|spacing| 1.0 / seconds(spacing)),
            jitter: seconds(self.jitter()),
            common_frames: observed.has_common_frames,
            noise: observed.noise.metres(),
            misfits: observed.misfits,
            pedestrians: tracks.len(),
            observations: self.observations().len(),
            low,
            high,
            steps: speeds.steps,
            median_speed: speeds.median,
            fastest: speeds.fastest,
            brisk_speed: speeds.brisk,
            farthest: speeds.farthest,
            frozen: tracks.values().filter(|track| is_frozen(track, step)).count(),
            restarts: self.restarts,
            unseen: self.unseen(&tracks),
            holes: gaps.len(),
            longest_hole: gaps.into_iter().max_by(|a, b| a.seconds.total_cmp(&b.seconds)),
            to_forecast,
            seen_whole,
            windows,
            to_learn_from,
        }
    }
}
