//! Values and gradients of one sequence against many.

use crate::blocks::{BlockRun, Blocks, FREE};
use crate::error::{SearchError, SequenceRole, SoftDtwError};
use crate::range::{Range, floor};
use crate::value::{SoftDtw, check};
use ddl_simd::{Dispatch, InstructionSet, LANES, WIDE_LANES};
use forward_backward::{ForwardBackward, Working};
use wide::{Visit, WidePairs};

mod forward_backward;
mod wide;

/// Largest proven error of log2 of a score that is accepted in `f32`. Pairs with a larger error are evaluated in `f64`.
const WIDEST_ERROR: f64 = 2e-4;

/// Sequences y prepared for `D_γ(x, y)` and its gradient with respect to x, for many x in succession, as for
/// barycentres and losses.
///
/// # Numerics
/// Sixteen pairs at once in `f32`, for γ > 0 and the squared cost. The proven error of a value is at most 1.4e-4 γ; for
/// velocities of pedestrians (γ = 1 m²/s², eight steps) values and gradients are within 1e-5 of those of [`SoftDtw`].
/// Pairs are evaluated in `f64` if their value is above about 57 γ (39 γ without fused multiplication), if a sequence
/// has more than 32 steps, or if it is too large for the bound. [`SoftDtw`] evaluates pairs above about 570 γ or 180
/// steps, and all pairs with a band, with the Euclidean cost or with γ = 0.
///
/// Everything runs on the calling thread. The last bits of a pair depend on the instruction set and on the other
/// sequences.
#[derive(Clone, Debug)]
pub struct SoftDtwBatch<const D: usize> {
    dtw: SoftDtw,
    sequences: Vec<Vec<[f64; D]>>,
    blocks: Option<Blocks<D>>,
    dispatch: Dispatch,
}

/// Values and gradients of one x against every sequence of a [`SoftDtwBatch`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BatchGradients<const D: usize> {
    steps: usize,
    values: Vec<f64>,
    gradients: Vec<[f64; D]>,
}

impl<const D: usize> BatchGradients<D> {
    /// `D_γ(x, y)` for every sequence y, in the order they were given.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The gradient with respect to x for sequence `index`, in the shape of x; `None` when there is no such sequence.
    pub fn gradient(&self, index: usize) -> Option<&[[f64; D]]> {
        let first = index.checked_mul(self.steps)?;
        self.gradients.get(first..first.checked_add(self.steps)?)
    }
}

impl<const D: usize> SoftDtwBatch<D> {
    /// Prepares `sequences` (the y of every pair) for `dtw`.
    ///
    /// # Shapes
    /// Sequences of at least one step each; their lengths may differ.
    ///
    /// # Errors
    /// [`SearchError::NoCandidates`] for an empty list, [`SearchError::Candidate`] for a sequence that is empty or not
    /// finite.
    pub fn build<S>(dtw: &SoftDtw, sequences: &[S]) -> Result<Self, SearchError>
    where
        S: AsRef<[[f64; D]]>,
    {
        if sequences.is_empty() {
            return Err(SearchError::NoCandidates);
        }
        let slices: Vec<&[[f64; D]]> = sequences.iter().map(AsRef::as_ref).collect();
        for (index, sequence) in slices.iter().enumerate() {
            check(sequence, SequenceRole::Y).map_err(|source| SearchError::Candidate { index, source })?;
        }
        let narrow = dtw.suits_lanes();
        Ok(Self {
            dtw: *dtw,
            blocks: narrow.then(|| Blocks::new(dtw.gamma(), &slices)),
            sequences: slices.into_iter().map(<[_]>::to_vec).collect(),
            dispatch: Dispatch::detect(),
        })
    }

    /// Sets another instruction set than the fastest of the machine.
    ///
    /// # Errors
    /// [`SearchError::InstructionSet`] if the machine lacks the instruction set.
    pub fn with_instruction_set(self, set: InstructionSet) -> Result<Self, SearchError> {
        let dispatch = Dispatch::new(set).ok_or(SearchError::InstructionSet { set })?;
        Ok(Self { dispatch, ..self })
    }

    /// Number of sequences.
    pub fn len(&self) -> usize {
        self.sequences.len()
    }

    /// Always false: a batch has at least one sequence.
    pub fn is_empty(&self) -> bool {
        self.sequences.is_empty()
    }

    /// `D_γ(x, y)` and its gradient with respect to `x` for every sequence y.
    ///
    /// # Errors
    /// [`SearchError::Query`] when `x` is empty or not finite, [`SearchError::Candidate`] for a pair whose value or
    /// gradient leaves the range of `f64`.
    pub fn values_and_gradients(&self, x: &[[f64; D]]) -> Result<BatchGradients<D>, SearchError> {
        let mut results = BatchGradients::default();
        self.values_and_gradients_into(x, &mut results)?;
        Ok(results)
    }

    /// [`SoftDtwBatch::values_and_gradients`] into memory that is reused from one x to the next. After an error, the
    /// contents of `results` are unspecified.
    ///
    /// # Errors
    /// As [`SoftDtwBatch::values_and_gradients`].
    pub fn values_and_gradients_into(
        &self,
        x: &[[f64; D]],
        results: &mut BatchGradients<D>,
    ) -> Result<(), SearchError> {
        let steps = x.len();
        results.steps = steps;
        results.values.resize(self.len(), 0.0);
        results.gradients.resize(self.len() * steps, [0.0; D]);
        self.each_pair(x, |index, value, gradient| {
            results.values[index] = value;
            results.gradients[index * steps..][..steps].copy_from_slice(gradient);
        })
    }

