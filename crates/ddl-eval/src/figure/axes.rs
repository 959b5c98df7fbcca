//! Metres to pixels at one scale for both axes, and the frame with its numbers.

use ddl_data::Position;

use super::canvas::{Canvas, GRID, Pixel, Place};
use crate::error::FigureError;

/// The plot fills at most this many pixels.
const LARGEST: (f64, f64) = (1240.0, 960.0);
/// Neither side of the plot is smaller, pixels.
const SMALLEST: (f64, f64) = (620.0, 460.0);
/// Space around the plot: left, top, right (the legend), bottom; pixels.
const LEFT: i32 = 120;
const TOP: i32 = 84;
const RIGHT: i32 = 440;
const BOTTOM: i32 = 110;
/// A scene where everybody stands still is shown this wide, metres.
const LEAST_SPAN: f64 = 4.0;
/// Margin around the points, share of the span.
const MARGIN: f64 = 0.05;

/// The plot area of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    /// Lower left corner, metres.
    low: Position,
    /// Upper right corner, metres.
    high: Position,
    /// Pixels a metre.
    scale: f64,
}

impl Axes {
    /// A plot that holds every point.
    pub(super) fn around(points: &[Position]) -> Self {
        let range = |axis: usize| {
            let low = points.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
            let high = points
                .iter()
                .map(|p| p[axis])
                .fold(f64::NEG_INFINITY, f64::max);
            // Without points there is nothing to show but empty axes around the origin.
            let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
            let span = (high - low).max(LEAST_SPAN) * (1.0 + 2.0 * MARGIN);
            (f64::midpoint(low, high), span)
        };
        let ((x, width), (y, height)) = (range(0), range(1));
        let scale = (LARGEST.0 / width).min(LARGEST.1 / height);
        let width = width.max(SMALLEST.0 / scale);
        let height = height.max(SMALLEST.1 / scale);
        Self {
            low: [x - width / 2.0, y - height / 2.0],
            high: [x + width / 2.0, y + height / 2.0],
            scale,
        }
    }

    /// Size of the whole picture, pixels.
    pub(super) fn size(&self) -> (u32, u32) {
        let (right, bottom) = self.corner();
        (
            (right + RIGHT).unsigned_abs(),
            (bottom + BOTTOM).unsigned_abs(),
        )
    }

    /// Where a position is drawn; y points up.
    pub(super) fn pixel(&self, p: Position) -> Pixel {
        let x = (p[0] - self.low[0]) * self.scale;
        let y = (self.high[1] - p[1]) * self.scale;
        (LEFT + x.round() as i32, TOP + y.round() as i32)
    }

    /// Whether a pixel lies within the frame.
    pub(super) fn shows(&self, (x, y): Pixel) -> bool {
        let (right, bottom) = self.corner();
        (LEFT..=right).contains(&x) && (TOP..=bottom).contains(&y)
    }

    /// Upper left corner of the space for the legend.
    pub(super) fn beside(&self) -> Pixel {
        (self.corner().0 + 30, TOP)
    }

    /// Lower right corner of the plot.
    fn corner(&self) -> Pixel {
        self.pixel([self.high[0], self.low[1]])
    }

    /// Draws grid, frame, numbers, names of the axes and the title.
    pub(super) fn draw(&self, canvas: &Canvas<'_>, title: &str) -> Result<(), FigureError> {
        let (right, bottom) = self.corner();
        let step = self.tick_step();
        for tick in ticks(self.low[0], self.high[0], step) {
            let (x, _) = self.pixel([tick, self.low[1]]);
            canvas.line(&[(x, TOP), (x, bottom)], GRID, 1)?;
            canvas.text(&number(tick, step), (x, bottom + 14), 26, Place::Below)?;
        }
        for tick in ticks(self.low[1], self.high[1], step) {
            let (_, y) = self.pixel([self.low[0], tick]);
            canvas.line(&[(LEFT, y), (right, y)], GRID, 1)?;
            canvas.text(&number(tick, step), (LEFT - 14, y), 26, Place::LeftOf)?;
        }
        canvas.frame([(LEFT, TOP), (right, bottom)])?;
        let centre = (i32::midpoint(LEFT, right), i32::midpoint(TOP, bottom));
        canvas.text("x (m)", (centre.0, bottom + 56), 28, Place::Below)?;
        canvas.text("y (m)", (36, centre.1), 28, Place::Upwards)?;
        canvas.text(title, (LEFT, TOP / 2), 36, Place::RightOf)
    }

    /// One step for both axes: 1, 2 or 5 times a power of ten, at most 11 of them on the longer side.
    fn tick_step(&self) -> f64 {
        let span = (self.high[0] - self.low[0]).max(self.high[1] - self.low[1]);
        let raw = span / 10.0;
        let power = 10_f64.powf(raw.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|s| s * power);
        steps
            .into_iter()
            .find(|step| *step >= raw)
            .unwrap_or(steps[3])
    }
}

fn ticks(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(move |n| n as f64 * step)
}

fn number(tick: f64, step: f64) -> String {
    // Adding zero turns -0 into 0.
    if step < 1.0 {
        format!("{:.1}", tick + 0.0)
    } else {
        format!("{:.0}", tick + 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_metre_is_as_long_up_as_across() {
        let axes = Axes::around(&[[0.0, 0.0], [30.0, 2.0]]);
        let (a, b, c) = (
            axes.pixel([1.0, 1.0]),
            axes.pixel([2.0, 1.0]),
            axes.pixel([1.0, 2.0]),
        );
        assert!(((b.0 - a.0) - (a.1 - c.1)).abs() <= 1);
        assert!(axes.shows(axes.pixel([0.0, 0.0])) && axes.shows(axes.pixel([30.0, 2.0])));
        assert!(!axes.shows(axes.pixel([60.0, 0.0])));
    }

    #[test]
    fn extreme_scenes_have_readable_axes() {
        for points in [vec![], vec![[5.0, -3.0]], vec![[-1e5, 0.0], [1e5, 0.0]]] {
            let axes = Axes::around(&points);
            let (width, height) = axes.size();
            assert!(width <= 1800 && height < 1400, "{width} x {height}");
            let count = ticks(axes.low[0], axes.high[0], axes.tick_step()).count();
            assert!((2..=11).contains(&count), "{count} ticks");
        }
    }
}
