//! Quantiles that follow the scores of one place.
//!
//! A region of the level `a` with the right quantile `q` misses the share `1 - a` of the true positions. Each quantile
//! of the table is multiplied by `exp(shift)`, and each frame moves the shift of each pace by the share that its
//! regions missed:
//!
//! ```text
//! shift += STEP * w * (missed - (1 - a))        w = share * min(sqrt(n), LARGEST_WEIGHT)
//! ```
//!
//! `missed` is the share of the `n` observed pedestrians of this pace outside their regions for this frame, `share` the
//! time since the frame before in steps of 0.4 s, at most 1. A pace of which little was seen also learns from the
//! others: as long as the sum W of its own `w` is below [`YOUTH`], their moves are added to its own, multiplied by
//! `1 - W / YOUTH`.
//!
//! Whole paths and scenes (`whole.rs`) follow the same rule once a forecast has ended, with `share` the time from the
//! forecast before it: paths of each pace, and moments with one shift for all, `n = 1` and the step [`SCENE_STEP`].
//! `missed` of paths is the share that left their region, among pedestrians observed at all 12 steps. `missed` of a
//! moment is 1 if any observed position of a pedestrian is outside the region of the scene, else 0.
//!
//! As long as no shift reaches its bound, it is the sum of these moves. So from then on, the mean of `missed` of each
//! pace, weighted by `w`, differs from `1 - a` by at most `2 LARGEST_SHIFT / (STEP sum w)`, for any motion of the
//! pedestrians. If the quantiles of two levels cross, they are sorted; the bound then holds for the levels together.
//! Those of paths and scenes are raised to the level below instead ([`rising`]), so that it holds for each.
//!
//! # References
//! - Gibbs and Candes, *Adaptive Conformal Inference Under Distribution Shift*, 2021.
//! - Angelopoulos, Candes and Tibshirani, *Conformal PID Control for Time Series Prediction*, 2023 (tracking of the
//!   quantile).

use std::sync::Arc;

use crate::pace::Pace;
use crate::position::HORIZON;
use crate::region::whole::{LEAST, Wholes, rising};
use crate::region_table::{LevelQuantiles, RegionTable};

/// Step size of a shift. Chosen with [`LARGEST_WEIGHT`] on recordings of other places.
const STEP: f64 = 0.06;
/// Step size of the shift of scenes, of which a frame has one outcome. Of 0.06 to 0.2, in a simulation on 22
/// recordings, those of ETH/UCY among them (`docs/tried.md`).
const SCENE_STEP: f64 = 0.15;
/// Weight of a frame with nine pedestrians or more. Outcomes come up to 12 steps late; with a larger weight the
/// quantiles of crowds oscillate.
const LARGEST_WEIGHT: f64 = 3.0;
/// ln 64: a quantile stays between 1/64 and 64 times that of the table (or [`LEAST`]), a radius between about 1/8 and 8
/// times.
const LARGEST_SHIFT: f64 = 4.158_883_083_359_672;
/// Sum of the weights of a pace from which it learns from itself alone.
const YOUTH: f64 = 30.0;
/// A table of quantiles with their learned shifts.
#[derive(Debug, Clone)]
pub(super) struct TrackedQuantiles {
    start: Arc<RegionTable>,
    steps: [Shifts; HORIZON],
    paths: Shifts,
    /// One class: a moment is one outcome, and there are few.
    scenes: Shifts,
    now: Arc<RegionTable>,
}

/// Shifts of the quantiles of classes, such as the paces.
#[derive(Debug, Clone)]
struct Shifts {
    /// `[classes][levels]`, no unit.
    rows: Vec<Vec<f64>>,
    /// For each class the sum of its weights.
    learned: Vec<f64>,
}

/// Scores of the positions at one frame under forecasts made `step` + 1 steps before it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcomes {
    pub(super) step: usize,
    /// The table of their regions.
    pub(super) table: Arc<RegionTable>,
    /// One for each pedestrian.
    pub(super) scores: Vec<(Pace, f64)>,
}

/// For each level, which regions of a forecast that has ended were left by their pedestrians.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Moment {
    /// The time since the moment before, in steps, at most 1.
    pub(super) share: f64,
    /// Of whole paths, one for each pedestrian.
    pub(super) paths: Vec<(Pace, Vec<bool>)>,
    /// Whether a pedestrian left the region of the scene.
    pub(super) scene_missed: Vec<bool>,
}

impl Shifts {
    fn new(classes: usize, levels: usize) -> Self {
        Self { rows: vec![vec![0.0; levels]; classes], learned: vec![0.0; classes] }
    }

