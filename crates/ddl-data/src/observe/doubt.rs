//! Another explanation of the last row of a track, until the next row decides.

use crate::observe::misfit::MisfitTreatment;
use crate::observe::noise::log_likelihood;
use crate::observe::track::ObservedTrack;

/// A row so many standard deviations from where it was expected begins to be doubted, and is doubted as far as it can
/// be. Of walking pedestrians a twentieth of the rows, 0.4 s apart, is beyond 3.3 (dut, citr, juelich, magni, thor).
const UNUSUAL: [f64; 2] = [2.0, 4.0];
/// The same in metres: nearer it changes forecasts little, and is never left out.
const NOTICED: [f64; 2] = [0.07, 0.15];
/// Accelerations (m/s²) that people seldom have, and that they never have: of 1,000 rows 0.1 to 0.4 s apart one needs 2
/// to 11 (dut, citr, juelich).
const INHUMAN: [f64; 2] = [5.0, 10.0];
/// Weight of the explanation that the row is wrong, where people seldom make the step, and where they never do. It is
/// more than its probability: where both are possible, the risk of either may fall by a third at most.
const WEIGHTS: [f64; 2] = [0.78, 0.95];
/// Least weight of an explanation.
const LEAST: f64 = 0.1;
/// Log-likelihood of a wrong row: one of some hundreds, somewhere within metres.
pub(super) const WRONG: f64 = -3.0;
/// Evidence from which on the other explanation is the likelier one.
const LIKELIER: f64 = 2.8;

/// Another explanation of the last row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Doubt {
    /// The track by this explanation.
    pub(super) other: ObservedTrack,
    /// Log-likelihood of the other explanation less that of the track itself.
    pub(super) evidence: f64,
    /// Weight of the other explanation in a forecast, 0 to 1.
    pub(super) weight: f64,
    /// Time of the row, in ticks.
    pub(super) time: f64,
    /// Distance of the row from where the pedestrian was expected (m).
    pub(super) distance: f64,
    /// How the row is treated if the other explanation holds.
    pub(super) treatment: MisfitTreatment,
}

impl Doubt {
    /// Whether the other explanation is the likelier one, before the next row.
    pub(super) fn is_likelier(&self) -> bool {
        self.evidence > LIKELIER
    }

    /// Whether it matters whether the row is a fact.
    pub(super) fn is_noticed(&self) -> bool {
        self.distance > NOTICED[1]
    }
}

/// How far a row is from where a pedestrian may be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    /// Distance from where the pedestrian was expected (m).
    pub(super) distance: f64,
    /// Standard deviation of a coordinate there (m).
    pub(super) deviation: f64,
    /// Log-likelihood of the row.
    pub(super) likelihood: f64,
    /// Whether it is about there.
    pub(super) is_expected: bool,
    /// Whether a pedestrian that turns may be there.
    pub(super) is_turn: bool,
}

impl Fit {
    /// The same for a row that may be this near (m) to where it was expected.
    pub(super) fn nearer(self, distance: f64) -> Self {
        let likelihood = self.likelihood.max(log_likelihood(distance, self.deviation * self.deviation));
        Self { distance: self.distance.min(distance), likelihood, ..self }
    }

    /// Log-likelihood by which the row is wrong rather than right.
    pub(super) fn evidence(&self) -> f64 {
        WRONG - self.likelihood
    }

    /// Weight of the explanation that the row, so many seconds after the one before, is wrong; `None` without doubt.
    pub(super) fn doubt(&self, seconds: f64) -> Option<f64> {
        let ramp = |value: f64, [from, to]: [f64; 2]| ((value - from) / (to - from)).clamp(0.0, 1.0);
        let unusual = ramp(self.distance / self.deviation, UNUSUAL) * ramp(self.distance, NOTICED);
        let acceleration = (self.distance - UNUSUAL[0] * self.deviation) / (seconds * seconds);
        let weight = unusual * (WEIGHTS[0] + (WEIGHTS[1] - WEIGHTS[0]) * ramp(acceleration, INHUMAN));
        (weight >= LEAST).then_some(weight)
    }
}
