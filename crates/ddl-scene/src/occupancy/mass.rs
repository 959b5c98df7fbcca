//! Mass of Student's t within a disc.
//!
//! With the distribution function `G` of the distance from its centre, the mass within a disc is an integral over the
//! edge of the disc: `1 / (2 pi)` times that of `G(|x|)` over the angle at which the centre sees the point `x`.

use crate::risk::probability;
use std::f64::consts::PI;

/// A cell with a smaller mass than this is left out of the sum.
const LEAST: f64 = 1e-4;
/// Points of the integral over half an edge, even.
const POINTS: usize = 24;
/// Distances in a table, less one.
const ROWS: usize = 320;
/// How many scales from the edge of a wide disc the mass is 0 or 1 to [`LEAST`] and to 2e-4.
const EDGE: f64 = 30.0;

/// The mass within a disc of one radius, by the distance (m) of its middle.
#[derive(Debug)]
pub(super) struct MassTable {
    first: f64,
    reach: f64,
    /// Rows for each metre.
    density: f64,
    masses: Vec<f64>,
}

impl MassTable {
    /// Of a scale and a radius (m); of the scale 0, the mass is 1 within the radius.
    pub(super) fn new(radius: f64, scale: f64) -> Self {
        let [first, reach] = [(radius - EDGE * scale).max(0.0), reach(radius, scale)];
        let density = ROWS as f64 / (reach - first).max(f64::MIN_POSITIVE);
        let at = |row: usize| mass(first + (reach - first) * row as f64 / ROWS as f64, radius, scale);
        let masses = if scale > 0.0 { (0..=ROWS).map(at).collect() } else { Vec::new() };
        Self { first, reach, density, masses }
    }

    /// The mass is 0 farther away than this (m).
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    pub(super) fn mass(&self, distance: f64) -> f64 {
        if distance > self.reach {
            return 0.0;
        }
        let place = (distance - self.first).max(0.0) * self.density;
        let row = place as usize;
        let [Some(low), Some(high)] = [row, row + 1].map(|row| self.masses.get(row)) else {
            return self.masses.last().copied().unwrap_or(1.0);
        };
        // `fract` is slow on processors without an instruction for it.
        low + (place - row as f64) * (high - low)
    }
}

/// The distance from which on the mass is below [`LEAST`].
fn reach(radius: f64, scale: f64) -> f64 {
    let [mut inside, mut outside] = [radius, radius + EDGE * scale];
    for _ in 0..30 {
        let middle = f64::midpoint(inside, outside);
        if scale > 0.0 && mass(middle, radius, scale) < LEAST {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    outside
}

/// The mass within the radius of a place at this distance from the centre (all in metres).
pub(super) fn mass(distance: f64, radius: f64, scale: f64) -> f64 {
    let [d, r] = [distance / scale, radius / scale];
    // The edge comes nearest to the centre at the angle 0. Around it, points get closer as far as needed.
    let width = (((d - r).powi(2) + 3.0) / (d * r).max(f64::MIN_POSITIVE)).sqrt().min(PI);
    let last = (PI / width).asinh();
    let integrand = |point: usize| {
        let v = last * point as f64 / POINTS as f64;
        let half = (0.5 * width * v.sinh()).sin().powi(2);
        let square = (d - r).powi(2) + 4.0 * d * r * half;
        let angle = r * (r - d) + 2.0 * d * r * half;
        let ratio = if square > 1e-6 { probability(square.sqrt()) / square } else { 0.5 };
        ratio * angle * width * v.cosh()
    };
    let inner: f64 = (1..POINTS).map(|point| f64::from(2 + 2 * (point as u32 % 2)) * integrand(point)).sum();
    (integrand(0) + inner + integrand(POINTS)) * last / (3.0 * POINTS as f64) / PI
}
