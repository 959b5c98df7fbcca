//! The error bound of the scores, and what survives the sieve.

use super::{CandidateSieve, Search};
use crate::SoftDtw;
use ddl_simd::{Dispatch, InstructionSet};

/// Velocities around a few walking directions, some of them nearly standing.
fn walks(count: usize, steps: usize, offset: f64) -> Vec<Vec<[f64; 2]>> {
    let walk = |i: usize| {
        let (sin, cos) = (0.7 * i as f64).sin_cos();
        let speed = 0.013 * (i % 120) as f64;
        let sway = |j: usize| 0.2 * ((i * 31 + j * 17) as f64).sin() * speed;
        (0..steps).map(|j| [speed * cos + sway(j) + offset, speed * sin - sway(j)]).collect()
    };
    (0..count).map(walk).collect()
}

fn sieve(gamma: f64, walks: &[Vec<[f64; 2]>]) -> (SoftDtw, Vec<f64>, Option<CandidateSieve<2>>) {
    let dtw = SoftDtw::new(gamma).expect("valid");
    let self_values: Vec<f64> = walks.iter().map(|walk| dtw.self_value(walk)).collect();
    let slices: Vec<&[[f64; 2]]> = walks.iter().map(Vec::as_slice).collect();
    let sieve = CandidateSieve::build(gamma, &slices, &self_values);
    (dtw, self_values, sieve)
}

fn each_set() -> impl Iterator<Item = Dispatch> {
    InstructionSet::available().into_iter().filter_map(Dispatch::new)
}

/// Scores of all candidates: a selection that wants more than there are keeps all of them.
fn scores(sieve: &CandidateSieve<2>, dispatch: Dispatch, query: &[[f64; 2]]) -> (Search<2>, Vec<f32>) {
    let count = sieve.blocks.members.as_flattened().len();
    let set = dispatch.instruction_set();
    let mut search = sieve.search(set, query, count).expect("in range");
    for run in &sieve.blocks.runs {
        sieve.sweep(dispatch, run, &mut search);
    }
    let mut scores = vec![f32::NAN; count];
    let selection = crate::select::Selection::new(1, 0.0);
    for scored in std::mem::replace(&mut search.selection, selection).finish(0.0) {
        scores[scored.candidate] = scored.score;
    }
    (search, scores)
}

#[test]
fn scores_keep_their_error_bound() {
    let mut worst = 0.0_f64;
    for (steps, gamma) in [(7, 1.0), (8, 1.0), (8, 0.2), (20, 1.0), (3, 0.05)] {
        let walks = walks(500, steps, 0.0);
        let (dtw, self_values, sieve) = sieve(gamma, &walks);
        let sieve = sieve.expect("fits f32");
        for dispatch in each_set() {
            let query = &walks[123];
            let (search, scores) = scores(&sieve, dispatch, query);
            let range = search.range;
            let mut accurate = 0;
            for (candidate, walk) in walks.iter().enumerate() {
                let score = f64::from(scores[candidate]).log2();
                if score < range.smallest_accurate_log2() {
                    continue;
                }
                let value = dtw.value_unchecked(query, walk) - self_values[candidate] / 2.0;
                let scale = sieve.blocks.narrowing.scale;
                let exact = f64::from(range.start_log2) - value * scale * scale;
                let share = (score - exact).abs() / range.error_log2(score, search.largest, 2);
                worst = worst.max(share);
                accurate += 1;
            }
            assert!(accurate > 100, "only {accurate} scores are accurate: {steps} steps, {gamma}");
        }
    }
    assert!(worst < 1.0, "an error {worst} times its bound");
    assert!(worst > 1e-3, "the bound is far too wide: {worst}");
}

#[test]
fn few_survive_where_f32_can_tell_and_nothing_is_decided_where_it_cannot() {
    let near = walks(4000, 8, 0.0);
    let sieve_of_near = sieve(1.0, &near).2.expect("fits f32");
    // A common offset does no harm, because it is subtracted before rounding.
    let offset = walks(4000, 8, 1e5);
    let sieve_of_offset = sieve(1.0, &offset).2.expect("fits f32");
    // The hundred nearest of the last query are too far for the range.
    let far = walks(1, 8, 8.0);
    for dispatch in each_set() {
        for query in [7, 9] {
            let survivors = sieve_of_near.survivors(dispatch, &near[query], 100).expect("near");
            assert!((100..400).contains(&survivors.len()), "{}", survivors.len());
            assert!(survivors.contains(&query));
        }
        assert_eq!(sieve_of_near.survivors(dispatch, &far[0], 100), None);
        assert!(sieve_of_offset.survivors(dispatch, &offset[7], 100).is_some());
    }
    // Gamma is too small for the data.
    assert!(sieve(1e-13, &near).2.is_none());
}
