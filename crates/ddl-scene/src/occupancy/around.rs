//! The area of grids for which nobody gives one.

use super::{Area, LAST, check};
use crate::{error::SceneError, futures::Futures};
use ddl_core::{Position, bounds};

impl Futures {
    /// The smallest area around all paths, wider by a margin (m) on every side, in cells of this size (m), for grids of
    /// so many `times`.
    ///
    /// A false track far away must not cost the others their grids. Where all paths take more than
    /// [`MOST_AROUND`](Area::MOST_AROUND) cells, or more than grids of so many times [may](Area::ensure_kept), the
    /// area is around as many people as fit, those nearest to the middle one; the second value are the others.
    ///
    /// # Errors
    /// The margin is negative or not finite; as [`Area::new`], for the paths of one pedestrian alone.
    pub fn area(&self, margin: f64, cell: f64, times: usize) -> Result<(Area, Vec<usize>), SceneError> {
        check("the margin", margin, margin >= 0.0, "a number of metres, 0 or more")?;
        let mut people: Vec<usize> = (0..self.pedestrians()).collect();
        let fits = |people: &[usize]| {
            let area = self.area_around(people, margin, cell);
            area.is_ok_and(|area| area.width * area.height <= Area::MOST_AROUND && area.ensure_kept(times).is_ok())
        };
        let mut inside = people.len();
        if !fits(&people) {
            let middle = self.middle();
            let away = |&i: &usize| (0..2).map(|axis| (self.present(i)[axis] - middle[axis]).abs()).fold(0.0, f64::max);
            people.sort_by(|a, b| away(a).total_cmp(&away(b)));
            let counts: Vec<usize> = (1..=people.len()).collect();
            inside = counts.partition_point(|&count| fits(&people[..count])).max(1);
        }
        let left_out = people.split_off(inside);
        Ok((self.area_around(&people, margin, cell)?, left_out))
    }

    fn area_around(&self, people: &[usize], margin: f64, cell: f64) -> Result<Area, SceneError> {
        let hypotheses = self.hypotheses();
        let of = |&i: &usize| (0..hypotheses.hypotheses()).flat_map(move |k| hypotheses.hypothesis(i, k));
        let paths = people.iter().flat_map(of);
        let [low, high] = bounds(paths.copied().chain(people.iter().map(|&i| self.present(i)))).unwrap_or_default();
        let low = low.map(|coordinate| coordinate - margin);
        // Somebody who stands still, without a margin.
        Area::new(low, [0, 1].map(|axis| (high[axis] + margin).max(low[axis] + cell)), cell)
    }

    /// The median of the present positions on each axis. Whose forecast is wider, as that of a track of two rows,
    /// counts less.
    fn middle(&self) -> Position {
        [0, 1].map(|axis| {
            let weight = |i: usize| self.scale(i, LAST).map_or(1.0, |scale| scale.max(1e-3).recip());
            let mut along: Vec<[f64; 2]> =
                (0..self.pedestrians()).map(|i| [self.present(i)[axis], weight(i)]).collect();
            along.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let mut left: f64 = along.iter().map(|[_, weight]| weight).sum::<f64>() / 2.0;
            let reached = along.iter().find(|[_, weight]| {
                left -= weight;
                left <= 0.0
            });
            reached.or(along.last()).map_or(0.0, |[place, _]| *place)
        })
    }
}
