//! Collisions between the forecasts of one scene.
//!
//! Each pedestrian is a disc of radius r = 0.2 m that follows its representative hypothesis; between two frames it
//! moves in a straight line at constant speed. Two pedestrians collide when their discs overlap at any time from the
//! first to the last forecast frame:
//!
//! ```text
//! min over t in [1, 12] of |p_i(t) - p_j(t)| < 2 r = 0.4 m between the centres
//! collision rate = pedestrians who collide with another / pedestrians, in [0, 1]
//! ```
//!
//! The minimum is exact. Pedestrians alone in their window count in the denominator. Real pedestrians who walk together
//! also come this close: compare with the rate of the true futures. Other works take centres closer than 0.2 m, pairs
//! instead of pedestrians, or fewer instants: their percentages are not comparable.
//!
//! Against the truth (Col-II of `TrajNet++`) all pedestrians except i follow their TRUE futures.
//!
//! # References
//! Kothari, Kreiss, Alahi, "Human Trajectory Forecasting in Crowds" (`TrajNet++`), T-ITS 2021.

use ddl_core::Position;

use crate::scored_window::ScoredWindow;

/// Radius of a pedestrian, metres. Two collide when their centres are closer than twice this.
pub(crate) const PEDESTRIAN_RADIUS: f64 = 0.2;

/// The least distance of two pedestrians that move straight between frames, metres.
///
/// Infinite when either track is empty. Frames beyond the shorter track are ignored.
pub fn closest_approach(a: &[Position], b: &[Position]) -> f64 {
    let mut apart = a.iter().zip(b).map(|(p, q)| [p[0] - q[0], p[1] - q[1]]);
    let Some(mut before) = apart.next() else { return f64::INFINITY };
    let mut least = before[0].hypot(before[1]);
    for next in apart {
        least = least.min(distance_to_origin(before, next));
        before = next;
    }
    least
}

fn distance_to_origin(r0: Position, r1: Position) -> f64 {
    let d = [r1[0] - r0[0], r1[1] - r0[1]];
    let length_squared = d[0] * d[0] + d[1] * d[1];
    let s = if length_squared > 0.0 { (-(r0[0] * d[0] + r0[1] * d[1]) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    (r0[0] + s * d[0]).hypot(r0[1] + s * d[1])
}

/// Whether the disc of each track (`radius` in metres) overlaps that of another track; one entry for each track.
pub fn collides(tracks: &[&[Position]], radius: f64) -> Vec<bool> {
    let mut hit = vec![false; tracks.len()];
    for i in 0..tracks.len() {
        for j in i + 1..tracks.len() {
            if !(hit[i] && hit[j]) && closest_approach(tracks[i], tracks[j]) < 2.0 * radius {
                hit[i] = true;
                hit[j] = true;
            }
        }
    }
    hit
}

/// The [representative](ddl_core::Forecast::representative) forecast of each pedestrian, metres.
pub(crate) fn representative_tracks<'a>(scene: &ScoredWindow<'a>) -> Vec<&'a [Position]> {
    let forecast = scene.forecast();
    (0..scene.pedestrians()).map(|i| forecast.hypothesis(i, forecast.representative(i))).collect()
}

/// Whether the true future of each pedestrian collides with that of another one, forecast or not; `[N]`.
pub(crate) fn true_futures_collide(scene: &ScoredWindow<'_>, radius: f64) -> Vec<bool> {
    let full_window = scene.full_window();
    let tracks: Vec<&[Position]> = (0..full_window.len()).map(|j| full_window.future(j)).collect();
    let hit = collides(&tracks, radius);
    (0..scene.pedestrians()).map(|i| hit[scene.index_in_full(i)]).collect()
}

/// Whether the representative forecast of each pedestrian collides with the true future of another; `[N]`.
pub(crate) fn collides_with_true_futures(scene: &ScoredWindow<'_>, radius: f64) -> Vec<bool> {
    let (forecast, full_window) = (scene.forecast(), scene.full_window());
    let runs_into_another = |i: usize| {
        let track = forecast.hypothesis(i, forecast.representative(i));
        let index = scene.index_in_full(i);
        (0..full_window.len()).any(|j| j != index && closest_approach(track, full_window.future(j)) < 2.0 * radius)
    };
    (0..scene.pedestrians()).map(runs_into_another).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_told_alone_and_touching_is_no_collision() {
        let standing = |x: f64| [[x, 0.0]; 2];
        let (a, b, c, d) = (standing(0.0), standing(0.3), standing(0.6), standing(1.1));
        assert_eq!(collides(&[&a, &b, &c, &d], PEDESTRIAN_RADIUS), [true, true, true, false]);
        assert_eq!(collides(&[&a, &standing(0.4)], PEDESTRIAN_RADIUS), [false; 2]);
        assert_eq!(collides(&[&a], PEDESTRIAN_RADIUS), [false]);
    }
}
