//! Positions of windows: a track and the first step in it.

/// A window of a track found by a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowNeighbour {
    /// Position of the track in the list the index was built from, from 0.
    pub track: usize,
    /// First step of the window in its track, from 0.
    pub offset: usize,
    /// Normalised soft-DTW distance to the query, in the unit of the cost, evaluated in `f64`.
    pub distance: f64,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct WindowPlace {
    pub(super) track: usize,
    pub(super) offset: usize,
}

pub(super) fn places_of((track, &windows): (usize, &usize)) -> impl Iterator<Item = WindowPlace> + use<> {
    (0..windows).map(move |offset| WindowPlace { track, offset })
}

/// The sums of the numbers before each of `numbers`, and the total.
pub(super) fn running_sums(numbers: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut sums = vec![0];
    sums.extend(numbers.scan(0, |sum, number| {
        *sum += number;
        Some(*sum)
    }));
    sums
}
