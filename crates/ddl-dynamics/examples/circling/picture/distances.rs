//! The distance to the goal over time.

use super::{DISTANCES, Walk, violation};
use crate::drawing::{
    marks::{LINE, draw_euler, draw_heading, draw_stable},
    sheet::{EULER, Pixel, Place, STABLE, Sheet, Stroke},
};

pub(super) fn draw(sheet: &mut Sheet, [euler, stable]: &[Walk; 2]) {
    let heading = "Distance to the goal after each step";
    draw_heading(sheet, DISTANCES.frame[0], heading);
    DISTANCES.draw(sheet);
    draw_stable(sheet, "distance-stable", &pixels(stable));
    draw_euler(sheet, "distance-euler", &pixels(euler));
    if let Some((step, before, after)) = violation(euler) {
        let [x, y] = DISTANCES.pixel(step, before);
        let lines = [
            format!("step {step} is the first"),
            "not to approach:".to_owned(),
            format!("{before:.3} m to {after:.3} m"),
        ];
        let (left, top) = (x + 40.0, y + 24.0);
        let leader = [[x + 7.0, y + 3.0], [left - 5.0, top - 3.0]];
        sheet.line(&leader, Stroke(EULER, 1.0, "none"));
        for (below, line) in lines.iter().enumerate() {
            let at = [left, top + LINE * below as f64];
            sheet.text(at, Place::RightOf, EULER, line);
        }
    }
    let mut potentials = stable.certificate.potentials();
    if let Some(step) = potentials.position(|potential| potential <= 0.0) {
        let [x, floor] = DISTANCES.pixel(step, 0.0);
        let note = format!("on the goal after {step} steps");
        sheet.text([x - 12.0, floor - 13.0], Place::LeftOf, STABLE, &note);
    }
}

fn pixels(walk: &Walk) -> Vec<Pixel> {
    let distances = walk.certificate.potentials().enumerate();
    distances
        .map(|(step, distance)| DISTANCES.pixel(step, distance))
        .collect()
}
