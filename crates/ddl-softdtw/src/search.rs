//! Exact search for the nearest candidates in the normalised soft-DTW distance.

use rayon::prelude::*;

use crate::cost::Cost;
use crate::error::{SearchError, SequenceRole, SoftDtwError};
use crate::sieve::Sieve;
use crate::value::{SoftDtw, check, finite, normalise};

/// A candidate found by a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Position of the candidate in the list the index was built from, from 0.
    pub index: usize,
    /// Normalised soft-DTW distance to the query, in the unit of the cost, evaluated in `f64`.
    pub distance: f64,
}

/// Candidates prepared for repeated search; `D` components a step.
///
/// # Examples
/// ```
/// use ddl_softdtw::{Cost, SearchIndex, SoftDtw};
/// let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean)?;
/// let candidates = [vec![[0.0], [0.0]], vec![[1.0], [2.0]], vec![[5.0], [5.0]]];
/// let index = SearchIndex::build(&dtw, &candidates)?;
/// let nearest = index.nearest(&[[1.0], [1.9]], 2)?;
/// assert_eq!(nearest[0].index, 1);
/// assert!(nearest[0].distance <= nearest[1].distance);
/// # Ok::<(), ddl_softdtw::SearchError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SearchIndex<const D: usize> {
    dtw: SoftDtw,
    /// All steps of all candidates in f64, one candidate after the other.
    steps: Vec<[f64; D]>,
    /// Where candidate i begins in `steps`; one more entry ends the last.
    offsets: Vec<usize>,
    /// D(y, y) of every candidate.
    self_values: Vec<f64>,
    sieve: Option<Sieve<D>>,
}

impl<const D: usize> SearchIndex<D> {
    /// Prepares `candidates` for searches with `dtw`.
    ///
    /// # Shapes
    /// Candidates of at least one step each; their lengths may differ.
    ///
    /// # Errors
    /// [`SearchError::NoCandidates`] for an empty list, [`SearchError::Candidate`] for an empty candidate, one that is not
    /// finite or whose D(y, y) cannot be represented.
    pub fn build<S>(dtw: &SoftDtw, candidates: &[S]) -> Result<Self, SearchError>
    where
        S: AsRef<[[f64; D]]> + Sync,
    {
        if candidates.is_empty() {
            return Err(SearchError::NoCandidates);
        }
        let checked_self_value = |candidate: &S| {
            check(candidate.as_ref(), SequenceRole::Y)?;
            finite(dtw.self_value(candidate.as_ref()))
        };
        // Collected first: a parallel collect into a Result would report whichever error came first in time.
        let self_values: Vec<_> = candidates.par_iter().map(checked_self_value).collect();
        let self_values = self_values
            .into_iter()
            .enumerate()
            .map(|(index, value)| value.map_err(|source| SearchError::Candidate { index, source }))
            .collect::<Result<Vec<_>, _>>()?;
        let mut steps = Vec::new();
        let mut offsets = vec![0];
        for candidate in candidates {
            steps.extend_from_slice(candidate.as_ref());
            offsets.push(steps.len());
        }
        let mut index = Self {
            dtw: *dtw,
            steps,
            offsets,
            self_values,
            sieve: None,
        };
        if dtw.gamma() > 0.0 && dtw.cost() == Cost::SquaredEuclidean && dtw.band().is_none() {
            let candidates: Vec<_> = (0..index.len()).map(|i| index.candidate(i)).collect();
            index.sieve = Sieve::build(dtw.gamma(), &candidates, &index.self_values);
        }
        Ok(index)
    }

    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.self_values.len()
    }

    /// Never true: an index without candidates cannot be built.
    pub fn is_empty(&self) -> bool {
        self.self_values.is_empty()
    }

    /// The distance that is searched in.
    pub fn soft_dtw(&self) -> SoftDtw {
        self.dtw
    }

    /// The `n` candidates nearest to `query` (all of them when there are fewer), nearest first, ties by index.
    ///
    /// # Errors
    /// [`SearchError::Query`] when the query is empty or not finite, or when a distance to be returned leaves the range of
    /// `f64`.
    pub fn nearest(&self, query: &[[f64; D]], n: usize) -> Result<Vec<Neighbour>, SearchError> {
        Ok(self.search(query, n)?)
    }

    /// [`SearchIndex::nearest`] for many queries, in parallel over the current `rayon` pool.
    ///
    /// The result does not depend on the number of threads.
    ///
    /// # Errors
    /// [`SearchError::BatchQuery`] for the first query that is not valid.
    pub fn nearest_batch<S>(
        &self,
        queries: &[S],
        n: usize,
    ) -> Result<Vec<Vec<Neighbour>>, SearchError>
    where
        S: AsRef<[[f64; D]]> + Sync,
    {
        let found: Vec<_> = queries
            .par_iter()
            .map(|q| self.search(q.as_ref(), n))
            .collect();
        found
            .into_iter()
            .enumerate()
            .map(|(index, found)| found.map_err(|source| SearchError::BatchQuery { index, source }))
            .collect()
    }

    fn search(&self, query: &[[f64; D]], n: usize) -> Result<Vec<Neighbour>, SoftDtwError> {
        check(query, SequenceRole::X)?;
        let self_query = finite(self.dtw.self_value(query))?;
        let wanted = n.min(self.len());
        if wanted == 0 {
            return Ok(Vec::new());
        }
        let sieve = self.sieve.as_ref().filter(|_| wanted < self.len());
        let survivors = sieve
            .and_then(|sieve| sieve.survivors(query, wanted))
            .unwrap_or_else(|| (0..self.len()).collect());
        let mut found: Vec<Neighbour> = survivors
            .into_iter()
            .map(|index| {
                let value = self.dtw.value_unchecked(query, self.candidate(index));
                let distance = normalise(value, self_query, self.self_values[index]);
                Neighbour { index, distance }
            })
            .collect();
        let order = |a: &Neighbour, b: &Neighbour| {
            a.distance
                .total_cmp(&b.distance)
                .then(a.index.cmp(&b.index))
        };
        if wanted < found.len() {
            found.select_nth_unstable_by(wanted, order);
            found.truncate(wanted);
        }
        found.sort_unstable_by(order);
        found
            .iter()
            .try_for_each(|neighbour| finite(neighbour.distance).map(|_| ()))?;
        Ok(found)
    }

    fn candidate(&self, index: usize) -> &[[f64; D]] {
        &self.steps[self.offsets[index]..self.offsets[index + 1]]
    }
}