    /// `Σ_k w_k D_γ(x, y_k)` and its gradient with respect to `x`: the loss of a barycentre.
    ///
    /// # Shapes
    /// `weights`: one for each sequence.
    ///
    /// # Errors
    /// [`SearchError::Weights`] for a wrong number of weights, [`SearchError::Weight`] for one that is not finite, and
    /// [`SoftDtwError::Overflow`] for a sum that is not finite; otherwise as [`SoftDtwBatch::values_and_gradients`].
    pub fn weighted_sum(&self, x: &[[f64; D]], weights: &[f64]) -> Result<(f64, Vec<[f64; D]>), SearchError> {
        if weights.len() != self.len() {
            return Err(SearchError::Weights {
                weights: weights.len(),
                sequences: self.len(),
            });
        }
        if let Some(index) = weights.iter().position(|weight| !weight.is_finite()) {
            let weight = weights[index];
            return Err(SearchError::Weight { index, weight });
        }
        let (mut sum, mut total) = (0.0_f64, vec![[0.0; D]; x.len()]);
        self.each_pair(x, |index, value, gradient| {
            let weight = weights[index];
            sum += weight * value;
            let components = gradient.as_flattened().iter();
            for (total, component) in total.as_flattened_mut().iter_mut().zip(components) {
                *total += weight * component;
            }
        })?;
        let finite = sum.is_finite() && total.as_flattened().iter().all(|g: &f64| g.is_finite());
        if finite {
            Ok((sum, total))
        } else {
            Err(SoftDtwError::Overflow.into())
        }
    }

    /// Evaluates every pair, in an order that depends only on the inputs.
    fn each_pair(&self, x: &[[f64; D]], mut visit: impl Visit<D>) -> Result<(), SearchError> {
        check(x, SequenceRole::X)?;
        let mut left = Vec::new();
        match &self.blocks {
            Some(blocks) => self.narrow_pairs(blocks, x, &mut left, &mut visit),
            None => left.extend(0..self.len()),
        }
        // Eight pairs of the same length are evaluated together.
        left.sort_by_key(|&index| (self.sequences[index].len(), index));
        let mut beyond = Vec::new();
        let mut wide = WidePairs::new(self.dtw, self.dispatch);
        for run in left.chunk_by(|&a, &b| self.sequences[a].len() == self.sequences[b].len()) {
            for block in run.chunks(WIDE_LANES) {
                wide.evaluate(x, block, &self.sequences, &mut beyond, &mut visit);
            }
        }
        for index in beyond {
            let evaluated = self.dtw.value_and_gradient(x, &self.sequences[index]);
            let (value, gradient) = evaluated.map_err(|source| SearchError::Candidate { index, source })?;
            visit(index, value, &gradient);
        }
        Ok(())
    }

    fn narrow_pairs(&self, blocks: &Blocks<D>, x: &[[f64; D]], left: &mut Vec<usize>, visit: &mut impl Visit<D>) {
        let narrow = blocks.narrowing.narrow(x);
        let largest = blocks.largest.max(blocks.narrowing.largest(x.iter()));
        let slope = 2.0 / blocks.narrowing.scale;
        let mut working = Working::new();
        let mut gradient = vec![[0.0; D]; x.len()];
        for run in &blocks.runs {
            let Some(accurate) = Accurate::new(self.dispatch, x.len(), run, largest, D) else {
                let members = blocks.members[run.blocks.clone()].as_flattened();
                left.extend(members.iter().filter(|&&member| member != FREE));
                continue;
            };
            for block in run.blocks.clone() {
                self.dispatch.run_on_registers(ForwardBackward {
                    x: &narrow,
                    block: blocks.samples(run, &(block..block + 1)),
                    start: accurate.start,
                    seed: accurate.seed,
                    working: &mut working,
                });
                for lane in 0..LANES {
                    let (member, score) = (blocks.members[block][lane], working.scores[lane]);
                    if member == FREE {
                        continue;
                    }
                    if score < accurate.smallest {
                        left.push(member);
                        continue;
                    }
                    // Dividing by a power of two is exact.
                    let value = -self.dtw.gamma() * f64::from(score / accurate.start).ln();
                    for (into, lanes) in gradient.iter_mut().zip(&working.gradient) {
                        for (into, lanes) in into.iter_mut().zip(lanes) {
                            *into = f64::from(lanes.0[lane]) * slope;
                        }
                    }
                    visit(member, value, &gradient);
                }
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Accurate {
    start: f32,
    seed: f32,
    smallest: f32,
}

impl Accurate {
    fn new(dispatch: Dispatch, n: usize, run: &BlockRun, largest: f64, dimension: usize) -> Option<Self> {
        let range = Range::narrow(floor(dispatch), n, run.steps)?;
        let smallest = range.smallest_aligned_log2(n * run.steps);
        let error = range.error_log2(smallest, largest, dimension);
        (error <= WIDEST_ERROR).then(|| Self {
            start: f32::from(range.start_log2()).exp2(),
            seed: f32::from(range.seed_log2()).exp2(),
            smallest: smallest.exp2() as f32,
        })
    }
}

#[cfg(test)]
mod tests;
