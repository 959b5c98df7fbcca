//! Scenes for tests.

use crate::energy::Energy;
use crate::hypotheses::Hypotheses;
use crate::pairs::ObservedWalk;
use crate::{Futures, Plan, PlanPoint};
use ddl_core::{
    Forecast, HORIZON, OBSERVED, ObservationQuality, Pace, PedestrianId, Position, RegionTable, Spread, Window,
};

/// Constants that are unlike, so that no two can be exchanged.
pub(crate) fn energy() -> Energy {
    let constants = serde_json::json!({
        "conflict": {
            "near": [0.4, 0.2], "crowding": [0.2, 0.8],
            "alone": [1.6, 0.8, 0.4, 0.2, 0.1], "together": [3.1, 1.5, 0.7, 0.3, 0.5]
        },
        "together": {
            "distances": [1.0, 2.0, 4.0], "velocities": [0.1, 0.3, 0.6],
            "strengths": [[0.9, 0.8, 0.7], [0.6, 0.5, 0.4], [0.3, 0.2, 0.1]], "scale": 0.5
        },
        "avoidance": {
            "within": [0.2, 0.6, 1.0, 2.0], "shares": [3.0, 1.0, 0.5, 0.0], "strangers": [1.0, 0.4, 0.8],
            "companions": [0.5, 2.0]
        }
    });
    serde_json::from_value(constants).unwrap()
}

/// Where a pedestrian is (m), how fast it walked there (m/s), and weights and velocities of its hypotheses.
pub(crate) type FixturePedestrian = (Position, Position, Vec<(f64, Position)>);

/// A pedestrian a line: x, y and velocity, then the weight and the velocity of each hypothesis.
pub(crate) fn pedestrians(text: &str) -> Vec<FixturePedestrian> {
    let pedestrian = |line: &str| {
        let numbers: Vec<f64> = line.split_whitespace().map(|number| number.parse().unwrap()).collect();
        let (&[x, y, vx, vy], all) = numbers.split_first_chunk().unwrap();
        let hypotheses = all.as_chunks().0.iter().map(|&[weight, vx, vy]| (weight, [vx, vy]));
        ([x, y], [vx, vy], hypotheses.collect())
    };
    text.trim().lines().map(pedestrian).collect()
}

pub(crate) fn scene(pedestrians: &[FixturePedestrian]) -> (Window, Forecast) {
    let along = |at: Position, velocity: Position, steps: i32| {
        [0, 1].map(|axis| at[axis] + 0.4 * f64::from(steps) * velocity[axis])
    };
    let past = |&(at, velocity, _): &FixturePedestrian| (-7..=0).map(|t| along(at, velocity, t)).collect();
    // Not in the order of their names.
    let count = pedestrians.len() as i64;
    let ids = (1..=count).map(|i| PedestrianId(i % count)).collect();
    let window = Window::new("yard", 0, 10, ids, pedestrians.iter().map(past).collect()).unwrap();
    let hypotheses =
        pedestrians.iter().flat_map(|(at, _, all)| all.iter().map(|&(weight, velocity)| (*at, weight, velocity)));
    let paths = hypotheses.clone().flat_map(|(at, _, velocity)| (1..=12).map(move |t| along(at, velocity, t)));
    let weights = hypotheses.clone().map(|(_, weight, _)| weight).collect();
    let forecast = Forecast::new(pedestrians.len(), pedestrians[0].2.len(), paths.collect(), weights, None);
    (window, forecast.unwrap())
}

/// A pedestrian of a window, among people who keep apart.
pub(crate) fn walk(window: &Window, i: usize) -> ObservedWalk<'_> {
    ObservedWalk { track: window.observed(i), crowding: 0.0 }
}

pub(crate) fn hypotheses(pedestrians: &[FixturePedestrian]) -> Vec<Hypotheses> {
    let (window, forecast) = scene(pedestrians);
    (0..pedestrians.len()).map(|i| Hypotheses::of(&window, &forecast, i)).collect()
}

/// Pedestrians that stood and then go straight on: `[N][K]` velocities (m/s); the spread grows to `[N]` scales (m).
pub(crate) fn futures(starts: &[Position], velocities: &[Vec<Position>], weights: &[f64], scales: &[f64]) -> Futures {
    let n = starts.len();
    let pedestrian = |(&start, velocities): (&Position, &Vec<Position>)| {
        (start, [0.0; 2], weights.iter().copied().zip(velocities.iter().copied()).collect())
    };
    let (window, forecast) = scene(&starts.iter().zip(velocities).map(pedestrian).collect::<Vec<_>>());
    let steps = || (1..=HORIZON).map(|t| t as f64);
    let spread = Spread {
        scales: scales.iter().flat_map(|scale| steps().map(move |t| scale * t / HORIZON as f64)).collect(),
        paces: vec![Pace::Walking; n],
        regions: RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5]).unwrap().into(),
    };
    Futures::new(&window, forecast.with_spread(spread).unwrap(), None).unwrap()
}

/// The same scene, whose pedestrians were seen a while ago: their positions have this deviation (m).
pub(crate) fn with_deviation(futures: &Futures, deviation: f64) -> Futures {
    let n = futures.pedestrians();
    let tracks = (0..n).map(|i| vec![futures.present(i); OBSERVED]).collect();
    let ids = (0..n).map(|i| PedestrianId(i as i64)).collect();
    let quality = ObservationQuality { deviation, ..ObservationQuality::default() };
    let window = Window::new("yard", 0, 10, ids, tracks).unwrap().with_qualities(vec![quality; n]);
    Futures::new(&window, futures.forecast().clone(), None).unwrap()
}

/// A plan of rows of time (s), x, y and radius (m).
pub(crate) fn plan(rows: &[[f64; 4]]) -> Plan {
    let point = |&[time, x, y, radius]: &[f64; 4]| PlanPoint { time, position: [x, y], radius };
    Plan::new(rows.iter().map(point).collect()).unwrap()
}
