//! Metres to pixels at one scale for both axes, and the frame with its numbers.

use ddl_data::Position;

use super::{
    canvas::{Canvas, GRID, Pixel, Place},
    clip,
    error::FigureError,
    layout::Layout,
};

/// A scene where everybody stands still is shown this wide, metres.
const LEAST_SPAN: f64 = 4.0;

/// The plot area of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    /// Lower left corner, metres.
    low: Position,
    /// Upper right corner, metres.
    high: Position,
    /// Pixels a metre.
    scale: f64,
    layout: &'static Layout,
    /// Upper left corner of the space that plot and lettering have together, pixels.
    origin: Pixel,
}

impl Axes {
    /// A plot that holds every point.
    pub(super) fn around(points: &[Position], layout: &'static Layout) -> Self {
        let range = |axis: usize| {
            let low = points.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
            let high = points
                .iter()
                .map(|p| p[axis])
                .fold(f64::NEG_INFINITY, f64::max);
            // Without points there is nothing to show but empty axes around the origin.
            let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
            let span = (high - low).max(LEAST_SPAN) * (1.0 + 2.0 * layout.margin);
            (f64::midpoint(low, high), span)
        };
        let ((x, width), (y, height)) = (range(0), range(1));
        let scale = (layout.largest.0 / width).min(layout.largest.1 / height);
        let width = width.max(layout.smallest.0 / scale);
        let height = height.max(layout.smallest.1 / scale);
        Self {
            low: [x - width / 2.0, y - height / 2.0],
            high: [x + width / 2.0, y + height / 2.0],
            scale,
            layout,
            origin: (0, 0),
        }
    }

    /// The same plot elsewhere: `origin` is the upper left corner of its space, lettering included.
    pub(super) fn at(mut self, origin: Pixel) -> Self {
        self.origin = origin;
        self
    }

    /// Size of the space that plot and lettering have together, pixels.
    pub(super) fn size(&self) -> (u32, u32) {
        let [_, (right, bottom)] = self.frame();
        (
            (right + self.layout.right - self.origin.0).unsigned_abs(),
            (bottom + self.layout.bottom - self.origin.1).unsigned_abs(),
        )
    }

    /// Where a position is drawn; y points up.
    pub(super) fn pixel(&self, p: Position) -> Pixel {
        let x = (p[0] - self.low[0]) * self.scale;
        let y = (self.high[1] - p[1]) * self.scale;
        (
            self.origin.0 + self.layout.left + x.round() as i32,
            self.origin.1 + self.layout.top + y.round() as i32,
        )
    }

    /// A position within the frame as a pixel, others not at all.
    pub(super) fn shown(&self, p: Position) -> Option<Pixel> {
        let within = (0..2).all(|axis| (self.low[axis]..=self.high[axis]).contains(&p[axis]));
        within.then(|| self.pixel(p))
    }

    /// What lies within the frame of a path, in pieces.
    pub(super) fn cut(&self, path: &[Position]) -> Vec<Vec<Pixel>> {
        clip::within(path, self.low, self.high)
            .iter()
            .map(|piece| piece.iter().map(|p| self.pixel(*p)).collect())
            .collect()
    }

    /// Upper left and lower right corner of the plot.
    pub(super) fn frame(&self) -> [Pixel; 2] {
        [
            self.pixel([self.low[0], self.high[1]]),
            self.pixel([self.high[0], self.low[1]]),
        ]
    }

    /// Draws grid, frame and numbers.
    pub(super) fn draw(&self, canvas: &Canvas<'_>) -> Result<(), FigureError> {
        let [(left, top), (right, bottom)] = self.frame();
        let (step, size) = (self.tick_step(), self.layout.numbers);
        for tick in ticks(self.low[0], self.high[0], step) {
            let (x, _) = self.pixel([tick, self.low[1]]);
            canvas.line(&[(x, top), (x, bottom)], GRID, 1)?;
            canvas.text(&number(tick, step), (x, bottom + 14), size, Place::Below)?;
        }
        for tick in ticks(self.low[1], self.high[1], step) {
            let (_, y) = self.pixel([self.low[0], tick]);
            canvas.line(&[(left, y), (right, y)], GRID, 1)?;
            canvas.text(&number(tick, step), (left - 14, y), size, Place::LeftOf)?;
        }
        canvas.frame(self.frame())
    }

    /// Writes the names of the axes outside the numbers.
    pub(super) fn draw_names(&self, canvas: &Canvas<'_>) -> Result<(), FigureError> {
        let [(left, top), (right, bottom)] = self.frame();
        let centre = (i32::midpoint(left, right), i32::midpoint(top, bottom));
        canvas.text("x (m)", (centre.0, bottom + 56), 28, Place::Below)?;
        canvas.text("y (m)", (self.origin.0 + 36, centre.1), 28, Place::Upwards)
    }

    /// One step for both axes: 1, 2 or 5 times a power of ten, as many on the longer side as the layout
    /// says and at most one more.
    fn tick_step(&self) -> f64 {
        let span = (self.high[0] - self.low[0]).max(self.high[1] - self.low[1]);
        let raw = span / self.layout.steps;
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
    use crate::figure::layout::{PANEL, SCENE};

    #[test]
    fn one_metre_is_as_long_up_as_across() {
        for layout in [&SCENE, &PANEL] {
            let axes = Axes::around(&[[0.0, 0.0], [30.0, 2.0]], layout).at((700, 90));
            let (a, b, c) = (
                axes.pixel([1.0, 1.0]),
                axes.pixel([2.0, 1.0]),
                axes.pixel([1.0, 2.0]),
            );
            assert!(((b.0 - a.0) - (a.1 - c.1)).abs() <= 1);
            assert!(axes.shown([0.0, 0.0]).is_some() && axes.shown([30.0, 2.0]).is_some());
            assert!(axes.shown([60.0, 0.0]).is_none());
        }
    }

    #[test]
    fn extreme_scenes_have_readable_axes() {
        for points in [vec![], vec![[5.0, -3.0]], vec![[-1e5, 0.0], [1e5, 0.0]]] {
            for (layout, most) in [(&SCENE, 11), (&PANEL, 8)] {
                let axes = Axes::around(&points, layout);
                let (width, height) = axes.size();
                assert!(width <= 1800 && height < 1400, "{width} x {height}");
                let count = ticks(axes.low[0], axes.high[0], axes.tick_step()).count();
                assert!((2..=most).contains(&count), "{count} ticks");
            }
        }
    }

    #[test]
    fn panels_are_of_one_size_wherever_they_are() {
        let size = |points: &[Position], origin| Axes::around(points, &PANEL).at(origin).size();
        let one = size(&[[0.0, 0.0], [30.0, 2.0]], (0, 0));
        assert_eq!(one, size(&[[0.0, 0.0], [1.0, 50.0]], (640, 1300)));
        assert_eq!(one, size(&[], (20, 0)));
    }

    #[test]
    fn what_is_cut_stays_within_the_frame() {
        let axes = Axes::around(&[[0.0, 0.0], [10.0, 10.0]], &PANEL);
        let [(left, top), (right, bottom)] = axes.frame();
        let pieces = axes.cut(&[[5.0, 5.0], [1e6, -3e5], [5.0, -1e6], [5.0, 5.0]]);
        assert_eq!(pieces.len(), 2);
        for (x, y) in pieces.into_iter().flatten() {
            assert!((left..=right).contains(&x) && (top..=bottom).contains(&y));
        }
    }
}
