//! Exact search for the nearest candidates in the normalised soft-DTW distance.

use crate::error::{SearchError, SoftDtwError};
use crate::sieve::CandidateSieve;
use crate::value::{SoftDtw, check, finite, normalise};
use ddl_simd::Dispatch;
use rayon::prelude::*;

/// A candidate found by a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Position of the candidate in the list the index was built from, from 0.
    pub index: usize,
    /// Normalised soft-DTW distance to the query, in the unit of the cost, evaluated in `f64`; exactly 0 for a
    /// candidate that equals the query.
    pub distance: f64,
}

/// Candidates prepared for repeated search; a step has `D` components.
#[derive(Clone, Debug)]
pub struct SearchIndex<const D: usize> {
    dtw: SoftDtw,
    /// All steps of all candidates in `f64`, candidate by candidate.
    steps: Vec<[f64; D]>,
    /// Index in `steps` at which candidate i begins; one more entry for the end of the last.
    offsets: Vec<usize>,
    self_values: Vec<f64>,
    sieve: Option<CandidateSieve<D>>,
}

impl<const D: usize> SearchIndex<D> {
    /// Prepares `candidates` for searches with `dtw`.
    ///
    /// # Shapes
    /// Candidates of at least one step each; their lengths may differ.
    ///
    /// # Errors
    /// [`SearchError::NoCandidates`] for an empty list, [`SearchError::Candidate`] for a candidate that is empty, not
    /// finite, or whose D(y, y) exceeds the range of `f64`.
    pub fn build<S>(dtw: &SoftDtw, candidates: &[S]) -> Result<Self, SearchError>
    where
        S: AsRef<[[f64; D]]>,
    {
        if candidates.is_empty() {
            return Err(SearchError::NoCandidates);
        }
        let (mut steps, mut offsets) = (Vec::new(), vec![0]);
        for (index, candidate) in candidates.iter().enumerate() {
            let candidate = candidate.as_ref();
            check(candidate, 'y').map_err(|source| SearchError::Candidate { index, source })?;
            steps.extend_from_slice(candidate);
            offsets.push(steps.len());
        }
        let mut index = Self { dtw: *dtw, steps, offsets, self_values: Vec::new(), sieve: None };
        index.self_values = index.evaluate_self_values()?;
        if dtw.gamma > 0.0 {
            let candidates: Vec<_> = (0..index.len()).map(|i| index.candidate(i)).collect();
            index.sieve = CandidateSieve::build(dtw.gamma, &candidates, &index.self_values);
        }
        Ok(index)
    }

    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Always false: an index has at least one candidate.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The `n` candidates nearest to `query` (all of them when there are fewer), nearest first, ties by index.
    ///
    /// # Shapes
    /// `query`: at least one step of `D` components, of any length.
    ///
    /// # Errors
    /// [`SearchError::Query`] when the query is empty or not finite, or a distance to be returned leaves the range of
    /// `f64`.
    pub fn nearest(&self, query: &[[f64; D]], n: usize) -> Result<Vec<Neighbour>, SearchError> {
        Ok(self.search(query, n)?)
    }

    /// [`SearchIndex::nearest`] for many queries, in parallel on the current `rayon` pool. The result does not depend
    /// on the number of threads.
    ///
    /// # Errors
    /// [`SearchError::BatchQuery`] for the first query that is not valid.
    pub fn nearest_batch<S>(&self, queries: &[S], n: usize) -> Result<Vec<Vec<Neighbour>>, SearchError>
    where
        S: AsRef<[[f64; D]]> + Sync,
    {
        // Collected first, because a parallel collect into a `Result` could return the error of any query.
        let of_queries: Vec<_> = queries.par_iter().map(|query| self.search(query.as_ref(), n)).collect();
        let of_queries = of_queries.into_iter().enumerate();
        of_queries
            .map(|(index, neighbours)| neighbours.map_err(|source| SearchError::BatchQuery { index, source }))
            .collect()
    }

    fn search(&self, query: &[[f64; D]], n: usize) -> Result<Vec<Neighbour>, SoftDtwError> {
        check(query, 'x')?;
        let wanted = n.min(self.len());
        let sieve = self.sieve.as_ref().filter(|_| wanted > 0 && wanted < self.len());
        let survivors = sieve.and_then(|sieve| sieve.survivors(Dispatch::detect(), query, wanted));
        self.rank(query, &survivors.unwrap_or_else(|| (0..self.len()).collect()), wanted)
    }

    /// The `wanted` nearest of the candidates at `indices`, nearest first, ties by index.
    fn rank(&self, query: &[[f64; D]], indices: &[usize], wanted: usize) -> Result<Vec<Neighbour>, SoftDtwError> {
        if wanted == 0 {
            return Ok(Vec::new());
        }
        let self_query = self.dtw.self_value(query);
        let neighbour = |&index: &usize| {
            let value = self.dtw.value_unchecked(query, self.candidate(index));
            let distance = normalise(value, self_query, self.self_values[index]);
            Neighbour { index, distance }
        };
        let mut neighbours: Vec<_> = indices.iter().map(neighbour).collect();
        keep_nearest(&mut neighbours, wanted);
        for neighbour in &neighbours {
            finite(neighbour.distance)?;
        }
        Ok(neighbours)
    }

    /// D(y, y) of all candidates.
    fn evaluate_self_values(&self) -> Result<Vec<f64>, SearchError> {
        let value = |index| finite(self.dtw.self_value(self.candidate(index)));
        let values: Vec<_> = (0..self.len()).into_par_iter().map(value).collect();
        let values = values.into_iter().enumerate();
        values.map(|(index, value)| value.map_err(|source| SearchError::Candidate { index, source })).collect()
    }

    fn candidate(&self, index: usize) -> &[[f64; D]] {
        &self.steps[self.offsets[index]..self.offsets[index + 1]]
    }
}

/// Keeps only the `wanted` nearest (all if there are fewer), sorted, ties by index.
fn keep_nearest(neighbours: &mut Vec<Neighbour>, wanted: usize) {
    let order = |a: &Neighbour, b: &Neighbour| a.distance.total_cmp(&b.distance).then(a.index.cmp(&b.index));
    if wanted < neighbours.len() {
        neighbours.select_nth_unstable_by(wanted, order);
        neighbours.truncate(wanted);
    }
    neighbours.sort_unstable_by(order);
}
