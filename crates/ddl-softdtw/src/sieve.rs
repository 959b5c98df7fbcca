//! The sieve of a search: `f32` scores that rule out nearly every candidate, and rule out none wrongly.

use crate::lanes::{LANES, Lanes};
fn scores<const D: usize>(
    _q: &[[f32; D]],
    _b: &[[Lanes; D]],
    _s: &Lanes,
    _r: &mut Vec<Lanes>,
) -> Lanes {
    [0.0; LANES]
}
use crate::range::Range;
use crate::select::Selection;

/// The candidates in `f32`, scaled and shifted, sixteen to a block.
#[derive(Clone, Debug)]
pub(crate) struct Sieve<const D: usize> {
    /// √(log2 e / γ): squared differences are then costs in log2 units.
    scale: f64,
    /// Mean of all steps, subtracted before rounding: differences do not notice, the rounding error does.
    shift: [f64; D],
    /// Largest absolute value among the scaled and shifted components.
    largest: f64,
    /// Steps of the longest candidate.
    longest: usize,
    blocks: Vec<Block>,
    samples: Vec<[Lanes; D]>,
}

/// Up to sixteen candidates of one length.
#[derive(Clone, Debug)]
struct Block {
    /// First step of the block in `samples`.
    first: usize,
    steps: usize,
    /// Candidates in the lanes, in order; free lanes follow.
    members: Vec<usize>,
    /// 2^(D(y, y) / 2) with D in log2 units, 0 in free lanes: the normalisation, as a start value.
    weights: Lanes,
}

impl<const D: usize> Sieve<D> {
    /// The sieve of candidates of known D(y, y), or `None` when `f32` cannot hold them whatever the query.
    pub(crate) fn build(
        gamma: f64,
        candidates: &[&[[f64; D]]],
        self_values: &[f64],
    ) -> Option<Self> {
        let scale = (std::f64::consts::LOG2_E / gamma).sqrt();
        let steps = || candidates.iter().flat_map(|candidate| candidate.iter());
        let count = steps().count() as f64;
        let shift = std::array::from_fn(|d| steps().map(|step| step[d] / count).sum());
        let longest = candidates.iter().map(|candidate| candidate.len()).max()?;
        let mut sieve = Self {
            scale,
            shift,
            largest: 0.0,
            longest,
            blocks: Vec::new(),
            samples: Vec::new(),
        };
        sieve.largest = sieve.largest_of(steps());
        let range = Range::of(1, longest)?;
        range.margin_log2(f64::from(range.start_log2()), sieve.largest, D)?;

        let mut order: Vec<usize> = (0..candidates.len()).collect();
        order.sort_by_key(|&i| candidates[i].len());
        for same_length in order.chunk_by(|&a, &b| candidates[a].len() == candidates[b].len()) {
            for members in same_length.chunks(LANES) {
                sieve.push_block(candidates, self_values, members);
            }
        }
        Some(sieve)
    }

    fn push_block(&mut self, candidates: &[&[[f64; D]]], self_values: &[f64], members: &[usize]) {
        let (first, steps) = (self.samples.len(), candidates[members[0]].len());
        self.samples.resize(first + steps, [[0.0; LANES]; D]);
        let mut weights = [0.0; LANES];
        for (lane, &member) in members.iter().enumerate() {
            for (step, sample) in candidates[member].iter().zip(&mut self.samples[first..]) {
                let narrow = narrow(step, &self.shift, self.scale);
                sample
                    .iter_mut()
                    .zip(narrow)
                    .for_each(|(lanes, value)| lanes[lane] = value);
            }
            let half_log2 = self_values[member] * self.scale * self.scale / 2.0;
            weights[lane] = half_log2.exp2() as f32;
        }
        self.blocks.push(Block {
            first,
            steps,
            members: members.to_vec(),
            weights,
        });
    }

    /// Candidates that may be among the `wanted` nearest, or `None` when `f32` cannot tell.
    pub(crate) fn survivors(&self, query: &[[f64; D]], wanted: usize) -> Option<Vec<usize>> {
        let range = Range::of(query.len(), self.longest)?;
        let largest = self.largest.max(self.largest_of(query.iter()));
        let widest = range.margin_log2(range.smallest_accurate_log2(), largest, D)?;
        let mut selection = Selection::new(wanted, widest);
        self.each_block(query, range, |members, scores| {
            let threshold = selection.threshold();
            if scores.iter().any(|&score| score >= threshold) {
                for (&candidate, score) in members.iter().zip(scores) {
                    selection.offer(score, candidate);
                }
            }
        });
        let nth_log2 = f64::from(selection.nth()?).log2();
        if nth_log2 < range.smallest_accurate_log2() {
            return None;
        }
        let margin = range.margin_log2(nth_log2, largest, D)?;
        Some(
            selection
                .finish(margin)
                .iter()
                .map(|scored| scored.candidate)
                .collect(),
        )
    }

