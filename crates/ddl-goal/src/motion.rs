//! The motion of a pedestrian in its own frame, relative to its own pace.

use crate::error::TrackError;
use crate::heading::HeadingFrame;
use crate::span::{QuerySpan, velocities};
use ddl_core::WINDOW;

/// Components compared: 7 velocities ahead, the direction in the world (2), 7 velocities to the left.
pub(crate) const COMPONENTS: usize = SIGNED + STEPS;
/// Index of the first component whose sign changes in a mirror image; the signs of all later ones change too.
pub(crate) const SIGNED: usize = STEPS + 2;
const STEPS: usize = 7;
/// Weight of the squared difference of a step, relative to that of the following step.
const FADING: f64 = 0.5;
/// Smallest pace (m/s), so that the noise of a standing pedestrian does not count as motion.
const STANDING_PACE: f64 = 0.25;

const DIRECTION: f64 = 0.2;
/// Speed (m/s) from which the direction has full weight.
const WALKING: f64 = 1.0;

#[derive(Clone, Copy, Debug)]
pub(crate) struct RecentMotion {
    pub(crate) frame: HeadingFrame,
    /// Velocities in the frame, divided by the pace, with smaller weights for earlier ones; and the direction in the
    /// world.
    pub(crate) components: [f32; COMPONENTS],
    /// Endpoint (m, in the frame) if the pedestrian repeated its last step.
    pub(crate) straight_on: [f64; 2],
}

impl RecentMotion {
    /// The motion in the first 8 positions (m) of `track`, `time_step` seconds apart.
    pub(crate) fn new(track: &[[f64; 2]], time_step: f64) -> Result<Self, TrackError> {
        let span = QuerySpan::Observed;
        let velocities = velocities(track, time_step, span)?;
        let frame = HeadingFrame::new(&track[..span.positions()])?;
        let speeds = velocities.iter().map(|v| v[0].hypot(v[1]));
        let recently: f64 = speeds.clone().skip(STEPS - 2).sum::<f64>() / 2.0;
        let pace = STANDING_PACE + speeds.sum::<f64>() / STEPS as f64;
        if !pace.is_finite() {
            return Err(TrackError::VelocityOverflow { index: 0 });
        }
        let mut components = [0.0; COMPONENTS];
        let mut scale = 1.0;
        for step in (0..STEPS).rev() {
            let [ahead, left] = frame.turn_to_frame(velocities[step]);
            components[step] = (scale * (ahead / pace)) as f32;
            components[SIGNED + step] = (scale * (left / pace)) as f32;
            scale *= FADING.sqrt();
        }
        // A standing pedestrian has no direction.
        let share = DIRECTION * (recently / WALKING).min(1.0);
        for (component, direction) in components[STEPS..SIGNED].iter_mut().zip(frame.heading) {
            *component = (share * direction) as f32;
        }
        let seconds = (WINDOW - span.positions()) as f64 * time_step;
        let straight_on = frame.turn_to_frame(velocities[STEPS - 1]).map(|velocity| seconds * velocity);
        Ok(Self { frame, components, straight_on })
    }

    /// Deviation (m, ahead and to the left) of an endpoint (m) from the endpoint after repeating the last step.
    pub(crate) fn deviation(&self, end: [f64; 2]) -> [f64; 2] {
        let end = self.frame.to_frame(end);
        [0, 1].map(|d| end[d] - self.straight_on[d])
    }

    /// The endpoint (m) with a given deviation (m): the inverse of [`RecentMotion::deviation`].
    pub(crate) fn place(&self, deviation: [f64; 2]) -> [f64; 2] {
        let in_frame = [0, 1].map(|d| self.straight_on[d] + deviation[d]);
        self.frame.to_world(in_frame)
    }
}