    /// Learns from the weight of each class, and the moves of its levels.
    fn learn(&mut self, of_classes: &[(f64, Vec<f64>)]) {
        for (index, shifts) in self.rows.iter_mut().enumerate() {
            let young = (1.0 - self.learned[index] / YOUTH).max(0.0);
            for (level, shift) in shifts.iter_mut().enumerate() {
                let of_class = |(other, (_, moves)): (usize, &(f64, Vec<f64>))| {
                    moves[level] * if other == index { 1.0 } else { young }
                };
                let moved = *shift + of_classes.iter().enumerate().map(of_class).sum::<f64>();
                *shift = moved.clamp(-LARGEST_SHIFT, LARGEST_SHIFT);
            }
            self.learned[index] += of_classes[index].0;
        }
    }
}

impl TrackedQuantiles {
    /// The table with shifts of 0.
    #[must_use]
    pub(super) fn new(start: Arc<RegionTable>) -> Self {
        let shifts = |classes| Shifts::new(classes, start.0.levels.len());
        Self {
            steps: std::array::from_fn(|_| shifts(Pace::ALL.len())),
            paths: shifts(Pace::ALL.len()),
            scenes: shifts(1),
            now: Arc::clone(&start),
            start,
        }
    }

    /// The current quantiles.
    pub(super) fn table(&self) -> &Arc<RegionTable> {
        &self.now
    }

    /// Learns from all outcomes of one frame, `share` of a step (0 to 1) after the frame before.
    pub(super) fn learn(&mut self, outcomes: &[Outcomes], share: f64) {
        for outcomes in outcomes {
            self.steps[outcomes.step].learn(&Pace::ALL.map(|pace| outcomes.moves(pace, share)));
        }
        if !outcomes.is_empty() {
            self.now = self.shifted().into();
        }
    }

    /// Learns from forecasts that have ended.
    pub(super) fn learn_wholes(&mut self, moments: impl Iterator<Item = Moment>) {
        let levels = self.start.0.levels.clone();
        let mut is_new = false;
        for Moment { share, paths, scene_missed } in moments {
            let of_paces = Pace::ALL.map(|pace| {
                let own = || paths.iter().filter(|(of, _)| *of == pace);
                let (count, missed) = (own().count(), |level| own().filter(|(_, missed)| missed[level]).count());
                moves(&levels, STEP, weight_of(count, share), |level| missed(level) as f64 / count.max(1) as f64)
            });
            self.paths.learn(&of_paces);
            let of_scene = |level| f64::from(u8::from(scene_missed[level]));
            self.scenes.learn(&[moves(&levels, SCENE_STEP, weight_of(1, share), of_scene)]);
            is_new = true;
        }
        if is_new {
            self.now = self.shifted().into();
        }
    }

    /// The quantiles with their shifts, in ascending order over the levels.
    fn shifted(&self) -> RegionTable {
        let LevelQuantiles { levels, quantiles, wholes } = &self.start.0;
        let of_pace = |pace: Pace| {
            let column = |t: usize| {
                let rows = quantiles[pace as usize].iter().map(|row| row[t]);
                let mut column: Vec<f64> = moved(rows, &self.steps[t].rows[pace as usize]).collect();
                column.sort_by(f64::total_cmp);
                column
            };
            let columns: [Vec<f64>; HORIZON] = std::array::from_fn(column);
            (0..levels.len()).map(|row| std::array::from_fn(|t| columns[t][row])).collect()
        };
        let path = |pace: Pace| {
            let factors = wholes.iter().flat_map(|wholes| &wholes.paths[pace as usize]);
            rising(moved(factors.copied(), &self.paths.rows[pace as usize]))
        };
        let wholes = wholes.as_ref().map(|Wholes { scenes, .. }| Wholes {
            paths: Pace::ALL.map(path),
            // Their order over the levels depends on the number of pedestrians, and is made where that is known.
            scenes: scenes.iter().zip(&self.scenes.rows[0]).map(|([b, c], s)| [b.max(LEAST) * s.exp(), *c]).collect(),
        });
        RegionTable(LevelQuantiles { levels: levels.clone(), quantiles: Pace::ALL.map(of_pace), wholes })
    }
}

