//! Where somebody is: grids of the probability that a cell is occupied.
//!
//! A cell is occupied by pedestrian i in future k with the probability `m_ik` that the disc of its body covers the
//! centre of the cell: the mass of Student's t ([`Spread`](ddl_core::Spread)) within the radius of the body around that
//! centre (`mass.rs`). Given the future, pedestrians are independent, and
//!
//! ```text
//! P(occupied) = sum_k w_k (1 - prod_i (1 - m_ik))
//! ```
//!
//! At the moment itself the spread is 0, and the discs are those of the present positions.

mod around;
mod files;
mod mass;
#[cfg(test)]
mod tests;

use crate::{error::SceneError, futures::Futures};
use ddl_core::{HORIZON, Position, TIME_STEP};
use mass::MassTable;
use rayon::prelude::*;

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
    pub const MOST_AROUND: usize = 4_000_000;

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
        let pedestrians: Vec<usize> = (0..self.pedestrians()).collect();
        let table = |&i: &usize| MassTable::new(body, self.scale(i, time).unwrap_or(0.0));
        let tables: Vec<MassTable> = pedestrians.par_iter().map(table).collect();
        let places: Vec<Vec<Position>> =
            (0..self.count()).map(|k| pedestrians.iter().map(|&i| self.position(i, k, time)).collect()).collect();
        let mut probabilities = vec![0.0; area.width * area.height];
        let rows = probabilities.par_chunks_mut(area.width).enumerate();
        rows.for_each_init(
            || vec![1.0; area.width],
            |free, (row, probabilities)| {
                for (k, places) in places.iter().enumerate() {
                    add_future(area, row, places.iter().zip(&tables), self.weight(k), free, probabilities);
                }
            },
        );
        // The weights sum to 1 up to rounding.
        for probability in &mut probabilities {
            *probability = probability.min(1.0);
        }
        Occupancy { area: *area, time, probabilities }
    }
}

/// Adds one future to a row of cells. `free` is a buffer for the probabilities that a cell is empty; it must hold 1 in
/// every entry, and holds 1 again afterwards.
fn add_future<'a>(
    area: &Area,
    row: usize,
    bodies: impl Iterator<Item = (&'a Position, &'a MassTable)>,
    weight: f64,
    free: &mut [f32],
    probabilities: &mut [f32],
) {
    let [mut first, mut end] = [area.width, 0];
    for (place, table) in bodies {
        let dy = area.centre([0, row])[1] - place[1];
        let half = table.reach() * table.reach() - dy * dy;
        if half < 0.0 {
            continue;
        }
        let column = |x: f64| ((x - area.origin[0]) / area.cell).clamp(0.0, area.width as f64) as usize;
        let [from, to] = [column(place[0] - half.sqrt()), column(place[0] + half.sqrt() + area.cell)];
        for (offset, free) in free[from..to].iter_mut().enumerate() {
            let dx = area.centre([from + offset, row])[0] - place[0];
            *free *= 1.0 - table.mass((dx * dx + dy * dy).sqrt()) as f32;
        }
        [first, end] = [first.min(from), end.max(to)];
    }
    for (free, probability) in free[first.min(end)..end].iter_mut().zip(&mut probabilities[first.min(end)..end]) {
        *probability += weight as f32 * (1.0 - *free);
        *free = 1.0;
    }
}

fn check(name: &'static str, value: f64, is_valid: bool, expected: &'static str) -> Result<(), SceneError> {
    if is_valid && value.is_finite() {
        return Ok(());
    }
    Err(SceneError::Number { name, value, expected })
}
