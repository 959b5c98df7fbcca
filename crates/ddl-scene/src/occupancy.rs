//! Where somebody is: grids of the probability that a cell is occupied.
//!
//! A cell is occupied by pedestrian i on its hypothesis h with the probability `m_ih` that the disc of its body covers
//! the centre of the cell: the mass of Student's t ([`Spread`](ddl_core::Spread)) within the radius of the body around
//! that centre (`mass.rs`). For a part of the scene with samples s of the weight `w_s`, in which i follows `h_is`,
//!
//! ```text
//! P(occupied by the part) = sum_s w_s (1 - prod_i (1 - m_ih_is))
//! P(occupied)             = 1 - prod (1 - P(occupied by the part))
//! ```
//!
//! Where two are not both likely to be there, they count as independent: no probability is too small by more than 0.001
//! for each.
//!
//! At the moment itself the spread is 0, and the discs are those of the present positions.

mod around;
mod files;
mod mass;
#[cfg(test)]
mod tests;

use crate::{error::SceneError, futures::Futures, parts::ScenePart};
use ddl_core::{HORIZON, Position, TIME_STEP};
use mass::MassTable;
use rayon::prelude::*;
use std::ops::Range;

/// The probability that somebody and others are in a cell, above which they do not count as independent.
const BOTH: f64 = 1e-3;
/// The last time of a forecast, seconds after the moment, and what rounding may add to it.
const LAST: f64 = TIME_STEP * HORIZON as f64;
const ROUNDING: f64 = 1e-9;

/// A rectangle on the ground in square cells, in rows along x, the lowest y first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    origin: Position,
    cell: f64,
    width: usize,
    height: usize,
}

impl Area {
    /// The most cells of an area. Its grid takes 4 bytes for each.
    pub const MOST_CELLS: usize = 50_000_000;
    /// The most cells of an area that nobody gives, around several pedestrians: 200 x 200 m in cells of 0.1 m.
    pub const MOST_AROUND: usize = 25_000_000;

    /// The area from one corner to the other (m), in cells of this size (m); larger by less than a cell if the cells do
    /// not fit.
    ///
    /// # Errors
    /// A number is not finite, a corner is not below the other, a cell is not larger than 0, there are too many cells.
    pub fn new(low: Position, high: Position, cell: f64) -> Result<Self, SceneError> {
        check("the size of a cell", cell, cell > 0.0, "a number of metres above 0")?;
        let [width, height] = [0, 1].map(|axis| high[axis] - low[axis]);
        for (name, size) in [("the width of the area", width), ("the height of the area", height)] {
            check(name, size, size > 0.0, "a number of metres above 0")?;
        }
        let [columns, rows] = [width, height].map(|size| (size / cell - ROUNDING).ceil().max(1.0));
        if columns * rows > Self::MOST_CELLS as f64 {
            let most = Self::MOST_CELLS;
            return Err(SceneError::Cells { width, height, cell, most });
        }
        Ok(Self { origin: low, cell, width: columns as usize, height: rows as usize })
    }

    /// Checks that the grids of so many times fit into memory together.
    ///
    /// # Errors
    /// They have more than 200 million values, which take 0.8 GB.
    pub fn ensure_kept(&self, times: usize) -> Result<(), SceneError> {
        let numbers = (times * self.width * self.height) as f64;
        let right = "at most 200000000: take larger cells, a smaller area or fewer times";
        check("the number of values in all grids", numbers, numbers <= 2e8, right)
    }

    /// Its corner with the lowest x and y, metres.
    pub fn origin(&self) -> Position {
        self.origin
    }

    /// Side of a cell, metres.
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Cells along x and along y.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The middle of a cell, counted along x and y from the origin, metres.
    pub fn centre(&self, [column, row]: [usize; 2]) -> Position {
        let along = |axis: usize, index: usize| self.origin[axis] + self.cell * (index as f64 + 0.5);
        [along(0, column), along(1, row)]
    }
}

/// The probability of each cell of an area at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Occupancy {
    /// The cells.
    pub area: Area,
    /// Seconds after the moment of the forecast.
    pub time: f64,
    /// `[height][width]`, the row of the lowest y first.
    pub probabilities: Vec<f32>,
}

impl Occupancy {
    /// Radius of a standing pedestrian, metres.
    pub const BODY: f64 = 0.2;

    /// The times 0, `step`, 2 `step` and so on until 4.8 s.
    ///
    /// # Errors
    /// The step is not a number of at least 0.01 s.
    pub fn every(step: f64) -> Result<Vec<f64>, SceneError> {
        check("the time between grids", step, step >= 0.01, "a number of at least 0.01 s")?;
        let last = (LAST / step + ROUNDING) as usize;
        // Without the rounding error of the product: 0.3, not 0.30000000000000004.
        Ok((0..=last).map(|index| (index as f64 * step * 1e9).round() / 1e9).collect())
    }
}

