//! Visibility masks: which pedestrians attend to which.

use crate::backend::Scenes;
use ddl_core::{Position, SpatialIndex, Window};
use rayon::prelude::*;

/// Least pedestrians in the part of a thread.
const PART: usize = 64;

/// The visibility masks of windows for each of the first `steps` time steps. A pedestrian attends to itself and to the
/// pedestrians in a square around it with half the side `half_box` (m).
///
/// # Panics
/// If `windows` is empty.
pub fn visibility(windows: &[&Window], steps: usize, half_box: f64) -> Scenes {
    let sizes: Vec<usize> = windows.iter().map(|window| window.len()).collect();
    // On several threads: for 10,000 pedestrians one takes as long as their forecast on a graphics card.
    let of_window = |(window, step): (&Window, usize)| -> Vec<Vec<u32>> {
        let positions = window.positions_at(step);
        let places = SpatialIndex::new(&positions);
        let seen = |seen: &mut Vec<u32>, (i, &position): (usize, &Position)| {
            seen.clear();
            let others = places.within_box(position, half_box).filter(|&j| j != i);
            seen.extend(others.map(|j| j as u32));
            seen.push(i as u32);
            seen.sort_unstable();
            seen.clone()
        };
        positions.par_iter().enumerate().with_min_len(PART).map_init(Vec::new, seen).collect()
    };
    let frames: Vec<_> = (0..steps).flat_map(|step| windows.iter().map(move |&window| (window, step))).collect();
    let size = sizes.iter().sum::<usize>().div_ceil(sizes.len().max(1));
    let seen: Vec<_> = frames.into_par_iter().with_min_len(PART.div_ceil(size.max(1))).map(of_window).collect();
    Scenes::new(&sizes, seen.into_iter().flatten())
}
