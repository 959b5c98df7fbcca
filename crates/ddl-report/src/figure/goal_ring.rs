//! Goals as rings whose area is their probability.

use super::drawing::Drawing;

/// Radius of the ring of a certain goal, pixels: 5 % have 5.4.
const CERTAIN: f64 = 24.0;
/// No ring is smaller: goals of no weight are seen as well.
const SMALLEST: f64 = 2.4;
/// Length of the ticks around the nearest goal, pixels.
const TICK: f64 = 6.0;

/// Radius of the ring of a goal, pixels: `24 sqrt(w)`, at least 2.4.
fn radius(weight: f64) -> f64 {
    (CERTAIN * weight.sqrt()).max(SMALLEST)
}

/// One goal of several.
pub(super) fn draw(drawing: &mut Drawing, at: [f64; 2], weight: f64) {
    drawing.circle("goal weighted", at, radius(weight));
}

/// The goal nearest the true end: a bold ring of the same area on a white rim, with four ticks around it
/// that are seen however small it is.
pub(super) fn draw_nearest(drawing: &mut Drawing, [x, y]: [f64; 2], weight: f64) {
    let radius = radius(weight);
    drawing.circle("rim", [x, y], radius);
    drawing.circle("nearest", [x, y], radius);
    let (from, to) = (radius + 3.0, radius + 3.0 + TICK);
    for [right, down] in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
        let along = |distance: f64| [x + right * distance, y + down * distance];
        drawing.line("rim", along(from), along(to + 1.2));
        drawing.line("nearest", along(from), along(to));
    }
}
