//! The forces on a walker, as accelerations (m/s²).

use super::obstacle::{Pillar, Wall};
use super::vector::{add, cross, dot, left, norm, scale, sub, unit};
use crate::Position;

/// Radius of a body (m).
pub(super) const BODY: f64 = 0.2;
/// Time in which a walker adapts its velocity (s).
const RELAXATION: f64 = 0.5;

// The interaction of two walkers, Moussaïd et al. 2009, with their symbols.
/// How strongly they brake or turn at most (m/s²).
const STRENGTH: f64 = 4.5;
/// Reach of the interaction for each unit of the relative motion (m): gamma.
const REACH: f64 = 0.35;
/// How narrow in angle the braking is: n'.
const BRAKING: f64 = 3.0;
/// How narrow in angle the turning aside is: n.
const TURNING: f64 = 2.0;
/// Weight of the relative velocity against the direction to the other (s/m): lambda.
const FORESIGHT: f64 = 2.0;
/// Preference for one side, which settles who goes where when two meet head on: epsilon.
const SIDE: f64 = 0.05;
/// Beyond this distance two walkers ignore each other (m).
const SIGHT: f64 = 6.0;

/// Walls push away with this strength (m/s²) ...
const WALL_STRENGTH: f64 = 3.0;
/// ... falling off over this distance (m), counted from the body.
const WALL_REACH: f64 = 0.15;

// Groups, after Moussaïd et al. 2010.
/// Pull towards the centre of the group, for each metre too far from it (1/s²).
const COHESION: f64 = 1.5;
/// Comfortable distance from the centre for each other member (m).
const COMFORT: f64 = 0.5;
/// Push between members who touch (m/s²) ...
const ELBOW: f64 = 4.0;
/// ... falling to nothing at this distance (m).
const ELBOW_REACH: f64 = 0.65;

/// What a walker's surroundings see of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct WalkingMotion {
    pub(super) position: Position,
    pub(super) velocity: Position,
}

/// Towards the velocity that the walker likes.
pub(super) fn driving(walker: WalkingMotion, desired: Position) -> Position {
    scale(sub(desired, walker.velocity), 1.0 / RELAXATION)
}

/// Away from a stranger: brake, and turn aside early when the two will meet.
///
/// With `e` the unit vector to the other and `D = lambda (v_i - v_j) + e`, the force decays with `exp(-d / B)`, `B =
/// gamma |D|`, along `D` (braking) and across it (turning); `d` is counted between the bodies: Moussaïd et al., Proc.
/// R. Soc. B 276 (2009), equations 4 and 5.
pub(super) fn stranger(walker: WalkingMotion, other: WalkingMotion, other_radius: f64) -> Position {
    let apart = sub(other.position, walker.position);
    let distance = norm(apart);
    let gap = (distance - BODY - other_radius).max(0.0);
    if gap > SIGHT || distance == 0.0 {
        return [0.0, 0.0];
    }
    let towards = unit(apart);
    let meeting = add(
        scale(sub(walker.velocity, other.velocity), FORESIGHT),
        towards,
    );
    let reach = REACH * norm(meeting);
    if reach == 0.0 {
        return scale(towards, -STRENGTH * (-gap / REACH).exp());
    }
    let ahead = unit(meeting);
    let angle = cross(ahead, towards).atan2(dot(ahead, towards)) + reach * SIDE;
    let falloff = STRENGTH * (-gap / reach).exp();
    let narrowed = |width: f64| falloff * (-(width * reach * angle).powi(2)).exp();
    let brake = scale(ahead, -narrowed(BRAKING));
    let turn = scale(left(ahead), -angle.signum() * narrowed(TURNING));
    add(brake, turn)
}

/// Around a pillar, which is a stranger that stands still.
pub(super) fn pillar(walker: WalkingMotion, pillar: &Pillar) -> Position {
    let still = WalkingMotion {
        position: pillar.centre,
        velocity: [0.0, 0.0],
    };
    stranger(walker, still, pillar.radius)
}

/// Away from a wall.
pub(super) fn wall(walker: WalkingMotion, wall: &Wall) -> Position {
    let away = sub(walker.position, wall.nearest(walker.position));
    let gap = norm(away) - BODY;
    scale(
        unit(away),
        WALL_STRENGTH * (-gap.max(0.0) / WALL_REACH).exp(),
    )
}

/// Towards the centre of the own group of `size`, when too far from it.
pub(super) fn cohesion(walker: WalkingMotion, centre: Position, size: usize) -> Position {
    let apart = sub(centre, walker.position);
    let excess = norm(apart) - COMFORT * (size - 1) as f64;
    scale(unit(apart), COHESION * excess.clamp(0.0, 2.0))
}

