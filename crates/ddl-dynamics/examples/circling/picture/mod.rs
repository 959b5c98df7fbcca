//! What the picture shows, and where on the sheet.
//!
//! On the left the plane: the whole way, and the neighbourhood of the goal with the region in which a
//! plain Euler step does not approach it. On the right the distance to the goal over time.

mod distances;
mod paths;
pub(crate) mod scene;

use ddl_dynamics::{DynamicsError, Euler, StableEuler, Violation};

pub(crate) use scene::{STEPS, Scene, TIME_STEP, Walk};

use crate::drawing::{
    axes::{Decades, Plane},
    marks::{draw_euler, draw_goal, draw_stable},
    sheet::{INK, Pixel, Place, REGION, REGION_EDGE, Sheet, Stroke},
};

const SIZE: Pixel = [900.0, 604.0];
/// Where the legend stands, pixels from the top.
const LEGEND: f64 = 27.0;

/// The whole way.
pub(crate) const WHOLE: Plane = Plane {
    corner: [-0.3, 0.9],
    origin: [58.0, 84.0],
    size: [4.9, 1.6],
    scale: 82.0,
    grid: (0.5, 1),
};

/// Around the goal.
pub(crate) const NEAR: Plane = Plane {
    corner: [3.1, 0.42],
    origin: [58.0, 290.0],
    size: [1.44, 1.0],
    scale: 279.0,
    grid: (0.25, 2),
};

/// Distances over time.
pub(crate) const DISTANCES: Decades = Decades {
    frame: [[540.0, 84.0], [880.0, 569.0]],
    steps: STEPS,
    exponents: [1, -16],
};

/// The picture as the text of an SVG file; the same bytes each time.
pub(crate) fn draw(scene: &Scene) -> Result<String, DynamicsError> {
    let walks = [scene.follow(&Euler)?, scene.follow(&StableEuler)?];
    let mut sheet = Sheet::new(SIZE, "One flow, two integrators", &description(&walks));
    draw_legend(&mut sheet);
    paths::draw(&mut sheet, scene, &walks);
    distances::draw(&mut sheet, &walks);
    Ok(sheet.finish())
}

/// What is to be seen, for those who do not see it.
fn description([euler, stable]: &[Walk; 2]) -> String {
    let [swing, end] = [euler, stable].map(|walk| walk.certificate.final_potential());
    let names = match violation(euler) {
        Some((step, before, after)) => format!(
            "Its certificate names step {step}, from {before:.3} m before the goal to {after:.3} m behind it. "
        ),
        None => String::new(),
    };
    format!(
        "A walker is drawn from 4 m away to its goal in steps of {TIME_STEP} s. Euler steps jump over the goal and then to \
         and fro around it, {swing:.2} m away in the end. {names}StableEuler steps of the same flow are the same \
         until there, then end on the goal, {end} m away. Near the goal, the region is shaded in which no Euler step \
         approaches it."
    )
}

/// The first step of a walk that does not approach the goal, with the distances before and after it (m).
pub(crate) fn violation(walk: &Walk) -> Option<(usize, f64, f64)> {
    match walk.certificate.holds() {
        Err(Violation::NotDecreasing {
            step,
            before,
            after,
        }) => Some((step, before, after)),
        _ => None,
    }
}

fn draw_legend(sheet: &mut Sheet) {
    let sample = |left: f64| [0.0, 18.0, 36.0].map(|x| [left + x, LEGEND]);
    let name = |sheet: &mut Sheet, left, text: &str| {
        sheet.text([left, LEGEND], Place::RightOf, INK, text);
    };
    draw_euler(sheet, "legend-euler", &sample(64.0));
    name(sheet, 112.0, "Euler");
    draw_stable(sheet, "legend-stable", &sample(184.0));
    name(sheet, 230.0, "StableEuler");
    draw_goal(sheet, [353.0, LEGEND], 8.0);
    name(sheet, 369.0, "goal");
    let swatch = [(-14.0, -9.0), (14.0, -9.0), (14.0, 9.0), (-14.0, 9.0)];
    let swatch = swatch.map(|(x, y)| [452.0 + x, LEGEND + y]);
    sheet.area(&swatch, REGION, Stroke(REGION_EDGE, 1.0, "none"));
    let region = format!("where no Euler step of {TIME_STEP} s approaches the goal");
    name(sheet, 476.0, &region);
}
