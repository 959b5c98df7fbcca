//! Exact search for the nearest among all windows of many tracks.

mod accuracy;
mod column;
mod error;
mod hits;
mod kernel;
mod layout;
mod sieve;
mod window;

use rayon::prelude::*;

use crate::decision::{Candidates, Neighbour, self_values};
use crate::error::{SequenceRole, SoftDtwError};
use crate::refine::PairValues;
use crate::value::{SoftDtw, check, finite};
use ddl_simd::{Dispatch, InstructionSet};

pub use error::SlidingError;
use layout::WindowLayout;
use sieve::WindowSieve;
pub use window::WindowNeighbour;
use window::{WindowPlace, places_of, running_sums};

/// Number of windows of a query that are searched together; a longer query is split.
const QUERY_WINDOWS: usize = 64;

/// All windows of one length of many tracks, prepared for repeated search; a step has `D` components.
///
/// The candidates are all windows of `length` consecutive steps of longer tracks. Neighbouring windows share most of
/// their computation. For all windows of a query track ([`SlidingIndex::nearest_windows`]) both sides share it, for a
/// single window ([`SlidingIndex::nearest`]) only the candidates do. The result is that of a
/// [`SearchIndex`](crate::SearchIndex) of the same windows, many times faster.
///
/// # Numerics
/// Set, order and distances are computed in `f64`. The relative error of the sum over the paths is below 1e-12 (2e-12
/// for windows of 180 steps). Results are exact up to ties within that error times γ, and do not depend on the number
/// of threads or the instruction set.
#[derive(Clone, Debug)]
pub struct SlidingIndex<const D: usize> {
    dtw: SoftDtw,
    length: usize,
    /// All steps of all tracks in `f64`, track by track.
    steps: Vec<[f64; D]>,
    first_steps: Vec<usize>,
    places: Vec<WindowPlace>,
    self_values: Vec<f64>,
    sieve: Option<WindowSieve<D>>,
    dispatch: Dispatch,
}

impl<const D: usize> SlidingIndex<D> {
    /// Prepares all windows of `length` steps that are followed by at least `min_following_steps` more steps of
    /// their track.
    ///
    /// # Shapes
    /// Tracks of any length: shorter ones than `length + min_following_steps` have no window.
    ///
    /// # Errors
    /// `length` is 0, no track has a window, or a track is not finite.
    pub fn build<T>(
        dtw: &SoftDtw,
        tracks: &[T],
        length: usize,
        min_following_steps: usize,
    ) -> Result<Self, SlidingError>
    where
        T: AsRef<[[f64; D]]> + Sync,
    {
        if length == 0 {
            return Err(SlidingError::EmptyWindow);
        }
        let tracks: Vec<&[[f64; D]]> = tracks.iter().map(AsRef::as_ref).collect();
        for (index, track) in tracks.iter().enumerate() {
            if !track.is_empty() {
                check(track, SequenceRole::Y).map_err(|source| SlidingError::Track { index, source })?;
            }
        }
        let windows = |track: &&[[f64; D]]| {
            let needed = length.saturating_add(min_following_steps);
            (track.len() + 1).saturating_sub(needed)
        };
        let windows: Vec<usize> = tracks.iter().map(windows).collect();
        let places: Vec<_> = windows.iter().enumerate().flat_map(places_of).collect();
        if places.is_empty() {
            return Err(SlidingError::NoWindows {
                tracks: tracks.len(),
                length,
                min_following_steps,
            });
        }
        let mut index = Self {
            dtw: *dtw,
            length,
            steps: tracks.concat(),
            first_steps: running_sums(tracks.iter().map(|track| track.len())),
            places,
            self_values: Vec::new(),
            sieve: None,
            dispatch: Dispatch::detect(),
        };
        index.self_values = index.own_values()?;
        if dtw.suits_lanes() {
            let layout = WindowLayout::new(dtw.gamma(), &tracks, &windows, length, &index.self_values);
            index.sieve = WindowSieve::new(layout);
        }
        Ok(index)
    }

    /// Sets another instruction set than the fastest of the machine.
    ///
    /// # Errors
    /// [`SlidingError::InstructionSet`] if the machine lacks the instruction set.
    pub fn with_instruction_set(mut self, set: InstructionSet) -> Result<Self, SlidingError> {
        self.dispatch = Dispatch::new(set).ok_or(SlidingError::InstructionSet { set })?;
        Ok(self)
    }

    /// The instruction set of the searches.
    pub fn instruction_set(&self) -> InstructionSet {
        self.dispatch.instruction_set()
    }

    /// Number of windows.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Always false: an index has at least one window.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Steps of a window.
    pub fn window_length(&self) -> usize {
        self.length
    }

    /// The distance of the search.
    pub fn soft_dtw(&self) -> SoftDtw {
        self.dtw
    }

