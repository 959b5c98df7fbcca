//! The recursion on sixteen candidates at once, in `f32` and the exponential domain.
//!
//! With K = 2^−cost and costs in log2 units, R(i, j) = K(i, j) (R(i−1, j−1) + R(i−1, j) + R(i, j−1)) sums 2^−cost over all
//! warping paths: no exponential and no logarithm in the recursion. Written as plain loops over `[f32; 16]`, which the
//! compiler turns into vector instructions on every target.
//!
//! # Range
//! Costs are clamped to [`COST_LIMIT`] and [`FLOOR`] is added to every sum of three predecessors, so that every product
//! is a normal number: denormal numbers would make the recursion ten times slower for distant candidates. What both do
//! to small scores is bounded in [`crate::range`].

/// Candidates processed together.
pub(crate) const LANES: usize = 16;
/// One number for each of the candidates of a block.
pub(crate) type Lanes = [f32; LANES];

/// Largest cost of a cell, log2 units: a larger one counts as this.
pub(crate) const COST_LIMIT: f32 = 109.0;
/// Added to every sum of predecessors, 2^−16: times 2^−109 it is still a normal number.
pub(crate) const FLOOR: f32 = 1.0 / 65536.0;
/// Bound on the relative error of [`exp2_minus`].
pub(crate) const EXP2_ERROR: f64 = 3e-7;

/// Adding and subtracting 1.5 · 2^23 rounds a small number to an integer, which then sits in the low bits of the sum.
const ROUNDING: f32 = 12_582_912.0;

/// 2^−f on [−1/2, 1/2]: the polynomial of degree 5 with the least largest relative error (Remez exchange, 7.5e-8).
const POLYNOMIAL: [f32; 6] = [
    1.000_000_1,
    -0.693_146_97,
    0.240_221_2,
    -0.055_507_13,
    0.009_675_541,
    -0.001_327_647_2,
];

/// 2^−cost for 0 ≤ cost ≤ [`COST_LIMIT`], to a relative error of [`EXP2_ERROR`].
///
/// cost = k + f with integer k and |f| ≤ 1/2: a polynomial gives 2^−f, and k is subtracted from its exponent.
#[expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when this is inlined"
)]
#[inline(always)]
fn exp2_minus(cost: f32) -> f32 {
    let shifted = ROUNDING - cost;
    let minus_k = shifted - ROUNDING;
    let f = minus_k + cost;
    let mut power = POLYNOMIAL[5];
    power = power * f + POLYNOMIAL[4];
    power = power * f + POLYNOMIAL[3];
    power = power * f + POLYNOMIAL[2];
    power = power * f + POLYNOMIAL[1];
    power = power * f + POLYNOMIAL[0];
    f32::from_bits(power.to_bits().wrapping_add(shifted.to_bits() << 23))
}

/// Squared distance of a query step to one step of each candidate, clamped, as 2^−distance.
#[expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when this is inlined"
)]
#[inline(always)]
fn similarity<const D: usize>(query: &[f32; D], candidates: &[Lanes; D]) -> Lanes {
    let mut cost = [0.0_f32; LANES];
    for (query, candidates) in query.iter().zip(candidates) {
        for (cost, candidate) in cost.iter_mut().zip(candidates) {
            let difference = query - candidate;
            *cost += difference * difference;
        }
    }
    // A loop, not `map`: the call it makes is not inlined and passes all lanes through memory.
    for cost in &mut cost {
        *cost = exp2_minus(if *cost < COST_LIMIT {
            *cost
        } else {
            COST_LIMIT
        });
    }
    cost
}