impl Outcomes {
    /// The weight of the outcomes of one pace, and for each level the move of its shift.
    fn moves(&self, pace: Pace, share: f64) -> (f64, Vec<f64>) {
        let own = || self.scores.iter().filter(|(of, _)| *of == pace).map(|(_, score)| *score);
        let count = own().count();
        let LevelQuantiles { levels, quantiles, .. } = &self.table.0;
        let quantile = |level: usize| quantiles[pace as usize][level][self.step];
        let missed = |level| own().filter(|score| *score > quantile(level)).count();
        moves(levels, STEP, weight_of(count, share), |level| missed(level) as f64 / count.max(1) as f64)
    }
}

/// The weight, and for each level the move of a shift whose regions missed this share.
fn moves(levels: &[f64], step: f64, weight: f64, missed: impl Fn(usize) -> f64) -> (f64, Vec<f64>) {
    let move_of = |(row, level): (usize, &f64)| step * weight * (missed(row) - (1.0 - level));
    (weight, levels.iter().enumerate().map(move_of).collect())
}

/// The weight of the outcomes of `count` pedestrians, `share` of a step after the frame before.
pub(super) fn weight_of(count: usize, share: f64) -> f64 {
    share * (count as f64).sqrt().min(LARGEST_WEIGHT)
}

