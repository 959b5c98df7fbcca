//! The motion between two rows of a track: constant velocity, disturbed by accelerations.

use ddl_core::{Position, distance};

/// Variance of a pedestrian's velocity before it is seen to move ((m/s)², on each axis).
const UNSEEN_VELOCITY: f64 = 2.0;

/// How a pedestrian is taken to move and to be seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WalkModel {
    /// Standard deviation of a coordinate of a row (m).
    pub(super) noise: f64,
    /// Spectral density of the accelerations (m²/s³).
    pub(super) agility: f64,
}

/// Position and velocity with their covariance, which is the same on both axes: a state of a Kalman filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MotionState {
    pub(super) position: Position,
    velocity: [f64; 2],
    /// Variance of a coordinate (m²).
    pub(super) variance: f64,
    covariance: f64,
    /// Variance of a coordinate of the velocity ((m/s)²).
    pub(super) velocity_variance: f64,
    /// Spectral density of the accelerations (m²/s³).
    agility: f64,
}

impl MotionState {
    /// The motion after the first row of a track, whose position has this standard deviation (m).
    pub(super) fn first_seen(position: Position, WalkModel { noise, agility }: WalkModel) -> Self {
        Self {
            position,
            velocity: [0.0; 2],
            variance: noise * noise,
            covariance: 0.0,
            velocity_variance: UNSEEN_VELOCITY,
            agility,
        }
    }

    /// The motion expected some seconds later; before, if they are negative.
    pub(super) fn expected_after(&self, seconds: f64) -> Self {
        let disturbed = self.agility * seconds.abs();
        Self {
            position: [0, 1].map(|axis| self.position[axis] + self.velocity[axis] * seconds),
            variance: self.variance
                + seconds * (2.0 * self.covariance + seconds * self.velocity_variance)
                + disturbed * seconds * seconds / 3.0,
            covariance: self.covariance + seconds * (self.velocity_variance + disturbed / 2.0),
            velocity_variance: self.velocity_variance + disturbed,
            ..*self
        }
    }

    /// Its speed (m/s).
    pub(super) fn speed(&self) -> f64 {
        self.velocity[0].hypot(self.velocity[1])
    }

    /// Distance of a position from the expected one (m).
    pub(super) fn distance(&self, position: Position) -> f64 {
        distance(position, self.position)
    }

    /// The motion corrected by a position with this standard deviation (m).
    pub(super) fn corrected(&self, position: Position, noise: f64) -> Self {
        let innovation = self.variance + noise * noise;
        let gain = [self.variance / innovation, self.covariance / innovation];
        let offset = [0, 1].map(|axis| position[axis] - self.position[axis]);
        Self {
            position: [0, 1].map(|axis| self.position[axis] + gain[0] * offset[axis]),
            velocity: [0, 1].map(|axis| self.velocity[axis] + gain[1] * offset[axis]),
            variance: self.variance - gain[0] * self.variance,
            covariance: self.covariance - gain[0] * self.covariance,
            velocity_variance: self.velocity_variance - gain[1] * self.covariance,
            ..*self
        }
    }

    /// The motion in the light of what came some seconds after it: a step back of Rauch, Tung and Striebel. Its
    /// covariance stays that of the filter, because only that of the last motion is read.
    pub(super) fn smoothed(&self, later: &Self, seconds: f64) -> Self {
        let expected = self.expected_after(seconds);
        // The gain P F^T E^-1, with the covariance P of this motion and E of the expected one.
        let determinant = expected.variance * expected.velocity_variance - expected.covariance * expected.covariance;
        let inverse = [expected.velocity_variance, -expected.covariance, expected.variance].map(|e| e / determinant);
        let rows = [
            [self.variance + seconds * self.covariance, self.covariance],
            [self.covariance + seconds * self.velocity_variance, self.velocity_variance],
        ];
        let gain = rows.map(|[p, v]| [p * inverse[0] + v * inverse[1], p * inverse[1] + v * inverse[2]]);
        let offset = |axis: usize| {
            [later.position[axis] - expected.position[axis], later.velocity[axis] - expected.velocity[axis]]
        };
        let moved = |row: [f64; 2], axis: usize| row[0] * offset(axis)[0] + row[1] * offset(axis)[1];
        Self {
            position: [0, 1].map(|axis| self.position[axis] + moved(gain[0], axis)),
            velocity: [0, 1].map(|axis| self.velocity[axis] + moved(gain[1], axis)),
            ..*self
        }
    }
}
