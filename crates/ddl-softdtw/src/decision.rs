//! The final selection among the candidates of a sieve, in `f64`: the set, its order and the distances.

use rayon::prelude::*;

use crate::error::SoftDtwError;
use crate::refine::{PairValue, PairValues};
use crate::value::{finite, normalise};

/// A candidate found by a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Position of the candidate in the list the index was built from, from 0.
    pub index: usize,
    /// Normalised soft-DTW distance to the query, in the unit of the cost, evaluated in `f64`; exactly 0 for a
    /// candidate that equals the query.
    pub distance: f64,
}

#[derive(Clone, Copy)]
pub(crate) struct Candidates<'a, F> {
    pub(crate) values: PairValues,
    pub(crate) sequence: F,
    pub(crate) self_values: &'a [f64],
}

impl<F> Candidates<'_, F> {
    /// The `wanted` nearest of the candidates at `indices`, nearest first, ties by index. `self_query` is D(x, x).
    pub(crate) fn nearest<'y, const D: usize>(
        &self,
        query: &[[f64; D]],
        self_query: f64,
        indices: &[usize],
        wanted: usize,
    ) -> Result<Vec<Neighbour>, SoftDtwError>
    where
        F: Fn(usize) -> &'y [[f64; D]],
    {
        let neighbour = |index: usize, value: f64| Neighbour {
            index,
            distance: normalise(value, self_query, self.self_values[index]),
        };
        let pairs = indices.iter().map(|&index| (query, (self.sequence)(index)));
        let (mut found, mut beyond) = (Vec::with_capacity(indices.len()), Vec::new());
        for (&index, value) in indices.iter().zip(self.values.of(pairs)) {
            match value {
                PairValue::Known(value) => found.push(neighbour(index, value)),
                PairValue::AtLeast(bound) => beyond.push(neighbour(index, bound)),
            }
        }
        nearest_first(&mut found, wanted);
        if let Some(last) = wanted.checked_sub(1).and_then(|last| found.get(last)) {
            let last = last.distance;
            beyond.retain(|at_least| at_least.distance <= last);
        }
        if !beyond.is_empty() {
            found.extend(
                beyond.iter().map(|&Neighbour { index, .. }| {
                    neighbour(index, self.values.beyond(query, (self.sequence)(index)))
                }),
            );
            nearest_first(&mut found, wanted);
        }
        found
            .iter()
            .try_for_each(|neighbour| finite(neighbour.distance).map(|_| ()))?;
        Ok(found)
    }
}

/// D(y, y) of `count` candidates, computed like the values in [`nearest`], so that equal sequences have distance 0.
pub(crate) fn self_values<'y, const D: usize>(
    values: &PairValues,
    count: usize,
    sequence: impl Fn(usize) -> &'y [[f64; D]] + Sync,
) -> Vec<f64> {
    let indices: Vec<usize> = (0..count).collect();
    let chunks = indices.par_chunks(1024).flat_map(|indices| {
        let pairs = indices.iter().map(|&index| (sequence(index), sequence(index)));
        values.all(&pairs.collect::<Vec<_>>())
    });
    chunks.collect()
}

/// Keeps only the `wanted` nearest (all if there are fewer), sorted, ties by index.
fn nearest_first(found: &mut Vec<Neighbour>, wanted: usize) {
    let order = |a: &Neighbour, b: &Neighbour| a.distance.total_cmp(&b.distance).then(a.index.cmp(&b.index));
    if wanted < found.len() {
        found.select_nth_unstable_by(wanted, order);
        found.truncate(wanted);
    }
    found.sort_unstable_by(order);
}