/// Quantiles times the exponentials of their shifts.
fn moved(quantiles: impl Iterator<Item = f64>, shifts: &[f64]) -> impl Iterator<Item = f64> {
    quantiles.zip(shifts).map(|(q, shift)| q.max(LEAST) * shift.exp())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use std::collections::VecDeque;

    use proptest::{collection::vec, prelude::*};

    use super::*;
    use crate::region::whole::Holding;

    fn table(rows: &[(f64, f64)]) -> Arc<RegionTable> {
        let columns = LevelQuantiles {
            levels: rows.iter().map(|row| row.0).collect(),
            quantiles: Pace::ALL.map(|_| rows.iter().map(|row| [row.1; HORIZON]).collect()),
            wholes: None,
        };
        Arc::new(columns.try_into().unwrap())
    }

    /// The numbers come from a Python program, written from the formula at the head of this file. The first score is on
    /// the edge of its region, and so within.
    #[test]
    fn five_frames_as_computed_elsewhere() {
        let mut tracked = TrackedQuantiles::new(table(&[(0.5, 1.0), (0.9, 4.0)]));
        let frames: [(f64, &[f64], [f64; 2]); 5] = [
            (1.0, &[1.0, 2.0, 5.0], [1.017_471_377_864, 4.098_180_408_623]),
            (0.5, &[6.0], [1.032_848_488_542, 4.210_338_601_735]),
            (1.0, &[0.1; 16], [0.943_952_443_339, 4.135_230_507_658]),
            (1.0, &[9.0, 9.0, 0.2, 1.5], [0.972_700_075_075, 4.338_562_501_638]),
            (0.25, &[3.0, 0.9], [0.972_700_075_075, 4.329_368_775_608]),
        ];
        for (share, scores, expected) in frames {
            let outcomes = Outcomes { step: 0, table: Arc::clone(tracked.table()), scores: walking(scores) };
            tracked.learn(&[outcomes], share);
            for (level, expected) in [0.5, 0.9].into_iter().zip(expected) {
                // Paces that were not seen follow those that were.
                for pace in Pace::ALL {
                    let quantile = tracked.table().quantile(pace, level, 0).unwrap();
                    assert!((quantile - expected).abs() < 1e-12, "{quantile} {expected}");
                    let untouched = tracked.table().quantile(pace, level, 1);
                    assert_eq!(untouched, tracked.start.quantile(pace, level, 1));
                }
            }
        }
    }

    /// A table of the same quantiles for all steps and paces, with those of paths and scenes.
    fn whole_table(levels: &[f64], quantiles: &[f64], paths: &[f64], scenes: &[[f64; 2]]) -> Arc<RegionTable> {
        let rows: Vec<(f64, f64)> = levels.iter().copied().zip(quantiles.iter().copied()).collect();
        let wholes = Wholes { paths: [(); 3].map(|()| paths.to_vec()), scenes: scenes.to_vec() };
        Arc::new(LevelQuantiles { wholes: Some(wholes), ..table(&rows).0.clone() }.try_into().unwrap())
    }

    /// The numbers come from a numpy program, written from the formulas at the heads of this file and of `whole.rs`:
    /// quantiles of paths of the levels 0.5 and 0.9 for those who walk, of 0.9 for those who are slow, and of scenes of
    /// four for those who walk.
    #[test]
    fn four_moments_as_computed_elsewhere() {
        let table = whole_table(&[0.5, 0.9], &[1.0, 4.0], &[0.5, 2.0], &[[0.4, 0.5], [1.2, 0.3]]);
        let mut tracked = TrackedQuantiles::new(table);
        let (none, low, both) = ([false, false], [true, false], [true, true]);
        let of = |pace: Pace, paths: &[[bool; 2]]| paths.iter().map(|path| (pace, path.to_vec())).collect::<Vec<_>>();
        let crowd = [of(Pace::Walking, &[both; 16]), of(Pace::Standing, &[none])].concat();
        let expected = [
            [2.034_942_755_728, 8.196_360_817_247, 8.196_360_817_247, 7.067_781_935_874, 17.062_790_835_701],
            [2.034_942_755_728, 8.196_360_817_247, 8.196_360_817_247, 7.337_855_998_582, 16.935_298_597_944],
            [2.164_522_406_031, 9.583_440_519_415, 9.580_121_293_177, 9.247_868_678_436, 22.663_292_117_991],
            [2.164_522_406_031, 9.566_332_941_500, 9.559_820_327_023, 9.059_884_739_016, 22.538_158_688_927],
        ];
        let moments = [
            (1.0, of(Pace::Walking, &[low, none, both]), both),
            (0.5, Vec::new(), low),
            (1.0, crowd, both),
            (0.25, of(Pace::Slow, &[none, low]), none),
        ];
        for ((share, paths, scene_missed), expected) in moments.into_iter().zip(expected) {
            tracked.learn_wholes([Moment { share, paths, scene_missed: scene_missed.to_vec() }].into_iter());
            let [path, scene] = [Holding::Path, Holding::Scene].map(|of| tracked.table().holding(of, 4).unwrap());
            let cells = [(&path, Pace::Walking, 0.5), (&path, Pace::Walking, 0.9), (&path, Pace::Slow, 0.9)];
            let scenes = [(&scene, Pace::Walking, 0.5), (&scene, Pace::Walking, 0.9)];
            for ((table, pace, level), expected) in cells.into_iter().chain(scenes).zip(expected) {
                let found = table.quantile(pace, level, 7).unwrap();
                assert!((found - expected).abs() < 1e-11, "{found} {expected}");
            }
        }
    }

    fn walking(scores: &[f64]) -> Vec<(Pace, f64)> {
        scores.iter().map(|&score| (Pace::Walking, score)).collect()
    }

    /// One frame: for each observed pedestrian its pace, whether it is missed, and its distance from the edge.
    type Judged = Vec<(usize, bool, f64)>;

    proptest! {
        /// An adversary that knows the regions cannot move the weighted mean of a pace beyond the bound once it learns
        /// from itself alone, if the scores stay within a factor of 7 of the table's quantile. Then no shift reaches
        /// its bound.
        #[test]
        fn the_share_missed_is_bounded_for_any_stream(
            level in 0.05..0.95f64,
            t in 0..HORIZON,
            frames in vec((vec((0..3usize, any::<bool>(), 1.0..1.5f64), 1..20), 0.1..1.0f64), 1..600),
            run in 1..50usize,
        ) {
            let base = 2.0;
            let mut tracked = TrackedQuantiles::new(table(&[(level, base)]));
            let mut issued = VecDeque::from(vec![Arc::clone(tracked.table()); t + 1]);
            let (mut learned, mut error, mut weights) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for (at, (judged, share)) in frames.iter().enumerate() {
                let judged: &Judged = judged;
                let table = issued.pop_front().unwrap();
                let edges = Pace::ALL.map(|pace| table.quantile(pace, level, t).unwrap());
                // Runs in which all regions miss, or no region misses, move the quantile furthest.
                let score = |&(pace, coin, by): &(usize, bool, f64)| {
                    let mood = (at / run + pace) % 3;
                    let misses = if mood == 2 { coin } else { mood == 0 };
                    let wanted = if misses { edges[pace] * by } else { edges[pace] / by };
                    (Pace::ALL[pace], wanted.clamp(base / 7.0, base * 7.0))
                };
                let scores: Vec<(Pace, f64)> = judged.iter().map(score).collect();
                for pace in 0..3 {
                    let own = scores.iter().filter(|(of, _)| *of as usize == pace);
                    let count = own.clone().count() as f64;
                    let missed = own.filter(|(_, score)| *score > edges[pace]).count() as f64;
                    let weight = share * count.sqrt().min(3.0);
                    if learned[pace] >= YOUTH {
                        error[pace] += weight * (missed / count.max(1.0) - (1.0 - level));
                        weights[pace] += weight;
                    }
                    learned[pace] += weight;
                }
                tracked.learn(&[Outcomes { step: t, table, scores }], *share);
                issued.push_back(Arc::clone(tracked.table()));
            }
            for (error, weights) in error.into_iter().zip(weights) {
                prop_assert!(error.abs() <= 2.0 * LARGEST_SHIFT / STEP + 1e-9, "{error} {weights}");
            }
        }

        /// As above for whole paths and scenes, which are judged twelve frames later, at two levels that may cross.
        /// Scores are beyond the regions of steps, within which nothing is missed.
        #[test]
        fn the_share_of_paths_and_scenes_missed_is_bounded_for_any_stream(
            level in 0.05..0.95f64,
            frames in vec((vec((0..3usize, any::<bool>()), 0..9), any::<bool>(), 0.1..1.0f64), 1..600),
            run in 1..50usize,
        ) {
            let levels = [0.7 * level, level];
            let start = whole_table(&levels, &[2.0; 2], &[1.5; 2], &[[1.25, 0.5]; 2]);
            let mut tracked = TrackedQuantiles::new(start);
            let mut issued = VecDeque::from(vec![Arc::clone(tracked.table()); HORIZON]);
            let (mut learned, mut error, mut of_scenes) = ([0.0; 3], [[0.0; 2]; 3], [0.0; 2]);
            for (at, (judged, coin, share)) in frames.iter().enumerate() {
                let table = issued.pop_front().unwrap();
                let missed = |holding, pace, coin: bool, most: f64| {
                    let held = table.holding(holding, judged.len()).unwrap();
                    let edges = levels.map(|level| held.quantile(pace, level, 3).unwrap());
                    let mood = (at / run + pace as usize) % 3;
                    let misses = if mood == 2 { coin } else { mood == 0 };
                    let wanted = edges[at % 2] * if misses { 1.1 } else { 1.0 / 1.1 };
                    edges.map(|edge| wanted.clamp(2.0 + 1e-9, most) > edge).to_vec()
                };
                let path = |&(pace, coin): &(usize, bool)| {
                    (Pace::ALL[pace], missed(Holding::Path, Pace::ALL[pace], coin, 20.0))
                };
                let paths: Vec<(Pace, Vec<bool>)> = judged.iter().map(path).collect();
                let scene_missed = missed(Holding::Scene, Pace::Slow, *coin, 40.0);
                for pace in 0..3 {
                    let own = || paths.iter().filter(|(of, _)| *of as usize == pace);
                    let weight = share * (own().count() as f64).sqrt().min(3.0);
                    for (row, error) in error[pace].iter_mut().enumerate().filter(|_| learned[pace] >= YOUTH) {
                        let missed = own().filter(|(_, missed)| missed[row]).count() as f64;
                        *error += weight * (missed / own().count().max(1) as f64 - (1.0 - levels[row]));
                    }
                    learned[pace] += weight;
                }
                for (row, error) in of_scenes.iter_mut().enumerate() {
                    *error += share * (f64::from(u8::from(scene_missed[row])) - (1.0 - levels[row]));
                }
                tracked.learn_wholes([Moment { share: *share, paths, scene_missed }].into_iter());
                issued.push_back(Arc::clone(tracked.table()));
            }
            let is_near = |error: &f64, step: f64| error.abs() <= 2.0 * LARGEST_SHIFT / step + 1e-9;
            prop_assert!(error.as_flattened().iter().all(|error| is_near(error, STEP)), "{error:?}");
            prop_assert!(of_scenes.iter().all(|error| is_near(error, SCENE_STEP)), "{of_scenes:?}");
        }

        #[test]
        fn quantiles_stay_within_their_bounds_and_in_order(
            scores in vec(prop_oneof![Just(0.0), 0.0..20.0f64, Just(1e300)], 1..400),
            rows in Just([(0.2, 0.0), (0.5, 1.0), (0.9, 4.0)]),
        ) {
            let mut tracked = TrackedQuantiles::new(table(&rows));
            for (at, score) in scores.iter().enumerate() {
                let step = at % HORIZON;
                let table = Arc::clone(tracked.table());
                tracked.learn(&[Outcomes { step, table, scores: walking(&[*score; 9]) }], 1.0);
                let quantile = |level| tracked.table().quantile(Pace::Walking, level, step).unwrap();
                let [low, middle, high] = [0.2, 0.5, 0.9].map(quantile);
                prop_assert!(low > 0.0 && low <= middle && middle <= high && high <= 256.1);
            }
        }
    }
}
