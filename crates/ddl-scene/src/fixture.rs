//! Scenes for tests.

use crate::{Futures, Plan, PlanPoint};
use ddl_core::{
    Forecast, HORIZON, OBSERVED, ObservationQuality, Pace, PedestrianId, Position, RegionTable, Spread, Window,
};

/// Pedestrians that stood and then go straight on: `[N][K]` velocities (m/s); the spread grows to `[N]` scales (m).
pub(crate) fn futures(starts: &[Position], velocities: &[Vec<Position>], weights: &[f64], scales: &[f64]) -> Futures {
    let n = starts.len();
    let tracks = starts.iter().map(|&start| vec![start; OBSERVED]).collect();
    let ids = (0..n).map(|i| PedestrianId(i as i64)).collect();
    let window = Window::new("yard", 0, 10, ids, tracks).unwrap();
    let steps = || (1..=HORIZON).map(|t| t as f64);
    let mut positions = Vec::new();
    for (start, velocities) in starts.iter().zip(velocities) {
        for velocity in velocities {
            positions.extend(steps().map(|t| [0, 1].map(|axis| start[axis] + 0.4 * t * velocity[axis])));
        }
    }
    let forecast = Forecast::new(n, weights.len(), positions, weights.repeat(n), None).unwrap();
    let spread = Spread {
        scales: scales
            .iter()
            .flat_map(|scale| steps().map(move |t| scale * t / HORIZON as f64))
            .collect(),
        paces: vec![Pace::Walking; n],
        regions: RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5]).unwrap().into(),
    };
    Futures::new(&window, forecast.with_spread(spread).unwrap()).unwrap()
}

/// The same scene, whose pedestrians were seen a while ago: their positions have this deviation (m).
pub(crate) fn with_deviation(futures: &Futures, deviation: f64) -> Futures {
    let n = futures.pedestrians();
    let tracks = (0..n).map(|i| vec![futures.present(i); OBSERVED]).collect();
    let ids = (0..n).map(|i| PedestrianId(i as i64)).collect();
    let quality = ObservationQuality {
        deviation,
        ..ObservationQuality::default()
    };
    let window = Window::new("yard", 0, 10, ids, tracks)
        .unwrap()
        .with_qualities(vec![quality; n]);
    Futures::new(&window, futures.forecast().clone()).unwrap()
}

/// A plan of rows of time (s), x, y and radius (m).
pub(crate) fn plan(rows: &[[f64; 4]]) -> Plan {
    let point = |&[time, x, y, radius]: &[f64; 4]| PlanPoint {
        time,
        position: [x, y],
        radius,
    };
    Plan::new(rows.iter().map(point).collect()).unwrap()
}
