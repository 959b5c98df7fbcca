//! What the shapes mean, beside the plot.

use super::{
    axes::Axes,
    canvas::{Canvas, FORECAST, GOAL, OBSERVED, Place, TRUTH},
};
use crate::error::FigureError;
use plotters::style::Color;

/// Which roles the picture has.
#[derive(Debug, Clone, Copy)]
pub(super) struct Roles {
    pub(super) truth: bool,
    pub(super) several: bool,
    pub(super) goals: bool,
}

/// Height of an entry, pixels.
const ENTRY: i32 = 46;
/// Length of a sample line, pixels.
const SAMPLE: i32 = 72;

pub(super) fn draw(canvas: &Canvas<'_>, axes: &Axes, roles: Roles) -> Result<(), FigureError> {
    let (left, top) = axes.beside();
    let right = left + SAMPLE;
    let middle = i32::midpoint(left, right);
    let mut y = top + ENTRY / 2;
    let mut entry = |text: &str| {
        let here = y;
        y += ENTRY;
        canvas
            .text(text, (right + 28, here), 26, Place::RightOf)
            .map(|()| here)
    };

    let y = entry("observed, 3.2 s")?;
    canvas.line(&[(left, y), (right, y)], OBSERVED.mix(0.5), 2)?;
    for x in [left, middle, right] {
        canvas.dot((x, y), OBSERVED, 6)?;
    }
    if roles.truth {
        let y = entry("truth, 4.8 s, and its end")?;
        canvas.line(&[(left, y), (right, y)], TRUTH, 5)?;
        canvas.dot((right, y), TRUTH, 9)?;
    }
    let y = entry(if roles.several {
        "most likely forecast"
    } else {
        "forecast"
    })?;
    canvas.dashes(&[(left, y), (right, y)], FORECAST, 5)?;
    canvas.star((right, y), FORECAST, 15)?;
    if roles.several {
        let y = entry("other hypotheses")?;
        for (line, opacity) in [(-8, 0.6), (0, 0.4), (8, 0.2)] {
            canvas.line(
                &[(left, y + line), (right, y + line)],
                FORECAST.mix(opacity),
                3,
            )?;
            canvas.dot((right, y + line), FORECAST.mix(opacity), 5)?;
        }
        entry("(the paler, the less likely)")?;
    }
    if roles.goals {
        let y = entry(if roles.several { "goals" } else { "goal" })?;
        canvas.ring((middle, y), GOAL, 11)?;
    }
    Ok(())
}