/// Scores of a block: start · Σ over warping paths of 2^−cost, for each lane.
///
/// # Shapes
/// `query`: n steps; `block`: m steps of D components of sixteen lanes; `row`: m lanes of working memory.
#[expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when this is inlined"
)]
#[inline(always)]
fn recursion<const D: usize>(
    query: &[[f32; D]],
    block: &[[Lanes; D]],
    start: &Lanes,
    row: &mut [Lanes],
) -> Lanes {
    row.fill([0.0; LANES]);
    let mut corner = *start;
    for step in query {
        let mut diagonal = corner;
        let mut left = [0.0_f32; LANES];
        for (cell, candidates) in row.iter_mut().zip(block) {
            let k = similarity(step, candidates);
            let up = *cell;
            for l in 0..LANES {
                left[l] = k[l] * ((diagonal[l] + up[l] + FLOOR) + left[l]);
            }
            *cell = left;
            diagonal = up;
        }
        corner = [0.0; LANES];
    }
    row.last().copied().unwrap_or([0.0; LANES])
}

/// [`recursion`] with the row on the stack and its length known to the compiler for the lengths that pedestrians have.
pub(crate) fn scores<const D: usize>(
    query: &[[f32; D]],
    block: &[[Lanes; D]],
    start: &Lanes,
    row: &mut Vec<Lanes>,
) -> Lanes {
    if let Ok(block) = <&[[Lanes; D]; 7]>::try_from(block) {
        return recursion(query, block, start, &mut [[0.0; LANES]; 7]);
    }
    if let Ok(block) = <&[[Lanes; D]; 8]>::try_from(block) {
        return recursion(query, block, start, &mut [[0.0; LANES]; 8]);
    }
    row.resize(block.len(), [0.0; LANES]);
    recursion(query, block, start, row)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

    use super::{COST_LIMIT, EXP2_ERROR, LANES, exp2_minus, scores};
    use crate::{Cost, SoftDtw};

    #[test]
    fn exp2_keeps_its_error_bound_over_the_whole_range() {
        let steps = 400_000_u32;
        let mut worst = 0.0_f64;
        for i in 0..=steps {
            let cost = COST_LIMIT * (i as f32 / steps as f32);
            let exact = (-f64::from(cost)).exp2();
            worst = worst.max((f64::from(exp2_minus(cost)) / exact - 1.0).abs());
        }
        assert!(worst < EXP2_ERROR, "{worst:e}");
        assert!(worst > 1e-8, "a test that cannot fail: {worst:e}");
        assert_eq!(exp2_minus(0.0), 1.000_000_1);
    }

    #[test]
    fn lanes_agree_with_the_log_domain_and_far_ones_stay_normal() {
        let gamma = std::f64::consts::LN_2.recip(); // costs are then log2 units as they are
        let dtw = SoftDtw::new(gamma, Cost::SquaredEuclidean).expect("valid");
        let query: Vec<[f64; 2]> = (0..6)
            .map(|i| [f64::from(i) * 0.1, 1.0 - f64::from(i) * 0.2])
            .collect();
        for steps in [1, 5, 7, 8, 11] {
            let mut block = vec![[[0.0_f32; LANES]; 2]; steps];
            for (i, step) in block.iter_mut().enumerate() {
                let far = |l| if l == LANES - 1 { 1e3 } else { 0.0 };
                *step = [
                    std::array::from_fn(|l| 0.01 * (l * i) as f32),
                    std::array::from_fn(|l| 0.9 - 0.04 * l as f32 + far(l)),
                ];
            }
            let narrow: Vec<[f32; 2]> = query.iter().map(|q| q.map(|v| v as f32)).collect();
            let start = 2.0_f32.powi(100);
            let scores = scores(&narrow, &block, &[start; LANES], &mut Vec::new());
            for l in 0..LANES - 1 {
                let candidate: Vec<[f64; 2]> = block
                    .iter()
                    .map(|step| [f64::from(step[0][l]), f64::from(step[1][l])])
                    .collect();
                let exact = dtw.value(&query, &candidate).expect("finite");
                let fast = -gamma * f64::from(scores[l] / start).ln();
                assert!(
                    (fast - exact).abs() < 2e-5,
                    "{steps} steps, lane {l}: {fast} {exact}"
                );
            }
            assert!(scores[LANES - 1].is_normal() && scores[LANES - 1] < 1.0);
        }
    }
}
