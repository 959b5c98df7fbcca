//! Tables of the quantiles from which a forecast makes its regions (see `region.rs`).

use serde::{Deserialize, Serialize};

use crate::pace::Pace;
use crate::position::{HORIZON, Position};
use crate::region::Wholes;

/// Quantiles of scores, for paces, levels and steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LevelQuantiles", into = "LevelQuantiles")]
pub struct RegionTable(pub(crate) LevelQuantiles);

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LevelQuantiles {
    /// Ascending, in (0, 1).
    pub(crate) levels: Vec<f64>,
    /// For each [pace](Pace), slowest first: `[levels][12]`.
    pub(crate) quantiles: [Vec<[f64; HORIZON]>; Pace::ALL.len()],
    /// `None` in tables of regions of single steps alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) wholes: Option<Wholes>,
}

impl TryFrom<LevelQuantiles> for RegionTable {
    type Error = &'static str;

    fn try_from(columns: LevelQuantiles) -> Result<Self, Self::Error> {
        let inside = |level: &f64| *level > 0.0 && *level < 1.0;
        let of_levels = |rows: &Vec<[f64; HORIZON]>| {
            rows.len() == columns.levels.len() && rows.as_flattened().iter().all(|q| q.is_finite())
        };
        let is_valid = !columns.levels.is_empty()
            && columns.levels.iter().all(inside)
            && columns.levels.is_sorted_by(|a, b| a < b)
            && columns.quantiles.iter().all(of_levels)
            && columns.wholes.iter().all(|wholes| wholes.is_valid(columns.levels.len()));
        if is_valid {
            Ok(Self(columns))
        } else {
            Err("a table of regions needs ascending levels between 0 and 1, with 12 finite quantiles for each pace")
        }
    }
}

impl From<RegionTable> for LevelQuantiles {
    fn from(table: RegionTable) -> Self {
        table.0
    }
}

/// A disc of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Metres.
    pub centre: Position,
    /// Metres.
    pub radius: f64,
}

impl Disc {
    /// Whether the position (m) is in the disc or on its edge.
    pub fn contains(&self, position: Position) -> bool {
        let [x, y] = [0, 1].map(|axis| position[axis] - self.centre[axis]);
        x * x + y * y <= self.radius * self.radius
    }
}

impl RegionTable {
    /// The table from scores of true positions of each pace, slowest first: for each level and step the split-conformal
    /// quantile of the scores. With n scores, the levels can be up to n / (n + 1).
    ///
    /// # Shapes
    /// `scores` `[3][pedestrians][12]`; `levels` ascending, in (0, 1), at least one. `None` otherwise.
    pub fn of(scores: &[&[[f64; HORIZON]]; Pace::ALL.len()], levels: &[f64]) -> Option<Self> {
        let [standing, slow, walking] = scores.map(|scores| split_conformal(scores, levels));
        let columns = LevelQuantiles { levels: levels.to_vec(), quantiles: [standing?, slow?, walking?], wholes: None };
        columns.try_into().ok()
    }

    /// The lowest and the highest level with quantiles.
    pub fn range(&self) -> [f64; 2] {
        let levels = &self.0.levels;
        [levels[0], levels[levels.len() - 1]]
    }

    /// The quantile of a level, `t` + 1 steps ahead, linear between the levels; `None` beyond the [range](Self::range).
    pub fn quantile(&self, pace: Pace, level: f64, t: usize) -> Option<f64> {
        let [lowest, highest] = self.range();
        if !(lowest..=highest).contains(&level) {
            return None;
        }
        let (before, after, share) = self.between(level);
        let [low, high] = [before, after].map(|row| self.0.quantiles[pace as usize][row][t]);
        Some(low + share * (high - low))
    }

    /// The rows below and above a level in the range, and how far from the first to the second it is.
    pub(crate) fn between(&self, level: f64) -> (usize, usize, f64) {
        let levels = &self.0.levels;
        let after = levels.partition_point(|&l| l < level);
        let before = after.saturating_sub(1);
        let width = levels[after] - levels[before];
        (before, after, if width > 0.0 { (level - levels[before]) / width } else { 0.0 })
    }
}

/// `[levels][12]` quantiles of the scores of one pace.
fn split_conformal(scores: &[[f64; HORIZON]], levels: &[f64]) -> Option<Vec<[f64; HORIZON]>> {
    let of_step = |t: usize| {
        let mut step: Vec<f64> = scores.iter().map(|scores| scores[t]).collect();
        step.sort_by(f64::total_cmp);
        step
    };
    let steps: Vec<Vec<f64>> = (0..HORIZON).map(of_step).collect();
    let of_level = |&level: &f64| {
        let rank = (level * (scores.len() + 1) as f64).ceil() as usize;
        let place = rank.checked_sub(1).filter(|&place| place < scores.len())?;
        Some(std::array::from_fn(|t| steps[t][place]))
    };
    levels.iter().map(of_level).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_by_hand() {
        let scores: Vec<[f64; HORIZON]> = (1..=99).map(|s| [f64::from(s); HORIZON]).collect();
        let tens = scores.iter().map(|row| row.map(|score| 10.0 * score)).collect::<Vec<_>>();
        let table = RegionTable::of(&[&tens, &scores, &scores], &[0.5, 0.9]).unwrap();
        for (level, expected) in [(0.5, 50.0), (0.9, 90.0), (0.7, 70.0)] {
            for (pace, factor) in Pace::ALL.into_iter().zip([10.0, 1.0, 1.0]) {
                let quantile = table.quantile(pace, level, 3).unwrap();
                assert!((quantile - factor * expected).abs() < 1e-9);
            }
        }
        for beyond in [0.2, 0.99, f64::NAN] {
            assert_eq!(table.quantile(Pace::Slow, beyond, 3), None);
        }
        // 99 scores are enough for the level 0.99.
        assert!(RegionTable::of(&[&scores; 3], &[0.99]).is_some());
        assert_eq!(RegionTable::of(&[&scores, &scores[..98], &scores], &[0.99]), None);
        let empty: Result<RegionTable, _> = serde_json::from_str(r#"{"levels": [], "quantiles": [[], [], []]}"#);
        assert!(empty.is_err());
        assert_eq!(RegionTable::of(&[&scores; 3], &[0.9, 0.5]), None);
    }
}
