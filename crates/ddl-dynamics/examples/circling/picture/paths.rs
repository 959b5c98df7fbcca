//! Both paths in the plane, whole and near the goal.

use nalgebra::Vector2;

use super::{NEAR, Scene, TIME_STEP, WHOLE, Walk};
use crate::drawing::{
    axes::Plane,
    marks::{draw_euler, draw_goal, draw_heading, draw_stable},
    sheet::{EULER, INK, Place, REGION, REGION_EDGE, Sheet, Stroke},
};

/// Corners of the outline of the region.
const CORNERS: u32 = 180;
/// Radius of the ring around the goal that is seen from near, pixels: two Euler positions lie within.
const NEAR_GOAL: f64 = 18.0;
/// Positions whose numbers are written near the goal.
const NUMBERED: [usize; 7] = [9, 10, 11, 12, 13, 14, 15];
/// How far from its position a number stands, pixels, and at which angle to the line away from the goal.
const AWAY: f64 = 17.0;
const BESIDE: f64 = 0.6;

pub(super) fn draw(sheet: &mut Sheet, scene: &Scene, [euler, stable]: &[Walk; 2]) {
    let places = [
        (
            "whole",
            WHOLE,
            8.0,
            format!("One flow in steps of {TIME_STEP} s (axes in m)"),
        ),
        ("near", NEAR, NEAR_GOAL, "Near the goal".to_owned()),
    ];
    for (id, plane, goal_radius, heading) in places {
        draw_heading(sheet, plane.origin, &heading);
        sheet.clipped(&format!("{id}-region"), plane.frame(), |sheet| {
            draw_region(sheet, scene, &plane);
        });
        plane.draw(sheet);
        sheet.clipped(&format!("{id}-paths"), plane.frame(), |sheet| {
            draw_stable(sheet, &format!("{id}-stable"), &plane.pixels(&stable.path));
            draw_euler(sheet, &format!("{id}-euler"), &plane.pixels(&euler.path));
            draw_goal(sheet, plane.pixel(scene.attractor.goal()), goal_radius);
        });
    }
    sheet.frame(NEAR.within(&WHOLE), Stroke(INK, 1.0, "3 3"));
    number_steps(sheet, scene, euler);
}

/// Numbers some positions of the Euler walk near the goal by the steps made so far, beside the line that
/// leads away from the goal.
fn number_steps(sheet: &mut Sheet, scene: &Scene, euler: &Walk) {
    let goal = NEAR.pixel(scene.attractor.goal());
    for step in NUMBERED {
        let [x, y] = NEAR.pixel(&euler.path[step]);
        let (right, down) = (x - goal[0], y - goal[1]);
        let length = right.hypot(down);
        let (sin, cos) = BESIDE.sin_cos();
        let aside = [right * cos - down * sin, right * sin + down * cos];
        // Within the ring of the goal there is no room.
        let far = AWAY.max(NEAR_GOAL + 13.0 - length) / length;
        let at = [x + aside[0] * far, y + aside[1] * far];
        sheet.text(at, Place::Centred, EULER, &step.to_string());
    }
}

/// Where a plain Euler step does not approach the goal.
fn draw_region(sheet: &mut Sheet, scene: &Scene, plane: &Plane) {
    let corner = |index| {
        let angle = f64::from(index) / f64::from(CORNERS) * std::f64::consts::TAU;
        let away = Vector2::new(angle.cos(), angle.sin());
        plane.pixel(&(scene.attractor.goal() + away * scene.overshoot_radius(&away)))
    };
    let outline: Vec<_> = (0..CORNERS).map(corner).collect();
    sheet.area(&outline, REGION, Stroke(REGION_EDGE, 1.0, "none"));
}