    /// The `n` windows nearest to the window `query` (all if there are fewer), nearest first, ties by track and offset.
    ///
    /// # Errors
    /// The query is not finite or does not have the length of a window, or a distance to be returned exceeds the range
    /// of `f64`.
    pub fn nearest(&self, query: &[[f64; D]], n: usize) -> Result<Vec<WindowNeighbour>, SlidingError> {
        if query.len() != self.length {
            return Err(SlidingError::QueryLength {
                found: query.len(),
                length: self.length,
            });
        }
        let mut found = self.search_track(query, n).map_err(SlidingError::Query)?;
        Ok(found.pop().unwrap_or_default())
    }

    /// For every window of the track `query`, from its first step on, the `n` windows nearest to it.
    ///
    /// The result is empty for a query shorter than a window.
    ///
    /// # Errors
    /// As [`SlidingIndex::nearest`].
    pub fn nearest_windows(&self, query: &[[f64; D]], n: usize) -> Result<Vec<Vec<WindowNeighbour>>, SlidingError> {
        self.search_track(query, n).map_err(SlidingError::Query)
    }

    /// [`SlidingIndex::nearest_windows`] for many tracks, in parallel over the current `rayon` pool.
    ///
    /// # Errors
    /// [`SlidingError::BatchQuery`] for the first track that is not valid.
    pub fn nearest_windows_batch<T>(
        &self,
        queries: &[T],
        n: usize,
    ) -> Result<Vec<Vec<Vec<WindowNeighbour>>>, SlidingError>
    where
        T: AsRef<[[f64; D]]> + Sync,
    {
        // Collected first, because a parallel collect into a `Result` could return the error of any query.
        let found: Vec<_> = queries
            .par_iter()
            .map(|query| self.search_track(query.as_ref(), n))
            .collect();
        found
            .into_iter()
            .enumerate()
            .map(|(index, found)| found.map_err(|source| SlidingError::BatchQuery { index, source }))
            .collect()
    }

    fn search_track(&self, query: &[[f64; D]], n: usize) -> Result<Vec<Vec<WindowNeighbour>>, SoftDtwError> {
        if !query.is_empty() {
            check(query, SequenceRole::X)?;
        }
        let windows = (query.len() + 1).saturating_sub(self.length);
        let starts: Vec<usize> = (0..windows).step_by(QUERY_WINDOWS).collect();
        let part = |&start: &usize| {
            let windows = QUERY_WINDOWS.min(windows - start);
            self.search(&query[start..start + windows + self.length - 1], n)
        };
        let found: Vec<_> = starts.par_iter().map(part).collect();
        let mut all = Vec::with_capacity(windows);
        for found in found {
            all.append(&mut found?);
        }
        Ok(all)
    }

    fn search(&self, query: &[[f64; D]], n: usize) -> Result<Vec<Vec<WindowNeighbour>>, SoftDtwError> {
        let windows: Vec<_> = query.windows(self.length).collect();
        let wanted = n.min(self.len());
        if wanted == 0 {
            return Ok(vec![Vec::new(); windows.len()]);
        }
        let sieve = self.sieve.as_ref().filter(|_| wanted < self.len());
        let survivors = match sieve {
            Some(sieve) => sieve.survivors(self.dispatch, query, wanted),
            None => vec![None; windows.len()],
        };
        let pairs: Vec<_> = windows.iter().map(|&window| (window, window)).collect();
        let own = self.pair_values().all(&pairs);
        let candidates = Candidates {
            values: self.pair_values(),
            sequence: |window| self.window(window),
            self_values: &self.self_values,
        };
        let mut found = Vec::with_capacity(windows.len());
        for ((window, survivors), own) in windows.into_iter().zip(survivors).zip(own) {
            let survivors = survivors.unwrap_or_else(|| (0..self.len()).collect());
            let nearest = candidates.nearest(window, finite(own)?, &survivors, wanted)?;
            found.push(nearest.iter().map(|found| self.window_neighbour(found)).collect());
        }
        Ok(found)
    }

    fn pair_values(&self) -> PairValues {
        PairValues::new(self.dtw, self.dispatch)
    }

    fn own_values(&self) -> Result<Vec<f64>, SlidingError> {
        let values = self_values(&self.pair_values(), self.len(), |window| self.window(window));
        match values.iter().position(|value| !value.is_finite()) {
            None => Ok(values),
            Some(window) => Err(SlidingError::Track {
                index: self.places[window].track,
                source: SoftDtwError::Overflow,
            }),
        }
    }

    /// Track and offset of a window. Windows are numbered in this order, so ties are broken by track and offset.
    fn window_neighbour(&self, found: &Neighbour) -> WindowNeighbour {
        let WindowPlace { track, offset } = self.places[found.index];
        WindowNeighbour {
            track,
            offset,
            distance: found.distance,
        }
    }

    fn window(&self, window: usize) -> &[[f64; D]] {
        let WindowPlace { track, offset } = self.places[window];
        &self.steps[self.first_steps[track] + offset..][..self.length]
    }
}