/// Away from a member of the own group who is too close.
pub(super) fn companion(walker: WalkingMotion, other: WalkingMotion) -> Position {
    let away = sub(walker.position, other.position);
    let closeness = (1.0 - norm(away) / ELBOW_REACH).max(0.0);
    scale(unit(away), ELBOW * closeness)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

    use super::*;

    fn near(found: Position, expected: Position) -> bool {
        norm(sub(found, expected)) < 1e-9
    }

    fn moving(position: Position, velocity: Position) -> WalkingMotion {
        WalkingMotion { position, velocity }
    }

    /// Equations 4 and 5 of Moussaïd et al. 2009, written down in numpy outside this project: two who meet, two who walk on beside each other
    /// and overlap, a pillar, somebody close ahead, and somebody at the very edge of sight.
    #[test]
    fn strangers_are_avoided_as_the_equations_say() {
        for (me, other, radius, expected) in [
            (
                moving([0.0, 0.0], [1.3, 0.0]),
                moving([2.0, 0.1], [-1.1, 0.2]),
                BODY,
                [-0.442_786_183_2, -0.948_694_784_6],
            ),
            (
                moving([1.0, 2.0], [0.5, 0.8]),
                moving([1.6, 3.1], [0.4, 0.1]),
                BODY,
                [-1.816_963_225_8, -0.870_844_875_9],
            ),
            (
                moving([0.0, 0.0], [1.0, 0.2]),
                moving([1.4, -0.3], [0.0, 0.0]),
                0.5,
                [-1.484_062_026_7, 1.707_164_407_8],
            ),
            (
                moving([0.0, 0.0], [1.2, 0.0]),
                moving([0.3, 0.05], [1.0, 0.1]),
                BODY,
                [-4.188_740_531_1, -4.201_866_450_4],
            ),
            (
                moving([0.0, 0.0], [1.0, 0.0]),
                moving([6.5, 0.0], [0.0, 0.0]),
                0.3,
                [-0.014_442_83, -0.014_663_95],
            ),
        ] {
            let found = stranger(me, other, radius);
            assert!(norm(sub(found, expected)) < 1e-8, "{found:?} {expected:?}");
        }
        let around = pillar(
            moving([0.0, 0.0], [1.0, 0.2]),
            &Pillar::new([1.4, -0.3], 0.5),
        );
        assert!(
            near(around, [-1.484_062_026_7, 1.707_164_407_8]),
            "{around:?}"
        );
    }

    /// By hand: the force is 0 beyond 6 m and at distance 0. Where both move at the same velocity it depends on the distance
    /// alone: 0.6 m between the bodies give 4.5 exp(-0.6 / 0.35).
    #[test]
    fn nobody_is_avoided_who_is_out_of_sight() {
        let me = moving([0.0, 0.0], [0.0, 0.0]);
        for place in [[6.5, 0.0], [0.0, 0.0]] {
            assert_eq!(stranger(me, moving(place, [-1.0, 0.0]), BODY), [0.0, 0.0]);
        }
        let leaving = stranger(me, moving([1.0, 0.0], [0.5, 0.0]), BODY);
        assert!(
            near(leaving, [-0.810_415_404_665_785_5, 0.0]),
            "{leaving:?}"
        );
    }

    /// By hand: half a second to adapt; 3 exp(-0.3 / 0.15) at 0.3 m from a wall, 3 m/s² where the body touches it.
    #[test]
    fn velocities_are_adapted_and_walls_push() {
        let me = moving([0.5, 2.0], [1.0, 0.5]);
        assert!(near(driving(me, [1.5, 0.0]), [1.0, -1.0]));
        let beside = Wall::new([0.0, 0.0], [0.0, 9.0]);
        assert!(near(wall(me, &beside), [0.406_005_849_709_838_1, 0.0]));
        let touching = moving([0.1, 2.0], [1.0, 0.5]);
        assert!(near(wall(touching, &beside), [3.0, 0.0]));
        let corner = Wall::new([0.2, 1.6], [-3.0, 1.6]);
        assert!(near(
            wall(me, &corner),
            [0.243_603_509_825_902_84, 0.324_804_679_767_870_5]
        ));
    }

    /// By hand: 1.5/s² for each metre beyond 0.5 m a companion, of two metres at most; 4 (1 - 0.5 / 0.65) at half a metre.
    #[test]
    fn groups_stay_together_and_do_not_touch() {
        let me = moving([0.0, 0.0], [1.0, 0.0]);
        assert!(near(cohesion(me, [0.0, 1.5], 2), [0.0, 1.5]));
        assert!(near(cohesion(me, [1.25, 0.0], 3), [0.375, 0.0]));
        assert!(near(cohesion(me, [0.0, 0.4], 2), [0.0, 0.0]));
        assert!(near(cohesion(me, [-9.0, 0.0], 2), [-3.0, 0.0]));
        let beside = moving([0.3, 0.4], [0.0, 0.0]);
        let push = 4.0 * (1.0 - 0.5 / 0.65);
        assert!(near(companion(me, beside), [-0.6 * push, -0.8 * push]));
        assert!(near(
            companion(me, moving([0.7, 0.0], [0.0, 0.0])),
            [0.0, 0.0]
        ));
        assert_eq!(companion(me, me), [0.0, 0.0]);
    }
}
