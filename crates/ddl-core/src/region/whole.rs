//! Regions of whole paths, and of everybody at once.
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
        let mut of_scenes: Vec<f64> = scenes.iter().map(of_scene).collect();
        of_scenes.sort_by(f64::total_cmp);
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

/// The levels at which regions missed one of the scores `[12]`, NaN where the pedestrian was not seen.
pub(super) fn missed<'a>(table: &'a RegionTable, pace: Pace, scores: &'a [f64; HORIZON]) -> impl Iterator<Item = bool> {
    let rows = table.0.quantiles[pace as usize].iter();
    rows.map(|quantiles| scores.iter().zip(quantiles).any(|(score, quantile)| score > quantile))
}