    /// Scores of all candidates, a block at a time: 2^(`start_log2` − D(x, y) + D(y, y) / 2) with D in log2 units.
    #[inline]
    fn each_block(&self, query: &[[f64; D]], range: Range, mut visit: impl FnMut(&[usize], Lanes)) {
        let query: Vec<[f32; D]> = query
            .iter()
            .map(|step| narrow(step, &self.shift, self.scale))
            .collect();
        let start = f32::from(range.start_log2()).exp2();
        let mut row = Vec::new();
        for block in &self.blocks {
            let samples = &self.samples[block.first..block.first + block.steps];
            let start = block.weights.map(|weight| weight * start);
            visit(&block.members, scores(&query, samples, &start, &mut row));
        }
    }

    fn largest_of<'a>(&self, steps: impl Iterator<Item = &'a [f64; D]>) -> f64 {
        let components = steps.flat_map(|step| step.iter().zip(&self.shift));
        components
            .map(|(v, s)| ((v - s) * self.scale).abs())
            .fold(0.0, f64::max)
    }
}

/// A step shifted, scaled and rounded to `f32`.
fn narrow<const D: usize>(step: &[f64; D], shift: &[f64; D], scale: f64) -> [f32; D] {
    std::array::from_fn(|d| ((step[d] - shift[d]) * scale) as f32)
}

#[cfg(test)]
mod tests {
    use super::Sieve;
    use crate::range::Range;
    use crate::{Cost, SoftDtw};

    /// Velocities around a few walking directions, some of them nearly standing.
    fn walks(count: usize, steps: usize, offset: f64) -> Vec<Vec<[f64; 2]>> {
        let walk = |i: usize| {
            let (sin, cos) = (0.7 * i as f64).sin_cos();
            let speed = 0.013 * (i % 120) as f64;
            let sway = |j: usize| 0.2 * ((i * 31 + j * 17) as f64).sin() * speed;
            (0..steps)
                .map(|j| [speed * cos + sway(j) + offset, speed * sin - sway(j)])
                .collect()
        };
        (0..count).map(walk).collect()
    }

    fn sieve(gamma: f64, walks: &[Vec<[f64; 2]>]) -> (SoftDtw, Vec<f64>, Option<Sieve<2>>) {
        let dtw = SoftDtw::new(gamma, Cost::SquaredEuclidean).expect("valid");
        let own: Vec<f64> = walks.iter().map(|walk| dtw.self_value(walk)).collect();
        let slices: Vec<&[[f64; 2]]> = walks.iter().map(Vec::as_slice).collect();
        let sieve = Sieve::build(gamma, &slices, &own);
        (dtw, own, sieve)
    }

    #[test]
    fn scores_keep_their_error_bound() {
        let mut worst = 0.0_f64;
        for (steps, gamma) in [(7, 1.0), (8, 1.0), (8, 0.2), (20, 1.0), (3, 0.05)] {
            let walks = walks(500, steps, 0.0);
            let (dtw, own, sieve) = sieve(gamma, &walks);
            let sieve = sieve.expect("fits f32");
            let range = Range::of(steps, steps).expect("short");
            let query = &walks[123];
            let largest = sieve.largest.max(sieve.largest_of(query.iter()));
            let mut accurate = 0;
            sieve.each_block(query, range, |members, scores| {
                for (&candidate, score) in members.iter().zip(scores) {
                    let score = f64::from(score).log2();
                    if score < range.smallest_accurate_log2() {
                        continue;
                    }
                    let value =
                        dtw.value_unchecked(query, &walks[candidate]) - own[candidate] / 2.0;
                    let exact = f64::from(range.start_log2()) - value * sieve.scale * sieve.scale;
                    let share = (score - exact).abs() / range.error_log2(score, largest, 2);
                    worst = worst.max(share);
                    accurate += 1;
                }
            });
            assert!(
                accurate > 100,
                "only {accurate} scores are accurate: {steps} steps, {gamma}"
            );
        }
        assert!(worst < 1.0, "an error {worst} times its bound");
        assert!(worst > 1e-3, "the bound is far too wide: {worst}");
    }

    #[test]
    fn few_survive_where_f32_can_tell_and_nothing_is_decided_where_it_cannot() {
        let near = walks(4000, 8, 0.0);
        let sieve_of_near = sieve(1.0, &near).2.expect("fits f32");
        let survivors = sieve_of_near.survivors(&near[7], 100).expect("near");
        assert!((100..400).contains(&survivors.len()), "{}", survivors.len());
        assert!(survivors.contains(&7));
        // The hundred nearest are too far for the range, and gamma is too small for the data.
        assert!(sieve_of_near.survivors(&walks(1, 8, 6.0)[0], 100).is_none());
        assert!(sieve(1e-13, &near).2.is_none());
        // A common offset is no obstacle: it is subtracted before rounding.
        let offset = walks(4000, 8, 1e5);
        let sieve_of_offset = sieve(1.0, &offset).2.expect("fits f32");
        assert!(sieve_of_offset.survivors(&offset[7], 100).is_some());
    }
}
