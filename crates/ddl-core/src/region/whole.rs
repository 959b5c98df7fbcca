//! Regions that hold a whole path, or all pedestrians of a scene on their whole paths.
//!
//! The discs of a path are larger than those of single steps, all by one factor, and those of a scene larger again.
//! With the quantiles `q_t(a)` of steps (see `region.rs`), the region of the level `a` has
//!
//! ```text
//! path:  p_t(a) = max(q_t(a), paths(a) q_t(0.9))
//! scene: s_t(a) = max(p_t(a), scenes(a, n) paths(0.9) q_t(0.9))        scenes(a, n) = b n^c
//! ```
//!
//! where `n` is the number of pedestrians that are forecast. `paths(a)` is the split-conformal quantile of the largest
//! `score / q_t(0.9)` of the 12 steps, `scenes(a, n)` that of the largest `score / (paths(0.9) q_t(0.9))` of all steps
//! and pedestrians of a moment, by a power law in `n`, which also answers for numbers that were never seen. Quantiles
//! at 0.9 make steps, paces and pedestrians contribute alike.
//!
//! # References
//! Cleaveland et al., *Conformal Prediction Regions for Time Series using Linear Complementarity Programming*, 2024
//! (the largest of scaled scores).

use serde::{Deserialize, Serialize};

use crate::forecast::Forecast;
use crate::pace::Pace;
use crate::position::HORIZON;
use crate::region_table::{LevelQuantiles, RegionTable};

/// The level at which steps and paths are made comparable; the nearest one of tables without it.
const COMMON: f64 = 0.9;
/// Smallest quantile that is multiplied, so that a quantile of 0 can grow.
pub(super) const LEAST: f64 = 1e-3;

/// What a region holds with its probability.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Holding {
    /// A pedestrian at one step.
    #[default]
    Step,
    /// A pedestrian at all 12 steps.
    Path,
    /// All pedestrians of the forecast at all 12 steps.
    Scene,
}

impl Holding {
    /// All, the least first.
    pub const ALL: [Self; 3] = [Self::Step, Self::Path, Self::Scene];

    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|holding| holding.name() == name)
    }

    /// `step`, `path` or `scene`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Path => "path",
            Self::Scene => "scene",
        }
    }
}

/// Factors by which regions of whole paths and of scenes are larger, for each level of the table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wholes {
    /// For each pace, slowest first.
    pub(crate) paths: [Vec<f64>; Pace::ALL.len()],
    /// The factor b of one pedestrian, and the power c of their number.
    pub(crate) scenes: Vec<[f64; 2]>,
}

impl Wholes {
    pub(crate) fn is_valid(&self, levels: usize) -> bool {
        let is_factor = |factor: &f64| factor.is_finite() && *factor >= 0.0;
        self.paths.iter().all(|paths| paths.len() == levels && paths.iter().all(is_factor))
            && self.scenes.len() == levels
            && self.scenes.iter().all(|[b, c]| is_factor(b) && (0.0..=4.0).contains(c))
    }
}

impl RegionTable {
    /// The table of regions that hold this, of forecasts of `pedestrians`; `None` if the table has no such quantiles.
    #[must_use]
    pub fn holding(&self, holding: Holding, pedestrians: usize) -> Option<Self> {
        let LevelQuantiles { levels, wholes, .. } = &self.0;
        if holding == Holding::Step {
            return Some(self.clone());
        }
        let Wholes { paths, scenes } = wholes.as_ref()?;
        let of_scene = |[b, c]: &[f64; 2]| b * (pedestrians.max(1) as f64).powf(*c);
        let of_scenes = rising(scenes.iter().map(of_scene));
        let of_cell = |pace: Pace, row: usize, t: usize| {
            let paths = &paths[pace as usize];
            let common = self.common(|level| self.0.quantiles[pace as usize][level][t]).max(LEAST);
            let path = self.0.quantiles[pace as usize][row][t].max(paths[row] * common);
            match holding {
                Holding::Scene => path.max(of_scenes[row] * self.common(|level| paths[level]) * common),
                _ => path,
            }
        };
        let rows = |pace| (0..levels.len()).map(|row| std::array::from_fn(|t| of_cell(pace, row, t))).collect();
        let quantiles = Pace::ALL.map(rows);
        Some(Self(LevelQuantiles { levels: levels.clone(), quantiles, wholes: None }))
    }

    /// The value at [`COMMON`] of one that each level has.
    fn common(&self, of_level: impl Fn(usize) -> f64) -> f64 {
        let [lowest, highest] = self.range();
        let (before, after, share) = self.between(COMMON.clamp(lowest, highest));
        of_level(before) + share * (of_level(after) - of_level(before))
    }
}

impl Forecast {
    /// The same forecast with regions that hold this instead of each step; `None` without a [spread](crate::Spread),
    /// or if its table has no such quantiles, as that of a forecast which already holds more than steps.
    #[must_use]
    pub fn holding(&self, holding: Holding) -> Option<Self> {
        let table = self.regions()?.holding(holding, self.pedestrians())?;
        Some(self.clone().with_regions(&table.into()))
    }
}

