//! What a recording holds, and what about it looks wrong.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use crate::{Completion, Observation, PedestrianId, Position, Recording, TIME_STEP, WindowRule};

/// Faster than anybody walks, m/s: who seems to is measured in pixels, or in steps of another length.
const IMPLAUSIBLE: f64 = 4.0;
/// Where nobody is faster than this, m/s, though somebody has come far, frames follow each other faster than 0.4 s.
const CREEPING: f64 = 0.6;
/// How far somebody has come, m.
const FAR: f64 = 2.0;
/// A step beyond this is a track that jumps from one person to another, m/s: the fastest sprinters reach 12.
const JUMP: f64 = 12.0;

/// What a recording holds, in steps of 0.4 s.
///
/// ```
/// use ddl_data::{Observation, PedestrianId, Recording};
///
/// let walk = (0..20).map(|t| Observation::new(10 * t, PedestrianId(1), [0.5 * t as f64, 2.0]));
/// let summary = Recording::new("yard", 10, walk.collect())?.summary();
/// assert_eq!((summary.pedestrians, summary.to_learn_from, summary.to_forecast), (1, 1, 19));
/// assert_eq!((summary.seconds, summary.median_speed), (7.6, Some(1.25)));
/// assert!(summary.doubts().is_empty());
/// # Ok::<(), ddl_data::RecordingError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Summary {
    /// Its name.
    pub recording: String,
    /// Frames with anybody in them.
    pub frames: usize,
    /// First raw frame number.
    pub first_frame: i64,
    /// Last raw frame number.
    pub last_frame: i64,
    /// Raw frames in a step of 0.4 s.
    pub frame_step: i64,
    /// Time from the first frame to the last, s.
    pub seconds: f64,
    /// People.
    pub pedestrians: usize,
    /// Positions.
    pub observations: usize,
    /// Least x and y, m.
    pub low: Position,
    /// Largest x and y, m.
    pub high: Position,
    /// Median speed over single steps, m/s; `None` where nobody was seen at two frames a step apart.
    pub median_speed: Option<f64>,
    /// Largest distance between anybody's first and last position, m.
    pub farthest: f64,
    /// Largest speed over a single step, and whose.
    pub fastest: Option<Fastest>,
    /// Times that somebody was not seen for some steps and then again.
    pub holes: usize,
    /// The longest of them.
    pub longest_hole: Option<Hole>,
    /// Moments of people who can be forecast, seen at 2 or more of 8 steps ([`Completion::USUAL`]).
    pub to_forecast: usize,
    /// Of these, moments of people seen at all 8 steps.
    pub seen_whole: usize,
    /// Walkers in windows of 20 steps in a row: what a model can be trained on and measured with ([`WindowRule::Complete`]).
    pub to_learn_from: usize,
}

/// The fastest step of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Fastest {
    /// Its speed, m/s.
    pub speed: f64,
    /// Whose it is.
    pub pedestrian: PedestrianId,
    /// The raw frame at which it ends.
    pub frame: i64,
}

/// A time in which somebody was not seen, and after which they were again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Hole {
    /// Who was not seen.
    pub pedestrian: PedestrianId,
    /// The raw frame at which they were last seen before it.
    pub after: i64,
    /// From that frame to the one at which they were seen again, s.
    pub seconds: f64,
}

/// Something that looks wrong; in words it says what may be done about it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// Nobody was seen at two frames so far apart, which are taken for 0.4 s.
    NoSteps {
        /// Raw frames in a step.
        frame_step: i64,
    },
    /// The median speed is no walker's, m/s: pixels, or another rate.
    Fast {
        /// The median speed, m/s.
        median: f64,
    },
    /// Nobody is ever faster than this, m/s, though somebody has come metres far: another rate.
    Slow {
        /// The largest speed, m/s.
        fastest: f64,
    },
    /// A track goes on somewhere else.
    Jump(Fastest),
    /// No window of 20 steps: forecasts are possible, training and measuring are not.
    NothingToLearnFrom,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSteps { frame_step } => write!(
                f,
                "nobody was seen at two frames {frame_step} apart, which are taken for 0.4 s: give the rate of the frames"
            ),
            Self::Fast { median } => write!(
                f,
                "half of the steps are faster than {median:.1} m/s; are the positions in metres, and the rows of a pedestrian 0.4 s apart?"
            ),
            Self::Slow { fastest } => write!(
                f,
                "nobody is ever faster than {fastest:.2} m/s; are the rows of a pedestrian 0.4 s apart, or those of a faster camera?"
            ),
            Self::Jump(Fastest {
                speed,
                pedestrian,
                frame,
            }) => write!(
                f,
                "pedestrian {pedestrian} jumps at frame {frame}, {speed:.1} m/s over one step; does the track go on with somebody else?"
            ),
            Self::NothingToLearnFrom => f.write_str(
                "nobody was seen at 20 steps in a row: nothing can be trained on these tracks, or measured with them",
            ),
        }
    }
}

/// How people move, step by step.
struct Speeds {
    frame_step: i64,
    median: Option<f64>,
    fastest: Option<Fastest>,
    /// Largest distance between anybody's first and last position, m.
    farthest: f64,
}

