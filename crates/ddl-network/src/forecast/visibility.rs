//! Visibility masks: which pedestrians attend to which.

use crate::backend::Scenes;
use ddl_core::{Position, SpatialIndex, Window, distance};
use rayon::prelude::*;

/// Most others that a pedestrian attends to, so that memory grows in proportion to people: within 10 m only crowds that
/// crush each other have more.
const MOST_SEEN: usize = 1024;
/// Least pedestrians in the part of a thread.
const PART: usize = 64;

/// The visibility masks of windows for each of the first `steps` time steps. A pedestrian attends to itself and to the
/// pedestrians in a square around it with half the side `half_box` (m), the 1,024 nearest of them.
///
/// # Panics
/// If `windows` is empty.
pub fn visibility(windows: &[&Window], steps: usize, half_box: f64) -> Scenes {
    let sizes: Vec<usize> = windows.iter().map(|window| window.len()).collect();
    // On several threads: for 10,000 pedestrians one takes as long as their forecast on a graphics card.
    let of_window = |window: &Window, step: usize| -> Vec<Vec<u32>> {
        let positions = window.positions_at(step);
        let places = SpatialIndex::new(&positions);
        let seen = |seen: &mut Vec<u32>, (i, &position): (usize, &Position)| {
            seen.clear();
            let others = places.within_box(position, half_box).filter(|&j| j != i);
            seen.extend(others.map(|j| j as u32));
            if seen.len() > MOST_SEEN {
                let mut near: Vec<_> = seen.iter().map(|&j| (distance(positions[j as usize], position), j)).collect();
                near.select_nth_unstable_by(MOST_SEEN, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                seen.clear();
                seen.extend(near[..MOST_SEEN].iter().map(|(_, j)| j));
            }
            seen.push(i as u32);
            seen.sort_unstable();
            seen.clone()
        };
        positions.par_iter().enumerate().with_min_len(PART).map_init(Vec::new, seen).collect()
    };
    let size = sizes.iter().sum::<usize>().div_ceil(sizes.len().max(1));
    // The lists of one step at a time are in memory.
    let seen = (0..steps).flat_map(|step| {
        let windows = windows.par_iter().with_min_len(PART.div_ceil(size.max(1)));
        windows.map(|window| of_window(window, step)).collect::<Vec<_>>().into_iter().flatten()
    });
    Scenes::new(&sizes, seen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_core::{OBSERVED, PedestrianId};

    /// More people in one place than anybody attends to, on a spiral, and three who are far from them.
    #[test]
    fn a_crush_is_seen_by_the_nearest_alone() {
        let many = MOST_SEEN + 200;
        let spiral =
            |i: usize| [0.1 * (i as f64).sqrt() * (i as f64).cos(), 0.1 * (i as f64).sqrt() * (i as f64).sin()];
        let places: Vec<Position> = (0..many).map(spiral).chain((0..3).map(|i| [100.0, f64::from(i)])).collect();
        let ids = (0..places.len() as i64).map(PedestrianId).collect();
        let tracks = places.iter().map(|&place| vec![place; OBSERVED]).collect();
        let window = Window::new("square", 0, 1, ids, tracks).unwrap();
        let scenes = visibility(&[&window], 2, 10.0);
        for i in [0, 7, many - 1, many + 1] {
            let seen: Vec<usize> = scenes.pairs(1, i..i + 1).map(|(_, j)| j).collect();
            let mut nearest: Vec<usize> = (0..places.len()).filter(|&j| distance(places[i], places[j]) < 9.0).collect();
            nearest.sort_by(|&a, &b| distance(places[i], places[a]).total_cmp(&distance(places[i], places[b])));
            nearest.truncate(MOST_SEEN + 1);
            nearest.sort_unstable();
            assert_eq!(seen, nearest, "{i}");
        }
    }
}