impl Futures {
    /// One grid for each time (s after the moment), computed when the iterator arrives at it, in parallel. A body is a
    /// disc of the radius `body` (m); [`BODY`](Occupancy::BODY) if nothing else is known.
    ///
    /// Probabilities are correct to 0.001 for each pedestrian; those below 0.0001 are left out.
    ///
    /// # Errors
    /// A time is not within 0 to 4.8 s, the radius is not a number above 0; the forecast has no spread.
    pub fn occupancy<'a>(
        &'a self,
        area: &'a Area,
        times: &'a [f64],
        body: f64,
    ) -> Result<impl Iterator<Item = Occupancy> + 'a, SceneError> {
        check("the radius of a body", body, body > 0.0, "a number of metres above 0")?;
        for &time in times {
            let is_inside = (0.0..=LAST + ROUNDING).contains(&time);
            check("a time of the grids", time, is_inside, "from 0 to 4.8 s after the moment")?;
        }
        if self.scale(0, 0.0).is_none() {
            return Err(SceneError::NoSpread);
        }
        Ok(times.iter().map(move |&time| self.grid(area, time, body)))
    }

    fn grid(&self, area: &Area, time: f64, body: f64) -> Occupancy {
        let count = self.hypotheses().hypotheses();
        let bodies = |part: &ScenePart| -> Vec<OccupyingBody> {
            let of = |(row, &i): (usize, &usize)| OccupyingBody {
                pedestrian: i,
                shares: part.shares(row, count),
                places: (0..count).map(|k| self.position(i, k, time)).collect(),
                table: MassTable::new(body, self.scale(i, time).unwrap_or(0.0)),
            };
            part.pedestrians().iter().enumerate().map(of).collect()
        };
        let parts: Vec<Vec<OccupyingBody>> = self.parts().par_iter().map(bodies).collect();
        let mut probabilities = vec![0.0; area.width * area.height];
        let rows = probabilities.par_chunks_mut(area.width).enumerate();
        rows.for_each(|(row, probabilities)| {
            let mut free = vec![1.0; area.width];
            for (part, bodies) in self.parts().iter().zip(&parts) {
                free_of_part(area, row, part, bodies, &mut free);
            }
            for (probability, free) in probabilities.iter_mut().zip(free) {
                *probability = (1.0 - free).clamp(0.0, 1.0) as f32;
            }
        });
        Occupancy { area: *area, time, probabilities }
    }
}

/// A pedestrian at one time.
struct OccupyingBody {
    pedestrian: usize,
    /// `[H]`: probabilities of the hypotheses, and where they are (m).
    shares: Vec<f64>,
    places: Vec<Position>,
    table: MassTable,
}

impl OccupyingBody {
    /// The columns of a row of cells that it may occupy on its hypothesis `h`.
    fn columns(&self, area: &Area, row: usize, h: usize) -> Range<usize> {
        let [x, y] = self.places[h];
        let dy = area.centre([0, row])[1] - y;
        let half = self.table.reach() * self.table.reach() - dy * dy;
        if half < 0.0 {
            return 0..0;
        }
        let column = |x: f64| ((x - area.origin[0]) / area.cell).clamp(0.0, area.width as f64) as usize;
        column(x - half.sqrt())..column(x + half.sqrt() + area.cell)
    }

    /// The probability that it covers a place on its hypothesis `h`.
    fn mass(&self, h: usize, place: Position) -> f64 {
        let [dx, dy] = [0, 1].map(|axis| place[axis] - self.places[h][axis]);
        self.table.mass((dx * dx + dy * dy).sqrt())
    }
}

/// Multiplies the probabilities that the cells of a row are free with those that the pedestrians of a part leave them
/// free.
fn free_of_part(area: &Area, row: usize, part: &ScenePart, bodies: &[OccupyingBody], free: &mut [f64]) {
    // For each body, the columns from the first that it may occupy, with the probability that it does.
    let mut occupied: Vec<(usize, Vec<f64>)> = Vec::with_capacity(bodies.len());
    for body in bodies {
        let columns: Vec<Range<usize>> = (0..body.places.len()).map(|h| body.columns(area, row, h)).collect();
        let some = columns.iter().zip(&body.shares).filter(|(columns, share)| !columns.is_empty() && **share > 0.0);
        let first = some.clone().map(|(columns, _)| columns.start).min().unwrap_or(0);
        let end = some.map(|(columns, _)| columns.end).max().unwrap_or(0);
        let mut probabilities = vec![0.0; end.saturating_sub(first)];
        for (h, (columns, &share)) in columns.into_iter().zip(&body.shares).enumerate().filter(|(_, (_, s))| **s > 0.0)
        {
            for column in columns {
                probabilities[column - first] += share * body.mass(h, area.centre([column, row]));
            }
        }
        occupied.push((first, probabilities));
    }
    let first = occupied.iter().filter(|(_, all)| !all.is_empty()).map(|(first, _)| *first).min().unwrap_or(0);
    let end = occupied.iter().map(|(first, all)| first + all.len()).max().unwrap_or(0);
    let mut both = Vec::new();
    for (column, free) in free.iter_mut().enumerate().take(end).skip(first) {
        let of = |(first, all): &(usize, Vec<f64>)| all.get(column.wrapping_sub(*first)).copied().unwrap_or(0.0);
        let total: f64 = occupied.iter().map(of).sum();
        both.clear();
        for (body, occupied) in bodies.iter().zip(occupied.iter().map(of)) {
            if occupied * (total - occupied) > BOTH {
                both.push(body);
            } else {
                *free *= 1.0 - occupied;
            }
        }
        if !both.is_empty() {
            let place = area.centre([column, row]);
            let of = |body: &&OccupyingBody| {
                let away = (0..body.places.len()).map(|h| 1.0 - body.mass(h, place));
                (body.pedestrian, away.collect())
            };
            *free *= 1.0 - part.somebody(&both.iter().map(of).collect::<Vec<_>>());
        }
    }
}

fn check(name: &'static str, value: f64, is_valid: bool, expected: &'static str) -> Result<(), SceneError> {
    if is_valid && value.is_finite() {
        return Ok(());
    }
    Err(SceneError::Number { name, value, expected })
}
