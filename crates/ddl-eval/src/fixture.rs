//! Small scenes whose errors can be computed by hand.

use ddl_core::{Forecast, HORIZON, OBSERVED, PedestrianId, Position, WINDOW, Window};

/// Each pedestrian stands at `starts[i]` while observed, then walks `steps[i]` per frame.
pub(crate) fn window(starts: &[Position], steps: &[Position]) -> Window {
    let tracks = starts.iter().zip(steps).map(|(start, step)| {
        (0..WINDOW).map(|t: usize| at(*start, *step, (t + 1).saturating_sub(OBSERVED) as f64)).collect()
    });
    of_tracks(tracks.collect())
}

pub(crate) fn of_tracks(tracks: Vec<Vec<Position>>) -> Window {
    let ids = (0..).take(tracks.len()).map(PedestrianId).collect();
    Window::new("made up", 0, 10, ids, tracks).unwrap()
}

/// Pedestrians of constant velocity: first position, and metres per frame.
pub(crate) fn walking(motions: &[(Position, Position)], frames: usize) -> Window {
    let track = |&(start, step): &(Position, Position)| (0..frames).map(|t| at(start, step, t as f64)).collect();
    of_tracks(motions.iter().map(track).collect())
}

pub(crate) fn walk(start: Position, step: Position) -> Vec<Position> {
    (1..=HORIZON).map(|t| at(start, step, t as f64)).collect()
}

pub(crate) fn forecast(pedestrians: usize, hypotheses: &[Vec<Position>]) -> Forecast {
    Forecast::with_equal_weights(pedestrians, hypotheses.len() / pedestrians, hypotheses.concat()).unwrap()
}

fn at(start: Position, step: Position, t: f64) -> Position {
    [start[0] + t * step[0], start[1] + t * step[1]]
}
