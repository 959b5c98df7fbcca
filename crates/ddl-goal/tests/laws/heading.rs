//! The heading frame under rotation, translation and mirroring of the scene.

use crate::tracks::{Positions, distance};
use ddl_goal::{HeadingFrame, TrackError};
use proptest::prelude::*;

/// 8 positions of a pedestrian with steps of up to 0.8 m.
fn observed() -> impl Strategy<Value = Positions> {
    let step = prop::array::uniform2(-0.8..0.8_f64);
    let scale = prop_oneof![Just(1.0), Just(0.05)];
    (prop::collection::vec(step, 7), scale).prop_map(|(steps, scale)| {
        let mut position = [3.0, -2.0];
        let walked = steps.into_iter().map(|[dx, dy]| {
            position = [position[0] + scale * dx, position[1] + scale * dy];
            position
        });
        std::iter::once([3.0, -2.0]).chain(walked).collect()
    })
}

/// Whether the heading is well defined.
fn has_heading(track: &[[f64; 2]]) -> bool {
    let (last, before, first) = (track[7], track[6], track[0]);
    let step = distance(last, before);
    let share = (1.0 - step / 0.2).max(0.0);
    let toward = [0, 1].map(|d| last[d] - before[d] + share * (last[d] - first[d]));
    toward[0].hypot(toward[1]) > 1e-3
}

/// The direction of the first axis in the world.
fn heading(frame: &HeadingFrame) -> [f64; 2] {
    let (ahead, origin) = (frame.to_world([1.0, 0.0]), frame.to_world([0.0; 2]));
    [ahead[0] - origin[0], ahead[1] - origin[1]]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn transforms_are_inverse(track in observed(), point in prop::array::uniform2(-1e3..1e3_f64)) {
        let frame = HeadingFrame::new(&track)?;
        prop_assert!(distance(frame.to_world(frame.to_frame(point)), point) < 1e-12 * 1e3);
        prop_assert!(distance(frame.to_frame(frame.to_world(point)), point) < 1e-12 * 1e3);
        // The heading is a difference of two positions, which loses digits that the frame's own axes have.
        let [cos, sin] = heading(&frame);
        // A difference of positions up to 10 m from the origin, each rounded to 1e-15 m.
        prop_assert!((cos.hypot(sin) - 1.0).abs() < 1e-12);
        prop_assert_eq!(frame.to_frame(track[7]), [0.0, 0.0]);
    }

    #[test]
    fn a_long_last_step_is_the_heading(track in observed()) {
        prop_assume!(distance(track[6], track[7]) > 0.2);
        let frame = HeadingFrame::new(&track)?;
        let [ahead, left] = frame.to_frame(track[6]);
        prop_assert!(ahead < -0.2 && left.abs() < 1e-12);
    }

    #[test]
    fn the_frame_turns_and_moves_with_the_scene(
        track in observed(), point in prop::array::uniform2(-50.0..50.0_f64),
        angle in -4.0..4.0_f64, by in prop::array::uniform2(-100.0..100.0_f64),
    ) {
        prop_assume!(has_heading(&track));
        let (sin, cos) = angle.sin_cos();
        let image = |[x, y]: [f64; 2]| [cos * x - sin * y + by[0], sin * x + cos * y + by[1]];
        let moved: Positions = track.iter().map(|&p| image(p)).collect();
        let (here, there) = (HeadingFrame::new(&track)?, HeadingFrame::new(&moved)?);
        prop_assert!(distance(here.to_frame(point), there.to_frame(image(point))) < 1e-8);
    }

    #[test]
    fn mirroring_the_scene_changes_the_sign_of_left(
        track in observed(), point in prop::array::uniform2(-50.0..50.0_f64),
    ) {
        prop_assume!(has_heading(&track));
        let mirror = |[x, y]: [f64; 2]| [x, -y];
        let mirrored: Positions = track.iter().map(|&p| mirror(p)).collect();
        let (here, there) = (HeadingFrame::new(&track)?, HeadingFrame::new(&mirrored)?);
        prop_assert_eq!(there.to_frame(mirror(point)), mirror(here.to_frame(point)));
    }

}

#[test]
fn a_standing_pedestrian_has_the_axes_of_the_world() {
    let frame = HeadingFrame::new(&[[5.0, 6.0]; 8]).unwrap();
    assert_eq!((frame.to_world([0.0; 2]), heading(&frame)), ([5.0, 6.0], [1.0, 0.0]));
    // A pedestrian that stopped still faces its last walking direction.
    let mut stopped: Positions = (0..7).map(|i| [0.0, 0.1 * f64::from(i)]).collect();
    stopped.push(stopped[6]);
    assert_eq!(heading(&HeadingFrame::new(&stopped).unwrap()), [0.0, 1.0]);
}

#[test]
fn invalid_positions_are_reported() {
    let refused = |positions: &[[f64; 2]]| HeadingFrame::new(positions).unwrap_err();
    let (positions, needed) = (1, 2);
    assert_eq!(refused(&[[0.0, 0.0]]), TrackError::TooShort { positions, needed });
    let nan = refused(&[[0.0, f64::NAN], [0.0, 0.0]]);
    assert!(matches!(nan, TrackError::NonFinite { index: 0, .. }));
    let far = refused(&[[-1e308, 0.0], [1e308, 0.0]]);
    assert_eq!(far, TrackError::VelocityOverflow { index: 0 });
}
