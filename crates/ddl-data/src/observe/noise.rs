//! How exact the positions of a tracker are, measured by how far they lie from where they were expected.

use std::sync::LazyLock;

use ddl_core::Position;

use crate::observe::motion::{MotionState, WalkModel};

/// The standard deviations (m, on each axis) among which the noise is chosen.
const NOISE: [f64; 12] = [0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4];
/// The spectral densities of accelerations (m²/s³) among which the agility is chosen. The likelihood of the tracks of
/// nine recordings, of 2.5 to 30 rows a second, has its maximum between 0.02 and 0.05; who walks straight has less.
const AGILITY: [f64; 4] = [0.001, 0.005, 0.02, 0.08];
/// Number of pairs of the two.
const LEVELS: usize = NOISE.len() * AGILITY.len();
/// What the ETH/UCY recordings have, which the models were trained on (m).
pub(super) const USUAL: f64 = 0.02;
/// Agility without measurements.
const USUAL_AGILITY: f64 = 0.02;
/// Weight of the usual noise against measurements: some ten rows.
const CERTAINTY: f64 = 10.0;
/// Noise up to which positions are taken as they are (m): the networks know it from their training.
const TRUSTED: f64 = 0.035;
/// Degrees of freedom of the distribution of innovations (Student's t): people turn and stop.
const TAILS: f64 = 4.0;
/// First rows of a track, which show its velocity.
const FIRST: usize = 3;
/// Number of rows after which a recording's older rows lose their weight: a tracker may change.
const MEMORY: f64 = 5000.0;
/// Time (s) in which the rows of a track lose their weight by a factor e: a pedestrian may begin to turn.
const RECENT: f64 = 3.0;
/// Number of earlier rows of a track that weigh as much as its recent ones.
const EARLIER: f64 = 200.0;

/// Log-likelihood of each level.
type Evidence = [f64; LEVELS];

/// The noise of all tracks of a recording or stream so far.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingNoise {
    evidence: Evidence,
    rows: f64,
}

/// The noise of one track: a filter for each level. That of other tracks says nothing of it: who is far away must not
/// change what is observed of somebody.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TrackNoise {
    /// Of the recent rows, and of all so far.
    evidence: Evidence,
    so_far: RecordingNoise,
    motions: [MotionState; LEVELS],
    rows: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct NoiseLevel(usize);

impl NoiseLevel {
    pub(super) fn walk(self) -> WalkModel {
        WalkModel { noise: NOISE[self.0 % NOISE.len()], agility: AGILITY[self.0 / NOISE.len()] }
    }

    /// Whether positions are taken as they are.
    pub(super) fn is_trusted(self) -> bool {
        self.walk().noise <= TRUSTED
    }

    fn all() -> [Self; LEVELS] {
        std::array::from_fn(Self)
    }
}

impl Default for RecordingNoise {
    fn default() -> Self {
        Self { evidence: [0.0; LEVELS], rows: 0.0 }
    }
}

impl RecordingNoise {
    /// Older rows lose their weight, and a row comes.
    fn fade(&mut self) {
        let keep = 1.0 - 1.0 / MEMORY;
        self.rows = self.rows * keep + 1.0;
        self.evidence = self.evidence.map(|evidence| evidence * keep);
    }

    /// Standard deviation of a coordinate (m).
    #[must_use]
    pub fn metres(&self) -> f64 {
        likeliest(&self.evidence).walk().noise
    }
}

impl TrackNoise {
    pub(super) fn of_first(position: Position) -> Self {
        Self {
            evidence: [0.0; LEVELS],
            so_far: RecordingNoise::default(),
            motions: NoiseLevel::all().map(|level| MotionState::first_seen(position, level.walk())),
            rows: 1,
        }
    }

    /// The motion at the last row, at a level.
    pub(super) fn motion(&self, level: NoiseLevel) -> &MotionState {
        &self.motions[level.0]
    }

    /// The likeliest level.
    pub(super) fn level(&self) -> NoiseLevel {
        let share = (EARLIER / self.so_far.rows).min(1.0);
        likeliest(&std::array::from_fn(|level| self.evidence[level] + share * self.so_far.evidence[level]))
    }

    /// Adds a row, some seconds after the last, to this track and its recording.
    pub(super) fn add(&mut self, position: Position, seconds: f64, recording: &mut RecordingNoise) {
        self.rows += 1;
        let counts = self.rows > FIRST;
        if counts {
            recording.fade();
            self.so_far.fade();
        }
        let keep = (-seconds / RECENT).exp();
        for level in 0..LEVELS {
            self.evidence[level] *= keep;
            let WalkModel { noise, .. } = NoiseLevel(level).walk();
            let expected = self.motions[level].expected_after(seconds);
            if counts {
                let variance = expected.variance + noise * noise;
                let likelihood = log_likelihood(expected.distance(position), variance);
                self.evidence[level] += likelihood;
                self.so_far.evidence[level] += likelihood;
                recording.evidence[level] += likelihood;
            }
            self.motions[level] = expected.corrected(position, noise);
        }
    }
}

/// Log-likelihood, but for a constant, of a row so far (m) from where it was expected, with the variance (m²) of a
/// coordinate there.
pub(super) fn log_likelihood(distance: f64, variance: f64) -> f64 {
    -(TAILS + 2.0) / 2.0 * (distance * distance / (variance * TAILS)).ln_1p() - variance.ln()
}

/// What each level must be likelier by than the usual one.
static UNUSUAL: LazyLock<Evidence> = LazyLock::new(|| {
    NoiseLevel::all().map(|level| {
        let WalkModel { noise, agility } = level.walk();
        CERTAINTY * (noise / USUAL).ln().powi(2) + (agility / USUAL_AGILITY).ln().powi(2)
    })
});

fn likeliest(evidence: &Evidence) -> NoiseLevel {
    let with_prior = |level: usize| evidence[level] - UNUSUAL[level];
    let best = (0..LEVELS).max_by(|&a, &b| with_prior(a).total_cmp(&with_prior(b)));
    NoiseLevel(best.unwrap_or_default())
}
