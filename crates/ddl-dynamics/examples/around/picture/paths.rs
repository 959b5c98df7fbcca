//! The walks in the plane.

use nalgebra::Vector2;

use super::{
    OTHER, PILLARS, SHOWN, SOLID, Scene, WALL, levels,
    scene::{self, MARGIN, PillarFlow, WallFlow},
    walk::Walk,
};
use crate::drawing::{
    axes::Plane,
    marks::{draw_goal, draw_heading, draw_stable},
    sheet::{INK, PAPER, Pixel, Place, REGION, STABLE, Sheet, Stroke},
};

/// Radius of the ring around a goal, and of the dot at the start of another walker, pixels.
const GOAL_RADIUS: f64 = 8.0;
const START_RADIUS: f64 = 2.4;
/// Radius of the arc of an angle, pixels, and the pieces it is drawn in.
const ARC: f64 = 26.0;
const PIECES: u32 = 24;

pub(super) fn draw_wall(sheet: &mut Sheet, scene: &Scene<WallFlow>) {
    draw_heading(sheet, WALL.origin, "Around the end of a wall (axes in m)");
    sheet.clipped("levels", WALL.frame(), |sheet| levels::draw(sheet, scene));
    WALL.draw(sheet);
    let goal = super::goal(scene);
    sheet.clipped("wall", WALL.frame(), |sheet| {
        let [[left, low], [right, high]] = scene::WALL;
        let corners = [[left, low], [right, low], [right, high], [left, high]];
        let corners = corners.map(|corner| WALL.pixel(&corner.into()));
        sheet.area(&corners, SOLID, Stroke(SOLID, 0.0, "none"));
        let middle = Vector2::new(-0.6, f64::midpoint(low, high));
        sheet.text(WALL.pixel(&middle), Place::Centred, PAPER, "wall");
        let shown = scene::SHOWN.map(Vector2::from);
        sheet.line(&WALL.pixels(&shown), SHOWN);
    });
    draw_walks(sheet, "wall", &WALL, scene, &goal);
    draw_angle(sheet, &scene.walk, &goal);
}

pub(super) fn draw_pillars(sheet: &mut Sheet, scene: &Scene<PillarFlow>) {
    draw_heading(sheet, PILLARS.origin, "Among pillars (axes in m)");
    let circles = |sheet: &mut Sheet, wider: f64, colour| {
        for (centre, radius) in scene::PILLARS {
            let radius = (radius + wider) * PILLARS.scale;
            sheet.dot(PILLARS.pixel(&centre.into()), radius, colour);
        }
    };
    sheet.clipped("margins", PILLARS.frame(), |sheet| {
        circles(sheet, MARGIN, REGION);
    });
    PILLARS.draw(sheet);
    sheet.clipped("pillars", PILLARS.frame(), |sheet| {
        circles(sheet, 0.0, SOLID);
    });
    draw_walks(sheet, "pillars", &PILLARS, scene, &super::goal(scene));
}

fn draw_walks<F>(
    sheet: &mut Sheet,
    id: &str,
    plane: &Plane,
    scene: &Scene<F>,
    goal: &Vector2<f64>,
) {
    sheet.clipped(&format!("{id}-others"), plane.frame(), |sheet| {
        for walk in &scene.others {
            let points = plane.pixels(&walk.path);
            sheet.line(&points, OTHER);
            sheet.dot(points[0], START_RADIUS, STABLE);
        }
    });
    draw_stable(
        sheet,
        &format!("{id}-walk"),
        &plane.pixels(&scene.walk.path),
    );
    draw_goal(sheet, plane.pixel(goal), GOAL_RADIUS);
}

/// The largest angle between a step and the direction to the goal.
fn draw_angle(sheet: &mut Sheet, walk: &Walk, goal: &Vector2<f64>) {
    let (step, angle) = walk.largest_angle(goal);
    let from = walk.path[step];
    let fine = Stroke(INK, 1.0, "3 3");
    sheet.line(&WALL.pixels(&[from, *goal]), fine);
    let [x, y] = WALL.pixel(&from);
    let ahead = walk.path[step + 1] - from;
    let side = (ahead.perp(&(goal - from))).signum();
    let arc = |piece| {
        let turned = side * angle * f64::from(piece) / f64::from(PIECES);
        let direction = ahead.y.atan2(ahead.x) + turned;
        [x + ARC * direction.cos(), y - ARC * direction.sin()]
    };
    let arc: Vec<Pixel> = (0..=PIECES).map(arc).collect();
    sheet.line(&arc, Stroke(INK, 1.2, "none"));
    let note = format!("{:.0}\u{B0} away from the goal", angle.to_degrees());
    sheet.text_over_lines([x + 8.0, y + 22.0], Place::LeftOf, INK, &note);
}
