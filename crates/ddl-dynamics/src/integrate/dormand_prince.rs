//! Adaptive integration of fifth order.

use nalgebra::SVector;

use super::{Integrator, StableEuler};
use crate::{
    error::{DynamicsError, ensure_finite, ensure_positive, ensure_time_step},
    flow::Flow,
    polar::polar,
    real::Real,
    state::State,
};

/// Largest and smallest factor between successive step lengths.
const GROWTH: f64 = 5.0;
const SHRINKAGE: f64 = 0.2;
/// Largest number of inner steps in one time step; smooth flows need tens.
const INNER_STEPS: usize = 10_000;
const SAFETY: f64 = 0.9;

/// The Dormand-Prince pair of orders 5 and 4 with adaptive steps inside each time step: the path of the continuous
/// flow, for offline use. An inner step is accepted if its estimated error is at most the tolerance *and* the potential
/// falls.
///
/// # What is guaranteed
/// - *Strict decrease* of the computed distance at every step, as for [`StableEuler`], for every flow.
/// - *Error*: estimated at no more than the tolerance in each inner step, for flows that depend smoothly on the state.
/// - *At the goal*: a position nearer to it than the tolerance (in the [`chart`](Flow::chart), if there is one) is set
///   to it.
/// - *Time to the goal*: that of the continuous flow, for a distance at most `Phi(0) / lambda_min`.
///
/// If even a step as short as the tolerance is rejected (at a discontinuity of the metric), a [`StableEuler`] step of
/// that length is taken. The `step` and `history` of a state are those of the whole time step.
///
/// # References
/// Dormand and Prince, "A family of embedded Runge-Kutta formulae" (J. Comp. Appl. Math. 1980).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DormandPrince<T> {
    tolerance: T,
}

impl<T: Real> DormandPrince<T> {
    /// Inner steps with an estimated error of at most `tolerance` (metres, in each component).
    ///
    /// # Errors
    /// [`DynamicsError::NotPositive`] unless the tolerance is positive and finite.
    pub fn new(tolerance: T) -> Result<Self, DynamicsError> {
        let tolerance = ensure_positive("the tolerance", " m", tolerance)?;
        Ok(Self { tolerance })
    }

    /// The tolerance (metres).
    pub fn tolerance(&self) -> T {
        self.tolerance
    }
}

impl<T: Real, const D: usize> Integrator<T, D> for DormandPrince<T> {
    /// # Errors
    /// Those of the flow and of [`StableEuler::advance`]; [`DynamicsError::TooStiff`] if ten thousand inner steps do
    /// not cover the time step, or if an inner step would be shorter than any number of `T`.
    fn step<F: Flow<T, D> + ?Sized>(
        &self,
        flow: &F,
        state: &State<'_, T, D>,
        dt: T,
    ) -> Result<SVector<T, D>, DynamicsError> {
        ensure_time_step(dt)?;
        ensure_finite("position", &state.position)?;
        let mut here = *state;
        let (mut left, mut length) = (dt, dt);
        let mut steps = 0;
        while steps < INNER_STEPS {
            steps += 1;
            let distance = distance(flow, &here.position);
            if !distance.is_finite() {
                return Err(DynamicsError::DistanceTooLarge);
            }
            if distance <= self.tolerance {
                return Ok(*flow.goal());
            }
            let velocity = flow.velocity(&here)?;
            ensure_finite("velocity", &velocity)?;
            // The potential has a kink at the goal, which error estimates do not detect: stop before it.
            length = length
                .min(left)
                .min(time_to_closest(flow, &here.position, &velocity) * T::rounded(SAFETY));
            if let Some(longest) = flow.longest_step(&here, &velocity) {
                length = length.min(longest);
            }
            if length.is_zero() {
                break;
            }
            let (position, error) = inner_step(flow, &here, velocity, length)?;
            let relative = error / self.tolerance;
            let precise = relative <= T::one();
            let next = if precise && self::distance(flow, &position) < distance {
                position
            } else if velocity.amax() * length <= self.tolerance {
                StableEuler.step(flow, &here, length)?
            } else {
                length *= growth(relative).min(T::rounded(0.5));
                continue;
            };
            here.position = next;
            here.time += length;
            left -= length;
            if left <= T::zero() {
                return Ok(next);
            }
            length *= growth(relative);
        }
        Err(DynamicsError::TooStiff {
            steps,
            covered: (dt - left).as_f64(),
        })
    }
}

fn distance<T: Real, const D: usize, F: Flow<T, D> + ?Sized>(flow: &F, position: &SVector<T, D>) -> T {
    match flow.chart() {
        None => flow.attractor().distance(position),
        Some(psi) => flow.attractor().distance(&psi.apply(position)),
    }
}

/// Time at which a straight line along `velocity` is closest to the goal in the flow's chart (seconds); the largest
/// number if it does not come closer.
fn time_to_closest<T: Real, const D: usize, F: Flow<T, D> + ?Sized>(
    flow: &F,
    position: &SVector<T, D>,
    velocity: &SVector<T, D>,
) -> T {
    let (image, velocity) = match flow.chart() {
        None => (*position, *velocity),
        Some(psi) => {
            let (image, jacobian) = psi.apply_with_jacobian(position);
            (image, jacobian * velocity)
        }
    };
    let (distance, away) = flow.attractor().distance_and_direction(&image);
    let (speed, heading) = polar(&velocity);
    let time = -away.dot(&heading) * distance / speed;
    if time > T::zero() { time } else { T::MAX }
}

fn growth<T: Real>(relative: T) -> T {
    let (least, most) = (T::rounded(SHRINKAGE), T::rounded(GROWTH));
    if relative.is_zero() {
        return most;
    }
    let ideal = T::rounded(SAFETY) * relative.powf(T::rounded(-0.2));
    // A stage that overflowed gives NaN here: shrink.
    if ideal >= least { ideal.min(most) } else { least }
}

/// Times of stages 2 to 6, in units of the step.
const NODES: [f64; 5] = [0.2, 0.3, 0.8, 8.0 / 9.0, 1.0];
/// Weights of the earlier velocities in stages 2 to 6, and in the result of order 5.
#[rustfmt::skip]
const WEIGHTS: [&[f64]; 6] = [
    &[0.2],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Weights of the seven velocities in the difference of orders 5 and 4.
const DIFFERENCE: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// The end of a step of `length` seconds, and the largest component of the difference of the two orders (metres).
fn inner_step<T: Real, const D: usize, F: Flow<T, D> + ?Sized>(
    flow: &F,
    state: &State<'_, T, D>,
    first: SVector<T, D>,
    length: T,
) -> Result<(SVector<T, D>, T), DynamicsError> {
    let mut velocities = [first; 7];
    let mut stage = *state;
    for (k, weights) in WEIGHTS.iter().enumerate() {
        stage.position = state.position + combined(weights, &velocities[..=k]) * length;
        let node = NODES.get(k).copied().unwrap_or(1.0);
        stage.time = state.time + T::rounded(node) * length;
        velocities[k + 1] = flow.velocity(&stage)?;
    }
    let error = (combined(&DIFFERENCE, &velocities) * length).amax();
    Ok((stage.position, error))
}

fn combined<T: Real, const D: usize>(weights: &[f64], velocities: &[SVector<T, D>]) -> SVector<T, D> {
    let terms = velocities.iter().zip(weights);
    terms.fold(SVector::zeros(), |sum, (velocity, &weight)| {
        sum + velocity * T::rounded(weight)
    })
}
