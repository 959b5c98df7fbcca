//! What falls in each step of a walk, and what does not.

use super::{
    Scene, falls, pillar_chart,
    scene::{PillarFlow, WallFlow},
    wall_chart,
};
use crate::drawing::{
    axes::Lengths,
    marks::{draw_heading, draw_stable},
    sheet::{INK, Pixel, Place, STABLE, Sheet, Stroke},
};

/// A distance that rises before it falls.
const DISTANCE: Stroke = Stroke(INK, 1.4, "4 4");
/// Between a note and the left or right end of a chart, pixels.
const ASIDE: f64 = 10.0;

pub(super) fn draw_wall(sheet: &mut Sheet, scene: &Scene<WallFlow>) {
    let chart = wall_chart(scene);
    let walk = &scene.walk;
    draw_heading(sheet, chart.frame[0], "What falls: V, not the distance");
    chart.draw(sheet);
    let distances = pixels(&chart, &walk.distances);
    sheet.group("wall-distance", |sheet| sheet.line(&distances, DISTANCE));
    draw_stable(sheet, "wall-falling", &pixels(&chart, &walk.potentials));
    note_falling(sheet, &chart, &walk.potentials, "V");
    let note = format!(
        "distance rises in {} steps",
        walk.steps() - falls(&walk.distances)
    );
    let [left, _] = chart.frame[0];
    // Between the first two lines of the grid.
    let [_, below] = chart.pixel(0, 0.5);
    sheet.text([left + ASIDE, below], Place::RightOf, INK, &note);
}

pub(super) fn draw_pillars(sheet: &mut Sheet, scene: &Scene<PillarFlow>) {
    let chart = pillar_chart(scene);
    let distances = &scene.walk.distances;
    draw_heading(sheet, chart.frame[0], "What falls: the distance itself");
    chart.draw(sheet);
    draw_stable(sheet, "pillars-falling", &pixels(&chart, distances));
    note_falling(sheet, &chart, distances, "distance");
}

/// The name of what falls, and in how many steps, between the last two lines of the grid.
fn note_falling(sheet: &mut Sheet, chart: &Lengths, numbers: &[f64], name: &str) {
    let note = format!(
        "{name} falls in {} of {} steps",
        falls(numbers),
        numbers.len() - 1
    );
    let [_, [right, _]] = chart.frame;
    let [_, y] = chart.pixel(0, chart.longest.floor() - 0.5);
    sheet.text([right - ASIDE, y], Place::LeftOf, STABLE, &note);
}

fn pixels(chart: &Lengths, lengths: &[f64]) -> Vec<Pixel> {
    let lengths = lengths.iter().enumerate();
    lengths
        .map(|(step, length)| chart.pixel(step, *length))
        .collect()
}
