//! What the picture shows, and where on the sheet.
//!
//! Above, a walk around the end of a wall: what falls is the distance in the chart, not the distance.
//! Below, walks among pillars: what falls is the distance.

mod falling;
mod levels;
mod paths;
pub(crate) mod scene;
pub(crate) mod walk;

use crate::drawing::{
    axes::{Lengths, Plane},
    marks::{draw_goal, draw_stable},
    sheet::{INK, Pixel, Place, REGION, STABLE, Sheet, Stroke},
};
use scene::{PillarFlow, WallFlow};
pub(crate) use scene::{Scene, TIME_STEP, among_pillars, behind_a_wall};
use walk::falls;

const SIZE: Pixel = [900.0, 746.0];
/// Where the legend stands, pixels from the top.
const LEGEND: f64 = 27.0;

/// The path that was shown.
const SHOWN: Stroke = Stroke("#E3A9CB", 7.0, "13 9");
/// A line along which the distance in the chart is the same.
const LEVEL: Stroke = Stroke("#A3D8C6", 1.2, "none");
/// A walker who is drawn as a line.
const OTHER: Stroke = Stroke(STABLE, 1.2, "none");
/// Walls and pillars.
const SOLID: &str = "#8C8C8C";

/// Around the end of a wall.
pub(crate) const WALL: Plane = Plane {
    corner: [-1.1, 2.3],
    origin: [58.0, 84.0],
    size: [5.6, 3.5],
    scale: 87.0,
    grid: (1.0, 0),
};

/// Among pillars.
pub(crate) const PILLARS: Plane = Plane {
    corner: [-0.4, 1.8],
    origin: [58.0, 460.0],
    size: [7.0, 3.6],
    scale: 69.6,
    grid: (1.0, 0),
};

/// Over the steps of the walk around the wall.
fn wall_chart(scene: &Scene<WallFlow>) -> Lengths {
    chart(&WALL, scene.walk.steps(), &scene.walk.potentials)
}

/// Over the steps of the walk among pillars.
fn pillar_chart(scene: &Scene<PillarFlow>) -> Lengths {
    chart(&PILLARS, scene.walk.steps(), &scene.walk.distances)
}

/// As high as the plane that it stands beside.
fn chart(plane: &Plane, steps: usize, lengths: &[f64]) -> Lengths {
    let [[_, top], [_, bottom]] = plane.frame();
    Lengths {
        frame: [[614.0, top], [880.0, bottom]],
        steps,
        longest: lengths.iter().fold(0.0, |most, length| length.max(most)) + 0.4,
    }
}

/// The picture as the text of an SVG file; the same bytes each time.
pub(crate) fn draw(wall: &Scene<WallFlow>, pillars: &Scene<PillarFlow>) -> String {
    let description = description(wall, pillars);
    let mut sheet = Sheet::new(SIZE, "Around a wall and among pillars", &description);
    draw_legend(&mut sheet);
    paths::draw_wall(&mut sheet, wall);
    falling::draw_wall(&mut sheet, wall);
    paths::draw_pillars(&mut sheet, pillars);
    falling::draw_pillars(&mut sheet, pillars);
    sheet.finish()
}

/// What is to be seen, for those who do not see it.
fn description(wall: &Scene<WallFlow>, pillars: &Scene<PillarFlow>) -> String {
    let (_, angle) = wall.walk.largest_angle(&goal(wall));
    let steps = wall.walk.steps();
    let rises = steps - falls(&wall.walk.distances);
    format!(
        "Above: a goal {:.0} m away behind a wall. A walker in steps of {TIME_STEP} s goes around its end along a path that \
         was shown, at {:.0} degrees from the direction to the goal where it is worst, and ends on the goal after \
         {steps} steps; {} others from elsewhere end there too. The distance to the goal rises in {rises} of the \
         steps, the distance V of the images falls in {}. Below: {} walkers pass {} pillars, enter none, and end on one \
         goal; the distance of one of them falls in each of its {} steps.",
        wall.walk.distances[0],
        angle.to_degrees(),
        wall.others.len(),
        falls(&wall.walk.potentials),
        pillars.others.len() + 1,
        scene::PILLARS.len(),
        falls(&pillars.walk.distances),
    )
}

fn goal(scene: &Scene<impl ddl_dynamics::Flow<f64, 2>>) -> nalgebra::Vector2<f64> {
    *scene.flow.goal()
}

fn draw_legend(sheet: &mut Sheet) {
    let sample = |left: f64| [0.0, 18.0, 36.0].map(|x| [left + x, LEGEND]);
    let name = |sheet: &mut Sheet, left, text: &str| {
        sheet.text([left, LEGEND], Place::RightOf, INK, text);
    };
    draw_stable(sheet, "legend-walk", &sample(64.0));
    name(sheet, 110.0, &format!("steps of {TIME_STEP} s"));
    sheet.line(&sample(222.0), OTHER);
    name(sheet, 268.0, "other walkers");
    draw_goal(sheet, [390.0, LEGEND], 8.0);
    name(sheet, 406.0, "goal");
    sheet.line(&sample(460.0), SHOWN);
    name(sheet, 508.0, "path shown");
    sheet.line(&sample(612.0), LEVEL);
    name(sheet, 658.0, "equal V");
    sheet.dot([746.0, LEGEND], 10.0, REGION);
    sheet.dot([746.0, LEGEND], 5.0, SOLID);
    name(sheet, 762.0, "pillar, margin");
}
