//! Goals as rings whose area is their probability.

use super::{
    canvas::{Canvas, FORECAST, GOAL, PAPER, Pixel},
    error::FigureError,
};

/// Radius of the ring of a certain goal, pixels: 5 % have 9.
const CERTAIN: f64 = 40.0;
/// No ring is smaller: goals of no weight are seen as well.
const SMALLEST: f64 = 4.0;
/// Length of the ticks around the nearest goal, pixels.
const TICK: i32 = 10;
/// Opacity of the lines behind the goals: a hundred on top of one another still let the grid be guessed.
pub(super) const EXPERT_OPACITY: f64 = 0.3;

/// Radius of the ring of a goal, pixels: `40 sqrt(w)`, at least 4.
fn radius(weight: f64) -> i32 {
    (CERTAIN * weight.sqrt()).max(SMALLEST).round() as i32
}

/// One goal of several.
pub(super) fn draw(canvas: &Canvas<'_>, at: Pixel, weight: f64) -> Result<(), FigureError> {
    canvas.ring(at, GOAL, radius(weight), 3)
}

/// The goal nearest the true end: a bold ring of the same area on a white rim, with four ticks around it
/// that are seen however small it is.
pub(super) fn draw_nearest(
    canvas: &Canvas<'_>,
    (x, y): Pixel,
    weight: f64,
) -> Result<(), FigureError> {
    let radius = radius(weight);
    canvas.ring((x, y), PAPER, radius + 4, 4)?;
    canvas.ring((x, y), FORECAST, radius, 5)?;
    let (from, to) = (radius + 5, radius + 5 + TICK);
    for (right, down) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
        let along = |distance: i32| (x + right * distance, y + down * distance);
        canvas.line(&[along(from), along(to + 2)], PAPER, 10)?;
        canvas.line(&[along(from), along(to)], FORECAST, 5)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_probability_is_twice_the_area() {
        let area = |weight| f64::from(radius(weight)).powi(2);
        assert!((area(0.8) / area(0.4) - 2.0).abs() < 0.1);
        assert!((area(0.2) / area(0.1) - 2.0).abs() < 0.2);
        assert_eq!((radius(0.0), radius(1.0)), (4, 40));
    }
}
