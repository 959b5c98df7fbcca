//! Walks, goals and headings, drawn the same wherever they appear.

use super::sheet::{EULER, GOAL, Pixel, STABLE, Sheet, Stroke};

/// Space between a plot and its heading, pixels.
const HEADING: f64 = 15.0;
/// Height of a line of text, pixels.
pub(crate) const LINE: f64 = 19.0;

/// Steps of `StableEuler`: a strong line through dots.
pub(crate) fn draw_stable(sheet: &mut Sheet, id: &str, points: &[Pixel]) {
    sheet.group(id, |sheet| {
        sheet.line(points, Stroke(STABLE, 2.6, "none"));
        for &at in points {
            sheet.dot(at, 3.4, STABLE);
        }
    });
}

/// Steps of `Euler`: a thin line through rings, seen also where it coincides with a stable one.
pub(crate) fn draw_euler(sheet: &mut Sheet, id: &str, points: &[Pixel]) {
    sheet.group(id, |sheet| {
        sheet.line(points, Stroke(EULER, 1.2, "none"));
        let ring = Stroke(EULER, 1.7, "none");
        for &at in points {
            sheet.ring(at, 5.4, ring);
        }
    });
}

pub(crate) fn draw_goal(sheet: &mut Sheet, at: Pixel, radius: f64) {
    sheet.ring(at, radius, Stroke(GOAL, 3.0, "none"));
}

/// The heading of a plot whose upper left corner is given.
pub(crate) fn draw_heading(sheet: &mut Sheet, [left, top]: Pixel, text: &str) {
    sheet.heading([left, top - HEADING], text);
}
