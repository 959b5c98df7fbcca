//! Strategies for windows and forecasts.

use ddl_core::{Forecast, HORIZON, PedestrianId, Position, WINDOW, Window};
use proptest::{collection::vec, prelude::*};

/// Positions up to 20 m from the origin, along each axis.
pub(crate) fn position() -> impl Strategy<Value = Position> + Clone {
    (-20.0..20.0, -20.0..20.0).prop_map(|(x, y)| [x, y])
}

pub(crate) fn window(
    (recording, start, step): (&'static str, i64, i64),
    pedestrians: usize,
    position: impl Strategy<Value = Position>,
) -> impl Strategy<Value = Window> {
    vec(vec(position, WINDOW), pedestrians).prop_map(move |tracks| {
        let ids = (0..).take(pedestrians).map(|id| PedestrianId(7 * id - 3));
        Window::new(recording, start, step, ids.collect(), tracks).unwrap()
    })
}

pub(crate) fn forecast(
    pedestrians: usize,
    k: usize,
    with_goals: bool,
    position: impl Strategy<Value = Position> + Clone,
) -> impl Strategy<Value = Forecast> {
    let pairs = pedestrians * k;
    let positions = vec(position.clone(), pairs * HORIZON);
    let (weights, goals) = (vec(0.01..1.0_f64, pairs), vec(position, pairs));
    (positions, weights, goals).prop_map(move |(positions, mut weights, goals)| {
        for row in weights.chunks_mut(k) {
            let sum: f64 = row.iter().sum();
            for weight in row {
                *weight /= sum;
            }
        }
        Forecast::new(pedestrians, k, positions, weights, with_goals.then_some(goals)).unwrap()
    })
}
