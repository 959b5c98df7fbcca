//! The energy of a scene: how badly the hypotheses of two pedestrians go together.
//!
//! A future chooses a hypothesis for each pedestrian. Its probability is
//!
//! ```text
//! p(h_1 .. h_N) ~ prod_i w_i(h_i) prod_(i,j) exp(-C_ij - T_ij)
//! C = conflict(d / near)                    d: least distance of the two paths, looked at every 0.2 s;
//!                                           near = min(0.4 m, distance kept), at least 0.1 m; 0.22 m in crowds
//! T = c / sqrt(partners) log(1 + D² / 3)    D = |difference of the displacements in 4.8 s| / scale
//! ```
//!
//! `conflict` is piecewise linear between 0, 1/2, 1, 3/2, 2 and 5/2. The strength `c` depends on how close the two
//! walked over the observation and how much their velocities differed; it is 0 for people who did not walk together.
//! All constants are in `energy.json`.

use ddl_core::{OBSERVED, Position, TIME_STEP, distance};
use serde::Deserialize;
use std::sync::LazyLock;

/// The constants of the energy.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Energy {
    conflict: Conflict,
    together: Together,
    avoidance: Avoidance,
}

/// How strongly people keep away from a plan that they see: logarithms by which the odds are divided that they come
/// close.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Avoidance {
    /// Distances between centres that count as close (m), ascending.
    within: [f64; 4],
    /// By these distances, the share of the logarithm of strangers.
    shares: [f64; 4],
    /// Of strangers: at 2 m from the plan; for each power of e farther from it; less where all let others come near.
    strangers: [f64; 3],
    /// Of companions: who kept just the distance that counts as close; for each power of e that they kept more.
    companions: [f64; 2],
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Conflict {
    /// Distances (m) below which two people collide where few, and where many let others come near; for two who were
    /// closer over the observation, the distance that they kept.
    near: [f64; 2],
    /// The share of people around who let others come near, from which and up to which the distance falls.
    crowding: [f64; 2],
    /// Energies of pairs that do not walk together at 0, 1/2, 1, 3/2 and 2 times the distance.
    alone: [f32; 5],
    /// Energies of pairs that walk together.
    together: [f32; 5],
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Together {
    /// Upper limits of the mean distance over the observation, metres.
    distances: [f64; 3],
    /// Upper limits of the difference of the mean velocities, m/s.
    velocities: [f64; 3],
    /// By distance, then velocity.
    strengths: [[f32; 3]; 3],
    /// Scale of the difference of displacements, metres.
    scale: f32,
}

static LEARNED: LazyLock<Option<Energy>> = LazyLock::new(|| serde_json::from_str(include_str!("energy.json")).ok());

/// The energy of one pair of pedestrians.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PairEnergy {
    /// Distance (m) that counts as 1 in `conflict`.
    pub(crate) near: f32,
    /// Radius (m) of who follows a plan, which is subtracted from distances.
    pub(crate) radius: f32,
    conflict: [f32; 5],
    /// Strength and scale of walking together.
    together: Option<(f32, f32)>,
}

/// Mean distance (m) of two observed tracks of 8 positions, and the difference of their mean velocities (m/s).
pub(crate) fn closeness(a: &[Position], b: &[Position]) -> [f64; 2] {
    let apart = a.iter().zip(b).map(|(p, q)| distance(*p, *q)).sum::<f64>() / a.len() as f64;
    let moved = |track: &[Position]| [0, 1].map(|axis| track[OBSERVED - 1][axis] - track[0][axis]);
    [apart, distance(moved(a), moved(b)) / (TIME_STEP * (OBSERVED - 1) as f64)]
}

