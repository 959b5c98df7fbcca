//! The frame of a plot in metres, with its grid and numbers.

use crate::figure::drawing::Drawing;
use crate::figure::plan::PlanView;
use crate::figure::scale::{round_step, ticks};
use ddl_core::{Position, bounds};

/// Smallest width of the shown area, metres, for scenes in which all pedestrians stand still.
const LEAST_SPAN: f64 = 4.0;

/// Sizes of one kind of plot, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlotLayout {
    /// Least size of the plot: width, height.
    pub(super) smallest: [f64; 2],
    /// Largest size of the plot: width, height.
    pub(super) largest: [f64; 2],
    /// Space to the left of the plot and above it.
    pub(super) before: [f64; 2],
    /// Space to the right of the plot and below it.
    pub(super) after: [f64; 2],
    /// Margin around the points within the plot, share of the span.
    pub(super) margin: f64,
    /// Approximate number of grid steps on the longer side.
    pub(super) steps: f64,
}

/// One scene; the legend is on the right.
pub(super) const SCENE: PlotLayout = PlotLayout {
    smallest: [360.0, 270.0],
    largest: [720.0, 560.0],
    before: [62.0, 46.0],
    after: [258.0, 56.0],
    margin: 0.05,
    steps: 10.0,
};

/// One place; two lines of text are above it, the legend is on the right.
pub(super) const PLACE: PlotLayout = PlotLayout { before: [62.0, 66.0], after: [278.0, 56.0], ..SCENE };

#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    /// Lower left and upper right corner, metres.
    low: Position,
    high: Position,
    pub(super) plan: PlanView,
    layout: &'static PlotLayout,
}

impl Axes {
    pub(super) fn around(points: &[Position], layout: &'static PlotLayout) -> Self {
        // Without points only empty axes are drawn.
        let [low, high] = bounds(points.iter().copied()).unwrap_or([[0.0; 2]; 2]);
        let centre = [0, 1].map(|axis| f64::midpoint(low[axis], high[axis]));
        let fitting = |axis: usize| {
            let span: f64 = high[axis] - low[axis];
            span.max(LEAST_SPAN) * (1.0 + 2.0 * layout.margin)
        };
        let spans = [0, 1].map(fitting);
        let scale = (layout.largest[0] / spans[0]).min(layout.largest[1] / spans[1]);
        let half = [0, 1].map(|axis| 0.5 * spans[axis].max(layout.smallest[axis] / scale));
        Self {
            low: [0, 1].map(|axis| centre[axis] - half[axis]),
            high: [0, 1].map(|axis| centre[axis] + half[axis]),
            plan: PlanView { centre, middle: [0, 1].map(|axis| layout.before[axis] + scale * half[axis]), scale },
            layout,
        }
    }

    /// Size of plot and lettering together, pixels.
    pub(super) fn size(&self) -> [f64; 2] {
        let [from, to] = self.frame();
        [0, 1].map(|axis| self.layout.before[axis] + to[axis] - from[axis] + self.layout.after[axis])
    }

    /// Upper left and lower right corner of the plot, pixels.
    pub(super) fn frame(&self) -> [[f64; 2]; 2] {
        [self.plan.px([self.low[0], self.high[1]]), self.plan.px([self.high[0], self.low[1]])]
    }

    pub(super) fn draw(&self, drawing: &mut Drawing) {
        let [[left, top], [right, bottom]] = self.frame();
        let span = (self.high[0] - self.low[0]).max(self.high[1] - self.low[1]);
        let step = round_step(span / self.layout.steps);
        for (tick, label) in ticks(self.low[0], self.high[0], step) {
            let [x, _] = self.plan.px([tick, 0.0]);
            drawing.line("grid", [x, top], [x, bottom]);
            drawing.text("small middle", [x, bottom + 17.0], label);
        }
        for (tick, label) in ticks(self.low[1], self.high[1], step) {
            let [_, y] = self.plan.px([0.0, tick]);
            drawing.line("grid", [left, y], [right, y]);
            drawing.text("small end", [left - 8.0, y + 4.0], label);
        }
        drawing.rectangle("frame", self.frame());
    }

    pub(super) fn draw_names(&self, drawing: &mut Drawing) {
        let [[left, top], [right, bottom]] = self.frame();
        let across = [f64::midpoint(left, right), bottom + 40.0];
        drawing.text("middle", across, "x (m)");
        drawing.upward_text("middle", [left - 42.0, f64::midpoint(top, bottom)], "y (m)");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_metre_is_as_long_up_as_across() {
        for layout in [&SCENE, &PLACE] {
            let axes = Axes::around(&[[0.0, 0.0], [30.0, 2.0]], layout);
            let [a, b, c] = [[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]].map(|p| axes.plan.px(p));
            assert!(((b[0] - a[0]) - (a[1] - c[1])).abs() < 1e-9);
            let [from, to] = axes.frame();
            for corner in [[0.0, 0.0], [30.0, 2.0]] {
                let shown = axes.plan.px(corner);
                assert!((0..2).all(|axis| (from[axis]..=to[axis]).contains(&shown[axis])));
            }
        }
    }

    #[test]
    fn extreme_scenes_have_readable_axes() {
        for points in [vec![], vec![[5.0, -3.0]], vec![[-1e5, 0.0], [1e5, 0.0]]] {
            for layout in [&SCENE, &PLACE] {
                let axes = Axes::around(&points, layout);
                let [width, height] = axes.size();
                assert!(width <= 1100.0 && height < 800.0, "{width} x {height}");
                let mut drawing = Drawing::new(width, height, "");
                axes.draw(&mut drawing);
                let count = drawing.inline("").0.matches("small middle").count();
                assert!((2..=11).contains(&count), "{count} ticks");
            }
        }
    }
}
