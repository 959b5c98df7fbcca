//! What a walker did: the same in every picture.

use ddl_data::Position;
use plotters::style::Color;

use super::{
    axes::Axes,
    canvas::{Canvas, OBSERVED, TRUTH},
    error::FigureError,
};

/// Draws the true path and a full dot at its last position; what lies outside the frame is left out.
///
/// `strength` is 1 for those the picture is about and less for the others.
pub(super) fn draw_truth(
    canvas: &Canvas<'_>,
    axes: &Axes,
    path: &[Position],
    strength: f64,
) -> Result<(), FigureError> {
    for piece in axes.cut(path) {
        canvas.line(&piece, TRUTH.mix(strength), 5)?;
    }
    if let Some(end) = path.last().and_then(|end| axes.shown(*end)) {
        canvas.dot(end, TRUTH.mix(strength), 9)?;
    }
    Ok(())
}

/// Draws the observed positions as dots on a thin line; what lies outside the frame is left out.
pub(super) fn draw_observed(
    canvas: &Canvas<'_>,
    axes: &Axes,
    path: &[Position],
    strength: f64,
) -> Result<(), FigureError> {
    for piece in axes.cut(path) {
        canvas.line(&piece, OBSERVED.mix(0.5 * strength), 2)?;
    }
    for dot in path.iter().filter_map(|p| axes.shown(*p)) {
        canvas.dot(dot, OBSERVED.mix(strength), 6)?;
    }
    Ok(())
}