impl Energy {
    /// The constants that come with the program.
    ///
    /// # Panics
    /// Never: a test reads the file.
    pub(crate) fn learned() -> &'static Self {
        #[expect(clippy::expect_used, reason = "the file is part of the program, and a test reads it")]
        LEARNED.as_ref().expect("energy.json holds the constants")
    }

    /// The logarithm by which the odds are divided that somebody comes within a distance (m) of a plan, who is at this
    /// distance (m) from it at the moment, where this share of people lets others come near.
    pub(crate) fn avoidance_of_stranger(&self, within: f64, present: f64, crowding: f64) -> f64 {
        let Avoidance { within: at, shares, strangers: [strength, of_present, of_crowding], .. } = &self.avoidance;
        let next = at.partition_point(|at| *at <= within).min(at.len() - 1);
        let [from, to] = [next.saturating_sub(1), next];
        let along = if to > from { (within - at[from]) / (at[to] - at[from]) } else { 0.0 };
        let share = shares[from] + along.clamp(0.0, 1.0) * (shares[to] - shares[from]);
        let present = (present.clamp(0.5, 10.0) / 2.0).ln();
        (share * (strength + of_present * present - of_crowding * crowding)).max(0.0)
    }

    /// The same of somebody who walks with the one who follows the plan, and kept this distance (m) from it.
    pub(crate) fn avoidance_of_companion(&self, within: f64, kept: f64) -> f64 {
        let [strength, of_kept] = self.avoidance.companions;
        (strength + of_kept * (kept / within.max(0.1)).ln().clamp(-0.5, 1.0)).max(0.0)
    }

    /// The energy of two who walk together with this strength, whose displacements differ by this squared length (m²).
    pub(crate) fn apart(&self, strength: f32, squared: f32) -> f32 {
        apart(strength, squared, self.together.scale)
    }

    /// Least distance (m) of two paths at which no pair has a conflict.
    pub(crate) fn reach(&self) -> f64 {
        2.5 * self.conflict.near[0]
    }

    /// Mean distance (m) from which two pedestrians do not count as walking together.
    pub(crate) fn together_within(&self) -> f64 {
        self.together.distances[2]
    }

    /// How strongly two tracks of this [`closeness`] belong together; 0 for strangers.
    pub(crate) fn strength(&self, [apart, velocities]: [f64; 2]) -> f32 {
        let bin = |limits: &[f64; 3], value: f64| limits.iter().position(|limit| value < *limit);
        match (bin(&self.together.distances, apart), bin(&self.together.velocities, velocities)) {
            (Some(distance), Some(velocity)) => self.together.strengths[distance][velocity],
            _ => 0.0,
        }
    }

    /// The energy of a pair that kept this distance, of this radius (m), where this share of people lets others come
    /// near, whose [strength](Self::strength) is divided among partners.
    pub(crate) fn of_pair(&self, [kept, radius]: [f64; 2], crowding: f64, strength: f32, partners: f32) -> PairEnergy {
        let Conflict { near: [sparse, dense], crowding: [from, to], .. } = self.conflict;
        let share = ((crowding - from) / (to - from)).clamp(0.0, 1.0);
        let near = (sparse + share * (dense - sparse)).min(kept - radius);
        PairEnergy {
            near: (near as f32).max(0.1),
            radius: radius as f32,
            conflict: if strength > 0.0 { self.conflict.together } else { self.conflict.alone },
            together: (strength > 0.0).then(|| (strength / partners.max(1.0).sqrt(), self.together.scale)),
        }
    }
}

/// The energy of walking together with a strength, of displacements whose difference has this squared length (m²).
fn apart(strength: f32, squared: f32, scale: f32) -> f32 {
    strength * (squared / (3.0 * scale * scale)).ln_1p()
}

impl PairEnergy {
    /// Distance (m) from which paths have no conflict.
    pub(crate) fn reach(&self) -> f32 {
        2.5 * self.near + self.radius
    }

    /// The energy of paths that come this close (m).
    pub(crate) fn conflict(&self, distance: f32) -> f32 {
        let at = 2.0 * (distance - self.radius).max(0.0) / self.near;
        let knot = at as usize;
        let energy = |knot: usize| self.conflict.get(knot).copied().unwrap_or(0.0);
        let share = at - at.floor();
        energy(knot) * (1.0 - share) + energy(knot + 1) * share
    }

    /// The energy of displacements whose difference has this squared length (m²).
    pub(crate) fn apart(&self, squared: f32) -> f32 {
        match self.together {
            Some((strength, scale)) => apart(strength, squared, scale),
            None => 0.0,
        }
    }

    /// Whether the two may walk together.
    pub(crate) fn is_together(&self) -> bool {
        self.together.is_some()
    }
}

#[cfg(test)]
mod tests;
