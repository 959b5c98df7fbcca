//! Cost of the guarantee: how far real pedestrians would have to be moved, so that their distance to their endpoint
//! falls at every step (`docs/stability.md`).

use ddl_core::distance;
use ddl_data::{Convention, Dataset, HORIZON, OBSERVED, Position, TIME_STEP, WindowRule};
use ddl_dynamics::{Attractor, CholeskyMetric, LyapunovCertificate, PUBLISHED_SIGMA};
use ddl_eval::metric::stability::RolloutStability;
use ddl_tests::recordings;
use nalgebra::Vector2;

/// A pedestrian that moves less than this in 4.8 s stands (m).
const STANDING: f64 = 1.0;

/// The path with every point moved straight towards the last one, to the smallest distance so far.
fn never_further_from_its_end(path: &[Position]) -> Vec<Position> {
    let end = path[path.len() - 1];
    let mut nearest = f64::INFINITY;
    let moved = |&p: &Position| {
        let remaining = distance(p, end);
        if remaining <= nearest {
            nearest = remaining;
            return p;
        }
        let share = nearest / remaining;
        [0, 1].map(|axis| end[axis] + share * (p[axis] - end[axis]))
    };
    path.iter().map(moved).collect()
}

/// Whether the distance to the endpoint falls at every step until it is reached, and then stays 0. A certificate holds
/// under the same condition, for any metric.
fn certified(path: &[Position]) -> bool {
    let positions: Vec<_> = path.iter().map(|&p| Vector2::from(p)).collect();
    let metrics = vec![CholeskyMetric::planar(1.0, 0.0, 1.0, PUBLISHED_SIGMA).unwrap(); HORIZON];
    let end = Attractor::new(positions[HORIZON]).unwrap();
    let certificate = LyapunovCertificate::new(&positions, &metrics, &end, TIME_STEP).unwrap();
    certificate.verify().is_ok()
}

struct Pedestrian {
    /// Mean distance between the real and the moved positions, over 12 frames (m).
    displacement: f64,
    walks: bool,
    certified: bool,
    /// Largest angle between a step and the direction to the endpoint (degrees).
    largest_turn: f64,
}

impl Pedestrian {
    fn of(path: &[Position]) -> Self {
        let (start, end) = (path[0], path[HORIZON]);
        let approaching = never_further_from_its_end(path);
        let moved = path.iter().zip(&approaching).map(|(&a, &b)| distance(a, b));
        Self {
            displacement: moved.sum::<f64>() / HORIZON as f64,
            walks: distance(start, end) > STANDING,
            certified: certified(path),
            largest_turn: RolloutStability::of(start, &path[1..], end).largest_turn,
        }
    }
}

/// For each fold: the number of pedestrians and their mean displacement (mm). Of the walking pedestrians: the share
/// whose distance falls at every step (%), and the share with a step of more than 90 degrees away from the endpoint
/// (%).
const EXPECTED: [(&str, usize, [f64; 3]); 5] = [
    ("eth", 2_511, [2.0, 93.0, 1.7]),
    ("hotel", 1_026, [9.0, 97.0, 1.7]),
    ("univ", 24_254, [2.0, 98.0, 1.7]),
    ("zara1", 2_324, [1.0, 99.0, 0.5]),
    ("zara2", 5_900, [1.0, 98.0, 1.3]),
];

/// Share of `pedestrians` with a property (%).
fn percent(pedestrians: &[&Pedestrian], has: impl Fn(&Pedestrian) -> bool) -> f64 {
    let count = pedestrians.iter().filter(|pedestrian| has(pedestrian)).count();
    100.0 * count as f64 / pedestrians.len() as f64
}

fn displacement<'a>(pedestrians: impl ExactSizeIterator<Item = &'a Pedestrian>) -> f64 {
    let count = pedestrians.len() as f64;
    1e3 * pedestrians.map(|pedestrian| pedestrian.displacement).sum::<f64>() / count
}

/// The `percent`-th percentile of the largest turns (degrees).
fn turn_of(pedestrians: &[&Pedestrian], percent: usize) -> f64 {
    let mut turns: Vec<_> = pedestrians.iter().map(|pedestrian| pedestrian.largest_turn).collect();
    turns.sort_by(f64::total_cmp);
    turns[(turns.len() - 1) * percent / 100]
}

#[test]
#[expect(clippy::float_cmp, reason = "both sides are rounded to the compared digits")]
fn the_guarantee_moves_real_pedestrians_by_millimetres() {
    let Some(folder) = recordings::star_folder() else {
        return;
    };
    let dataset = Dataset::load(Convention::Star, &folder).unwrap();
    for (name, count, expected) in EXPECTED {
        let windows = dataset.fold(name).unwrap();
        let windows = windows.test_windows(WindowRule::Published);
        let paths = windows
            .iter()
            .flat_map(|window| (0..window.len()).map(|i| &window.track(i)[OBSERVED - 1..]));
        let pedestrians: Vec<_> = paths.map(Pedestrian::of).collect();
        let walking: Vec<_> = pedestrians.iter().filter(|pedestrian| pedestrian.walks).collect();

        let moved = displacement(pedestrians.iter());
        let certified = percent(&walking, |pedestrian| pedestrian.certified);
        let turning_back = percent(&walking, |pedestrian| pedestrian.largest_turn > 90.0);
        eprintln!(
            "{name}: {count} pedestrians moved by {moved:.2} mm, the {} that walk by {:.2} mm; of these \
             {certified:.1} % certified, largest turn from the end {:.0} degrees (median), {:.0} (95 of 100), above 90 \
             {turning_back:.1} %",
            walking.len(),
            displacement(walking.iter().copied()),
            turn_of(&walking, 50),
            turn_of(&walking, 95),
        );
        assert_eq!(pedestrians.len(), count, "{name}");
        let turning_back = (10.0 * turning_back).round() / 10.0;
        let measured = [moved.round(), certified.round(), turning_back];
        assert_eq!(measured, expected, "{name}");
    }
}
