//! One flow with two integrators: the paths near the goal, the region where no plain Euler step approaches the goal,
//! and the distance to the goal over the steps.

use ddl_dynamics::{
    Attractor, CholeskyMetric, DynamicsError, Euler, NaturalGradientFlow, PUBLISHED_SIGMA, StableEuler, rollout,
};
use nalgebra::{Rotation2, Vector2};

use crate::drawing::{GOAL, INK, Pixel, Plot, STABLE, Sheet};

const TIME_STEP: f64 = 0.4;
const STEPS: usize = 24;
/// The vermilion of Okabe and Ito.
const EULER: &str = "#D55E00";
const REGION: &str = "fill='#FBEBCB' stroke='#E69F00'";

const NEAR: Plot = Plot {
    frame: [[58.0, 84.0], [459.76, 363.0]],
    x: [3.1, 4.54],
    y: [-0.58, 0.42],
    grid: [0.25, 0.25],
};
const DISTANCES: Plot = Plot {
    frame: [[540.0, 84.0], [880.0, 363.0]],
    x: [-0.5, STEPS as f64 + 0.5],
    y: [-18.6, 1.2],
    grid: [5.0, 3.0],
};

pub(crate) fn draw() -> Result<String, DynamicsError> {
    // To a goal 4 m away at walking pace, 0.8 to 1.7 m/s, deviating to one side of the straight line.
    let goal = Vector2::new(4.0, 0.0);
    let metric = CholeskyMetric::planar(1.1, 0.4, 1.1, PUBLISHED_SIGMA)?;
    let flow = NaturalGradientFlow::new(Attractor::new(goal)?, metric);
    let euler = rollout(&flow, &Euler, Vector2::zeros(), TIME_STEP, STEPS)?;
    let stable = rollout(&flow, &StableEuler, Vector2::zeros(), TIME_STEP, STEPS)?;
    let legend = [
        (58.0, EULER, "\u{25CB} Euler"),
        (140.0, STABLE, "\u{25CF} StableEuler"),
        (270.0, GOAL, "\u{25EF} goal"),
        (345.0, "#E69F00", "\u{25A0}"),
        (363.0, INK, "where no Euler step of 0.4 s approaches the goal"),
    ];
    let mut sheet = Sheet::new(398.0, "One flow, two integrators", &legend);
    // In the direction of the unit vector `u` a plain Euler step approaches the goal if `dt < 2 Phi u^T P u / |P u|^2`.
    let outline = (0..=180).map(|index| {
        let u = Rotation2::new(f64::from(2 * index).to_radians()) * Vector2::x();
        let quotient = metric.apply(&u).norm_squared() / metric.quadratic_form(&u);
        goal + u * TIME_STEP * quotient / 2.0
    });
    let outline: Vec<_> = outline.collect();
    NEAR.draw(&mut sheet, "Near the goal (axes in m)", |sheet| {
        sheet.line(&NEAR.path(&outline), REGION);
        sheet.stable(&NEAR.path(&stable));
        draw_euler(sheet, &NEAR.path(&euler));
        sheet.goal(NEAR.pixel([goal.x, goal.y]), 18.0);
        for (step, position) in euler.iter().enumerate().take(16).skip(9) {
            // Beside the line away from the goal, and outside its ring.
            let away = position - goal;
            let far = (0.11 - away.norm()).max(0.06);
            let aside = Rotation2::new(-0.6) * away.normalize() * far;
            let label = NEAR.path(&[position + aside])[0];
            sheet.text(label, "middle", EULER, &step.to_string());
        }
    });
    let heading = "log10 of the distance in m (\u{2212}18: on the goal)";
    DISTANCES.draw(&mut sheet, heading, |sheet| {
        let by_step = |path: &[Vector2<f64>]| {
            let distances = path.iter().map(|position| (position - goal).norm());
            DISTANCES.by_step(distances.map(|distance| distance.log10().max(-18.0)))
        };
        sheet.stable(&by_step(&stable));
        draw_euler(sheet, &by_step(&euler));
    });
    Ok(sheet.finish())
}

/// Steps of `Euler`: a thin line through rings, visible also where it coincides with a stable one.
fn draw_euler(sheet: &mut Sheet, points: &[Pixel]) {
    sheet.line(points, &format!("stroke='{EULER}' stroke-width='1.2'"));
    sheet.circles(points, 5.4, &format!("stroke='{EULER}' stroke-width='1.7'"));
}
