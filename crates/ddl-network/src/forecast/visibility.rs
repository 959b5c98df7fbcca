//! Visibility masks: which pedestrians attend to which.

use crate::backend::Scenes;
use ddl_data::{Position, SpatialIndex, Window};
use rayon::prelude::*;

/// Fewest pedestrians for which another thread is woken.
const WORTH_WAKING: usize = 64;

/// The visibility masks of windows for each of the first `steps` time steps. A pedestrian attends to itself and to the
/// pedestrians in a square around it with half the side `half_box` (m).
///
/// # Panics
/// If `windows` is empty.
pub fn visibility(windows: &[&Window], steps: usize, half_box: f64) -> Scenes {
    let sizes: Vec<usize> = windows.iter().map(|window| window.len()).collect();
    // On several threads: in a crowd this takes as long as its forecast on a graphics card.
    let of_window = |(window, step): (&Window, usize)| -> Vec<Vec<u32>> {
        let positions = window.positions_at(step);
        let places = SpatialIndex::new(&positions);
        let seen = |seen: &mut Vec<u32>, &position: &Position| {
            seen.clear();
            seen.extend(places.within_box(position, half_box).map(|i| i as u32));
            seen.sort_unstable();
            seen.clone()
        };
        let positions = positions.par_iter().with_min_len(WORTH_WAKING);
        positions.map_init(Vec::new, seen).collect()
    };
    let frames = (0..steps).flat_map(|step| windows.iter().map(move |&window| (window, step)));
    let seen: Vec<_> = frames.collect::<Vec<_>>().into_par_iter().map(of_window).collect();
    Scenes::new(&sizes, seen.into_iter().flatten())
}