/// The numbers of ascending levels, each at least those before it. Sorting them would give a level the number that
/// another one has learned: where levels cross often, as those of scenes, both then drift without effect.
pub(super) fn rising(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut most = 0.0;
    let rise = |number: f64| {
        most = number.max(most);
        most
    };
    numbers.map(rise).collect()
}

/// The levels at which regions missed one of the scores `[12]`, NaN where the pedestrian was not seen.
pub(super) fn missed<'a>(table: &'a RegionTable, pace: Pace, scores: &'a [f64; HORIZON]) -> impl Iterator<Item = bool> {
    let rows = table.0.quantiles[pace as usize].iter();
    rows.map(|quantiles| scores.iter().zip(quantiles).any(|(score, quantile)| score > quantile))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use proptest::{collection::vec, prelude::*};

    use super::*;

    proptest! {
        #[test]
        fn regions_of_more_contain_those_of_less(
            steps in vec(0.0..9.0f64, 3),
            paths in vec(0.0..9.0f64, 3),
            scenes in vec((0.0..9.0f64, 0.0..1.0f64), 3),
            (fewer, more) in (0..40usize, 0..5000usize),
            level in 0.1..0.95f64,
        ) {
            let sorted = |mut numbers: Vec<f64>| {
                numbers.sort_by(f64::total_cmp);
                numbers
            };
            let (steps, paths) = (sorted(steps), sorted(paths));
            let columns = LevelQuantiles {
                levels: vec![0.1, 0.5, 0.95],
                quantiles: Pace::ALL.map(|_| steps.iter().map(|q| std::array::from_fn(|t| q * t as f64)).collect()),
                wholes: Some(Wholes {
                    paths: Pace::ALL.map(|_| paths.clone()),
                    scenes: scenes.into_iter().map(|(b, c)| [b, c]).collect(),
                }),
            };
            let table: RegionTable = columns.try_into().unwrap();
            let held = |holding, number| table.holding(holding, number).unwrap();
            let tables = [
                held(Holding::Step, fewer),
                held(Holding::Path, fewer),
                held(Holding::Scene, fewer),
                held(Holding::Scene, fewer + more),
            ];
            for t in 0..HORIZON {
                let of_level = |level| tables.each_ref().map(|table| table.quantile(Pace::Slow, level, t).unwrap());
                let (quantiles, lower) = (of_level(level), of_level(0.1 + 0.5 * (level - 0.1)));
                prop_assert!(quantiles.is_sorted_by(|a, b| *a <= b + 1e-9), "{quantiles:?}");
                prop_assert!(lower.iter().zip(quantiles).all(|(low, high)| *low <= high + 1e-9), "nested");
            }
            prop_assert_eq!(held(Holding::Path, fewer), held(Holding::Path, more), "a path is of one");
            prop_assert_eq!(held(Holding::Path, fewer).holding(Holding::Scene, 3), None);
        }
    }

    /// By hand: 4 is the common quantile of steps, 2 that of paths, and 16 pedestrians have 1.5 times 16 to the power
    /// 0.5.
    #[test]
    fn tables_are_read_and_refused() {
        let of = |wholes: &str| {
            let row = "[[1,1,1,1,1,1,1,1,1,1,1,1], [4,4,4,4,4,4,4,4,4,4,4,4]]";
            let text = format!(r#"{{"levels": [0.5, 0.9], "quantiles": [{row}, {row}, {row}]{wholes}}}"#);
            serde_json::from_str::<RegionTable>(&text)
        };
        let table =
            of(r#", "wholes": {"paths": [[0.1, 2], [0.5, 2], [3, 2]], "scenes": [[0, 0], [1.5, 0.5]]}"#).unwrap();
        let quantile = |holding, pace, level| table.holding(holding, 16).unwrap().quantile(pace, level, 2).unwrap();
        for (holding, pace, level, expected) in [
            (Holding::Path, Pace::Standing, 0.5, 1.0),
            (Holding::Path, Pace::Standing, 0.9, 8.0),
            (Holding::Path, Pace::Slow, 0.5, 2.0),
            (Holding::Scene, Pace::Slow, 0.5, 2.0),
            (Holding::Scene, Pace::Slow, 0.9, 48.0),
        ] {
            assert!((quantile(holding, pace, level) - expected).abs() < 1e-12);
        }
        let old = of("").unwrap();
        assert_eq!(old.holding(Holding::Step, 3).as_ref(), Some(&old));
        assert_eq!(old.holding(Holding::Path, 3), None);
        for wholes in [
            r#"{"paths": [[1, 2], [1, 2], [1]], "scenes": [[1, 0], [1, 0]]}"#,
            r#"{"paths": [[1, 2], [1, 2], [1, -2]], "scenes": [[1, 0], [1, 0]]}"#,
            r#"{"paths": [[1, 2], [1, 2], [1, 2]], "scenes": [[1, 0]]}"#,
            r#"{"paths": [[1, 2], [1, 2], [1, 2]], "scenes": [[1, 0], [1, 4.5]]}"#,
        ] {
            assert!(of(&format!(r#", "wholes": {wholes}"#)).is_err(), "{wholes}");
        }
    }
}
