//! Scenes in rows of equal length, so that attention among their pedestrians is a batch of small matrices.

use std::cmp::Reverse;
use std::ops::Range;

/// The length of rows is a multiple of this: libtorch's fused attention on CUDA then takes the mask without a copy.
const ALIGNMENT: usize = 8;

/// Places of the pedestrians of several scenes in rows of about the length of the largest scene. Each row holds whole
/// scenes.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Packing {
    rows: usize,
    length: usize,
    /// The place of each pedestrian: `row * length + column`.
    places: Vec<usize>,
}

impl Packing {
    /// Places the scenes, the largest first, each in the first row with enough room.
    pub(crate) fn new(scenes: &[Range<usize>]) -> Self {
        let largest = scenes.iter().map(Range::len).max().unwrap_or(0);
        let length = largest.next_multiple_of(ALIGNMENT);
        let mut order: Vec<&Range<usize>> = scenes.iter().collect();
        order.sort_by_key(|scene| (Reverse(scene.len()), scene.start));
        let mut places = vec![0; scenes.iter().map(Range::len).sum()];
        let mut filled: Vec<usize> = Vec::new();
        for scene in order {
            let row = filled
                .iter()
                .position(|&filled| filled + scene.len() <= length)
                .unwrap_or_else(|| {
                    filled.push(0);
                    filled.len() - 1
                });
            let first = row * length + filled[row];
            filled[row] += scene.len();
            for (pedestrian, place) in scene.clone().zip(first..) {
                places[pedestrian] = place;
            }
        }
        Self {
            rows: filled.len(),
            length,
            places,
        }
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    pub(crate) fn length(&self) -> usize {
        self.length
    }

    pub(crate) fn places(&self) -> &[usize] {
        &self.places
    }

    /// The pedestrian at each place; the first pedestrian at empty places.
    pub(crate) fn pedestrians(&self) -> Vec<usize> {
        let mut pedestrians = vec![0; self.rows * self.length];
        for (pedestrian, &place) in self.places.iter().enumerate() {
            pedestrians[place] = pedestrian;
        }
        pedestrians
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn scenes(sizes: &[usize]) -> Vec<Range<usize>> {
        let mut first = 0;
        let mut ranges = Vec::new();
        for size in sizes {
            ranges.push(first..first + size);
            first += size;
        }
        ranges
    }

    proptest! {
        #[test]
        fn every_pedestrian_has_a_place_and_every_scene_one_row(
            sizes in prop::collection::vec(1_usize..60, 1..40),
        ) {
            let scenes = scenes(&sizes);
            let packing = Packing::new(&scenes);
            let pedestrians: usize = sizes.iter().sum();
            let pedestrian_at = packing.pedestrians();
            prop_assert_eq!(packing.places().len(), pedestrians);
            prop_assert_eq!(pedestrian_at.len(), packing.rows() * packing.length());
            for (pedestrian, &place) in packing.places().iter().enumerate() {
                prop_assert_eq!(pedestrian_at[place], pedestrian);
            }
            for scene in &scenes {
                let places = &packing.places()[scene.clone()];
                prop_assert!(places.windows(2).all(|pair| pair[1] == pair[0] + 1));
                prop_assert_eq!(
                    places[0] / packing.length(),
                    places[places.len() - 1] / packing.length()
                );
            }
            // Any two rows together hold more pedestrians than fit into one row.
            let half_full = packing.rows().saturating_sub(1) * packing.length();
            prop_assert!(half_full < 2 * pedestrians);
        }
    }
}
