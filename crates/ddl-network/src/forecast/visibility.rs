//! Visibility masks: which pedestrians attend to which.

use crate::backend::Scenes;
use ddl_data::{Neighbours, Window};

/// The visibility masks of windows for each of the first `steps` time steps. A pedestrian attends to itself and to the
/// pedestrians in a square around it with half the side `half_box` (m).
///
/// # Panics
/// If `windows` is empty.
pub fn visibility(windows: &[&Window], steps: usize, half_box: f64) -> Scenes {
    let sizes: Vec<usize> = windows.iter().map(|window| window.len()).collect();
    let of_window = |window: &Window, step: usize| -> Vec<Vec<u32>> {
        let neighbours = Neighbours::within_box(&window.positions_at(step), half_box);
        let lists = (0..window.len()).map(|i| {
            let others = neighbours.of(i);
            let before = others.partition_point(|&j| (j as usize) < i);
            [&others[..before], &[i as u32], &others[before..]].concat()
        });
        lists.collect()
    };
    let frames = (0..steps).flat_map(|step| windows.iter().map(move |window| (window, step)));
    Scenes::new(&sizes, frames.flat_map(|(window, step)| of_window(window, step)))
}