impl Speeds {
    /// What looks wrong with them.
    fn doubt(&self) -> Option<Doubt> {
        let (Some(median), Some(fastest)) = (self.median, self.fastest) else {
            return Some(Doubt::NoSteps {
                frame_step: self.frame_step,
            });
        };
        if median > IMPLAUSIBLE {
            Some(Doubt::Fast { median })
        } else if fastest.speed > JUMP {
            Some(Doubt::Jump(fastest))
        } else if fastest.speed < CREEPING && self.farthest > FAR {
            Some(Doubt::Slow {
                fastest: fastest.speed,
            })
        } else {
            None
        }
    }
}

impl Summary {
    /// What looks wrong; nothing where all looks well.
    #[must_use]
    pub fn doubts(&self) -> Vec<Doubt> {
        let speeds = Speeds {
            frame_step: self.frame_step,
            median: self.median_speed,
            fastest: self.fastest,
            farthest: self.farthest,
        };
        let learning = self.to_learn_from == 0 && self.median_speed.is_some();
        speeds
            .doubt()
            .into_iter()
            .chain(learning.then_some(Doubt::NothingToLearnFrom))
            .collect()
    }
}

impl Recording {
    /// What looks wrong with the speeds of its people, if anything: the first of the doubts of [its summary](Self::summary), for less work.
    #[must_use]
    pub fn speed_doubt(&self) -> Option<Doubt> {
        self.speeds(&self.tracks()).doubt()
    }

    fn tracks(&self) -> BTreeMap<PedestrianId, Vec<&Observation>> {
        let mut tracks: BTreeMap<PedestrianId, Vec<&Observation>> = BTreeMap::new();
        for seen in self.observations() {
            tracks.entry(seen.pedestrian).or_default().push(seen);
        }
        tracks
    }

    fn speeds(&self, tracks: &BTreeMap<PedestrianId, Vec<&Observation>>) -> Speeds {
        let step = self.frame_step();
        let mut speeds: Vec<Fastest> = Vec::new();
        for track in tracks.values() {
            speeds.extend(track.iter().filter_map(|seen| {
                let before = track
                    .binary_search_by_key(&(seen.frame - step), |other| other.frame)
                    .ok()?;
                Some(fastness(track[before].position, seen))
            }));
        }
        speeds.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        Speeds {
            frame_step: step,
            median: speeds.get(speeds.len() / 2).map(|fastest| fastest.speed),
            fastest: speeds.last().copied(),
            farthest: tracks.values().map(|track| way(track)).fold(0.0, f64::max),
        }
    }

    /// What the recording holds.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let tracks = self.tracks();
        let speeds = self.speeds(&tracks);
        let step = self.frame_step();
        let pairs = tracks.values().flat_map(|track| track.windows(2));
        let holes: Vec<Hole> = pairs
            .filter(|pair| pair[1].frame - pair[0].frame > step)
            .map(|pair| Hole {
                pedestrian: pair[0].pedestrian,
                after: pair[0].frame,
                seconds: (pair[1].frame - pair[0].frame) as f64 * TIME_STEP / step as f64,
            })
            .collect();
        let walkers = |windows: &[crate::Window]| windows.iter().map(crate::Window::len).sum();
        let corner = |pick: fn(f64, f64) -> f64, from: f64| {
            let places = self.observations().iter().map(|seen| seen.position);
            places.fold([from; 2], |corner, place| {
                [0, 1].map(|axis| pick(corner[axis], place[axis]))
            })
        };
        let (first, last) = (self.frames()[0], self.frames()[self.frames().len() - 1]);
        Summary {
            recording: self.name().to_owned(),
            frames: self.frames().len(),
            first_frame: first,
            last_frame: last,
            frame_step: step,
            seconds: (last - first) as f64 * TIME_STEP / step as f64,
            pedestrians: tracks.len(),
            observations: self.observations().len(),
            low: corner(f64::min, f64::INFINITY),
            high: corner(f64::max, f64::NEG_INFINITY),
            median_speed: speeds.median,
            fastest: speeds.fastest,
            farthest: speeds.farthest,
            holes: holes.len(),
            longest_hole: holes
                .into_iter()
                .max_by(|a, b| a.seconds.total_cmp(&b.seconds)),
            to_forecast: walkers(&self.completed_windows(Completion::USUAL)),
            seen_whole: walkers(&self.observed_windows()),
            to_learn_from: walkers(&self.windows(WindowRule::Complete)),
        }
    }
}

/// How far a track leads, m.
fn way(track: &[&Observation]) -> f64 {
    let (first, last) = (track[0].position, track[track.len() - 1].position);
    (last[0] - first[0]).hypot(last[1] - first[1])
}

fn fastness(from: Position, to: &Observation) -> Fastest {
    let way = (to.position[0] - from[0]).hypot(to.position[1] - from[1]);
    Fastest {
        speed: way / TIME_STEP,
        pedestrian: to.pedestrian,
        frame: to.frame,
    }
}
