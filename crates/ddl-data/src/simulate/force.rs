//! The forces on a pedestrian, as accelerations (m/s²).

use ddl_core::Position;

use crate::simulate::obstacle::{Pillar, Segment};
use crate::simulate::vector::{add, cross, dot, left, norm, scale, sub, unit};

/// Radius of a body (m).
pub(super) const BODY: f64 = 0.2;
/// Time in which a pedestrian adapts its velocity (s).
const RELAXATION: f64 = 0.5;

// The interaction of two pedestrians, Moussaïd et al. 2009, with their symbols.
/// Largest acceleration of braking or turning (m/s²).
const STRENGTH: f64 = 4.5;
/// Reach of the interaction for each unit of the relative motion (m): gamma.
const REACH: f64 = 0.35;
/// Angular sharpness of braking: n'.
const BRAKING: f64 = 3.0;
/// Angular sharpness of turning aside: n.
const TURNING: f64 = 2.0;
/// Weight of the relative velocity against the direction to the other (s/m): lambda.
const FORESIGHT: f64 = 2.0;
/// Preference for one side, which breaks the symmetry when two pedestrians meet head on: epsilon.
const SIDE: f64 = 0.05;
/// Beyond this distance two pedestrians ignore each other (m).
const SIGHT: f64 = 6.0;

/// Repulsion of walls (m/s²) ...
const WALL_STRENGTH: f64 = 3.0;
/// ... which decays over this distance (m), counted from the body.
const WALL_REACH: f64 = 0.15;

// Groups, after Moussaïd et al. 2010.
/// Attraction towards the centre of the group, per metre beyond the comfortable distance (1/s²).
const COHESION: f64 = 1.5;
/// Comfortable distance from the centre per other member (m).
const COMFORT: f64 = 0.5;
/// Repulsion between touching members (m/s²) ...
const ELBOW: f64 = 4.0;
/// ... which vanishes at this distance (m).
const ELBOW_REACH: f64 = 0.65;

#[derive(Debug, Clone, Copy)]
pub(super) struct WalkingMotion {
    pub(super) position: Position,
    pub(super) velocity: Position,
}

pub(super) fn driving(pedestrian: WalkingMotion, desired: Position) -> Position {
    scale(sub(desired, pedestrian.velocity), 1.0 / RELAXATION)
}

/// Repulsion from a pedestrian outside the group: braking, and turning aside early if the two would meet. With `e` the
/// unit vector to the other and `D = lambda (v_i - v_j) + e`, the force decays with `exp(-d / B)`, `B = gamma |D|`,
/// along `D` (braking) and across it (turning); `d` is counted between the bodies. Source: Moussaïd et al., Proc. R.
/// Soc. B 276 (2009), equations 4 and 5.
pub(super) fn stranger(pedestrian: WalkingMotion, other: WalkingMotion, other_radius: f64) -> Position {
    let apart = sub(other.position, pedestrian.position);
    let distance = norm(apart);
    let gap = (distance - BODY - other_radius).max(0.0);
    if gap > SIGHT || distance == 0.0 {
        return [0.0, 0.0];
    }
    let towards = unit(apart);
    let meeting = add(scale(sub(pedestrian.velocity, other.velocity), FORESIGHT), towards);
    let reach = REACH * norm(meeting);
    if reach == 0.0 {
        return scale(towards, -STRENGTH * (-gap / REACH).exp());
    }
    let ahead = unit(meeting);
    let angle = cross(ahead, towards).atan2(dot(ahead, towards)) + reach * SIDE;
    let falloff = STRENGTH * (-gap / reach).exp();
    let narrowed = |width: f64| falloff * (-(width * reach * angle).powi(2)).exp();
    add(scale(ahead, -narrowed(BRAKING)), scale(left(ahead), -angle.signum() * narrowed(TURNING)))
}

pub(super) fn pillar(pedestrian: WalkingMotion, pillar: &Pillar) -> Position {
    stranger(pedestrian, WalkingMotion { position: pillar.centre, velocity: [0.0, 0.0] }, pillar.radius)
}

pub(super) fn wall(pedestrian: WalkingMotion, wall: &Segment) -> Position {
    let away = sub(pedestrian.position, wall.nearest(pedestrian.position));
    let gap = norm(away) - BODY;
    scale(unit(away), WALL_STRENGTH * (-gap.max(0.0) / WALL_REACH).exp())
}

/// Attraction towards the centre of the own group of `size` members, beyond the comfortable distance.
pub(super) fn cohesion(pedestrian: WalkingMotion, centre: Position, size: usize) -> Position {
    let apart = sub(centre, pedestrian.position);
    let excess = norm(apart) - COMFORT * (size - 1) as f64;
    scale(unit(apart), COHESION * excess.clamp(0.0, 2.0))
}

pub(super) fn companion(pedestrian: WalkingMotion, other: WalkingMotion) -> Position {
    let away = sub(pedestrian.position, other.position);
    let closeness = (1.0 - norm(away) / ELBOW_REACH).max(0.0);
    scale(unit(away), ELBOW * closeness)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equations 4 and 5 of Moussaïd et al. 2009, evaluated in numpy outside this project. The cases are two
    /// pedestrians that meet, two that walk side by side and overlap, a pillar, a pedestrian close ahead, and one at
    /// the very edge of sight. A line has position and velocity of both, the radius of the other, and the force.
    #[test]
    fn strangers_are_avoided_as_the_equations_say() {
        let cases = "
0 0 1.3 0    2 0.1 -1.1 0.2     0.2  -0.4427861832 -0.9486947846
1 2 0.5 0.8  1.6 3.1 0.4 0.1    0.2  -1.8169632258 -0.8708448759
0 0 1 0.2    1.4 -0.3 0 0       0.5  -1.4840620267  1.7071644078
0 0 1.2 0    0.3 0.05 1 0.1     0.2  -4.1887405311 -4.2018664504
0 0 1 0      6.5 0 0 0          0.3  -0.01444283   -0.01466395
";
        for case in cases.trim().lines() {
            let n: Vec<f64> = case.split_whitespace().map(|n| n.parse().unwrap()).collect();
            let moving =
                |from: usize| WalkingMotion { position: [n[from], n[from + 1]], velocity: [n[from + 2], n[from + 3]] };
            let force = stranger(moving(0), moving(4), n[8]);
            assert!(norm(sub(force, [n[9], n[10]])) < 1e-8, "{case}: {force:?}");
        }
    }
}
