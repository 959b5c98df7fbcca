//! One flow, two integrators: on the left the plane, whole and near the goal, with the region in which a plain Euler
//! step does not approach the goal; on the right the distance to the goal over time.

use ddl_dynamics::{
    Attractor, CholeskyMetric, DynamicsError, Euler, Flow as _, Integrator, LyapunovCertificate,
    NaturalGradientFlow, PUBLISHED_SIGMA, StableEuler, Violation, rollout,
};
use nalgebra::Vector2;

use crate::drawing::{INK, Pixel, Plot, STABLE, Sheet, ticks};

/// Seconds of a step, those of the published program.
const TIME_STEP: f64 = 0.4;
const STEPS: usize = 24;
/// Attributes of a region in which something else holds than outside.
const REGION: &str = "fill='#FBEBCB' stroke='#E69F00'";
/// Vermilion of Okabe and Ito.
const EULER: &str = "#D55E00";
/// Positions whose numbers are written near the goal.
const NUMBERED: std::ops::RangeInclusive<usize> = 9..=15;
/// Radius of the ring around the goal that is seen from near (pixels): two Euler positions lie within.
const NEAR_GOAL: f64 = 18.0;

/// The whole way, at 82 pixels a metre.
const WHOLE: Plot = Plot {
    frame: [[58.0, 84.0], [459.8, 215.2]],
    x: [-0.3, 4.6],
    y: [-0.7, 0.9],
};
/// Around the goal, at 279 pixels a metre.
const NEAR: Plot = Plot {
    frame: [[58.0, 290.0], [459.76, 569.0]],
    x: [3.1, 4.54],
    y: [-0.58, 0.42],
};
/// Decimal logarithms of distances over steps, and a row for 0 below all of them.
const DISTANCES: Plot = Plot {
    frame: [[540.0, 84.0], [880.0, 569.0]],
    x: [-0.5, STEPS as f64 + 0.5],
    y: [-17.5, 1.0],
};
const ZERO: f64 = -16.9;

/// A path of 24 steps, and what its certificate says.
struct Followed {
    path: Vec<Vector2<f64>>,
    certificate: LyapunovCertificate<f64>,
}

/// To a goal 4 m away at walking pace, 0.8 to 1.7 m/s, leaning to one side of the way.
fn flow() -> Result<NaturalGradientFlow<f64, 2, CholeskyMetric<f64, 2>>, DynamicsError> {
    let attractor = Attractor::new(Vector2::new(4.0, 0.0))?;
    let metric = CholeskyMetric::planar(1.1, 0.4, 1.1, PUBLISHED_SIGMA)?;
    Ok(NaturalGradientFlow::new(attractor, metric))
}

fn followed(integrator: &impl Integrator<f64, 2>) -> Result<Followed, DynamicsError> {
    let flow = flow()?;
    let path = rollout(&flow, integrator, Vector2::zeros(), TIME_STEP, STEPS)?;
    let certificate = LyapunovCertificate::of_rollout(&flow, &path, TIME_STEP)?;
    Ok(Followed { path, certificate })
}

/// How close to the goal a plain Euler step no longer approaches it, on the side of the unit vector `away` (metres):
/// `dt < 2 Phi u^T P u / |P u|^2` solved for `Phi`.
fn overshoot_radius(metric: &CholeskyMetric<f64, 2>, away: &Vector2<f64>) -> f64 {
    TIME_STEP * metric.apply(away).norm_squared() / (2.0 * metric.quadratic_form(away))
}

/// The first step of a path that does not approach the goal, with the distances before and after it (m).
fn violation(followed: &Followed) -> Option<(usize, f64, f64)> {
    match followed.certificate.holds() {
        Err(Violation::NotDecreasing {
            step,
            before,
            after,
        }) => Some((step, before, after)),
        _ => None,
    }
}

/// The picture as the text of an SVG file; the same bytes each time.
pub(crate) fn draw() -> Result<String, DynamicsError> {
    let (euler, stable) = (followed(&Euler)?, followed(&StableEuler)?);
    let [swing, end] = [&euler, &stable].map(|one| one.certificate.final_potential());
    let named = violation(&euler).map_or(String::new(), |(step, before, after)| {
        format!("Its certificate names step {step}, from {before:.3} m before the goal to {after:.3} m behind it. ")
    });
    let description = format!(
        "A walker is drawn from 4 m away to its goal in steps of {TIME_STEP} s. Euler steps jump over the goal and then to \
         and fro around it, {swing:.2} m away in the end. {named}StableEuler steps of the same flow are the same \
         until there, then end on the goal, {end} m away. Near the goal, the region is shaded in which no Euler step \
         approaches it."
    );
    let mut sheet = Sheet::new([900.0, 604.0], "One flow, two integrators", &description);
    draw_legend(&mut sheet);
    for (id, plot, step, goal, heading) in [
        (
            "whole",
            WHOLE,
            0.5,
            8.0,
            "One flow in steps of 0.4 s (axes in m)",
        ),
        ("near", NEAR, 0.25, NEAR_GOAL, "Near the goal"),
    ] {
        let grid = [ticks(plot.x, step, ""), ticks(plot.y, step, "")];
        let region = plot.path(&region()?);
        plot.draw(&mut sheet, heading, grid, |sheet| {
            sheet.line(&region, REGION);
            sheet.stable(&format!("{id}-stable"), &plot.path(&stable.path));
            draw_euler(sheet, &format!("{id}-euler"), &plot.path(&euler.path));
            sheet.goal(plot.pixel([4.0, 0.0]), goal);
            if id == "near" {
                number_steps(sheet, &euler);
            }
        });
    }
    draw_distances(&mut sheet, &euler, &stable);
    Ok(sheet.finish())
}

/// Steps of `Euler`: a thin line through rings, seen also where it coincides with a stable one.
fn draw_euler(sheet: &mut Sheet, id: &str, points: &[Pixel]) {
    sheet.group(id, |sheet| {
        sheet.line(points, &format!("stroke='{EULER}' stroke-width='1.2'"));
        for &at in points {
            sheet.circle(at, 5.4, &format!("stroke='{EULER}' stroke-width='1.7'"));
        }
    });
}

fn draw_legend(sheet: &mut Sheet) {
    let sample = |left: f64| [0.0, 18.0, 36.0].map(|x| [left + x, 27.0]);
    draw_euler(sheet, "legend-euler", &sample(64.0));
    sheet.stable("legend-stable", &sample(184.0));
    sheet.goal([353.0, 27.0], 8.0);
    let corners = [
        (438.0, 18.0),
        (466.0, 18.0),
        (466.0, 36.0),
        (438.0, 36.0),
        (438.0, 18.0),
    ];
    sheet.line(&corners.map(|(x, y)| [x, y]), REGION);
    for (left, name) in [
        (112.0, "Euler"),
        (230.0, "StableEuler"),
        (369.0, "goal"),
        (476.0, "where no Euler step of 0.4 s approaches the goal"),
    ] {
        sheet.text([left, 27.0], "start", INK, name);
    }
}

/// The outline of where a plain Euler step does not approach the goal (m).
fn region() -> Result<Vec<Vector2<f64>>, DynamicsError> {
    let flow = flow()?;
    let corner = |index: u32| {
        let angle = f64::from(index).to_radians() * 2.0;
        let away = Vector2::new(angle.cos(), angle.sin());
        flow.goal() + away * overshoot_radius(flow.source(), &away)
    };
    Ok((0..=180).map(corner).collect())
}

/// Numbers some positions by the steps made so far, beside the line that leads away from the goal.
fn number_steps(sheet: &mut Sheet, euler: &Followed) {
    let goal = NEAR.pixel([4.0, 0.0]);
    for step in NUMBERED {
        let [x, y] = NEAR.path(&euler.path[step..=step])[0];
        let away = Vector2::new(x - goal[0], y - goal[1]);
        // Within the ring of the goal there is no room.
        let far = (NEAR_GOAL + 13.0 - away.norm()).max(17.0);
        let aside = nalgebra::Rotation2::new(0.6) * away.normalize() * far;
        sheet.text(
            [x + aside.x, y + aside.y],
            "middle",
            EULER,
            &step.to_string(),
        );
    }
}

fn draw_distances(sheet: &mut Sheet, euler: &Followed, stable: &Followed) {
    let height = |distance: f64| {
        if distance > 0.0 {
            distance.log10()
        } else {
            ZERO
        }
    };
    let heights = |one: &Followed| DISTANCES.by_step(one.certificate.potentials().map(height));
    let mut up: Vec<_> = [("1 m", 0.0), ("1 mm", -3.0), ("0", ZERO)]
        .map(|(name, at)| (at, name.to_owned()))
        .into();
    for (raised, exponent) in [
        ("\u{2076}", -6.0),
        ("\u{2079}", -9.0),
        ("\u{B9}\u{B2}", -12.0),
        ("\u{B9}\u{2075}", -15.0),
    ] {
        up.push((exponent, format!("10\u{207B}{raised} m")));
    }
    let grid = [ticks(DISTANCES.x, 5.0, ""), up];
    DISTANCES.draw(
        sheet,
        "Distance to the goal after each step",
        grid,
        |sheet| {
            sheet.stable("distance-stable", &heights(stable));
            draw_euler(sheet, "distance-euler", &heights(euler));
            if let Some((step, before, after)) = violation(euler) {
                let [x, y] = DISTANCES.pixel([step as f64, before.log10()]);
                sheet.line(
                    &[[x + 7.0, y + 3.0], [x + 35.0, y + 21.0]],
                    &format!("stroke='{EULER}'"),
                );
                for (line, below) in [
                    (format!("step {step} is the first"), 24.0),
                    ("not to approach:".to_owned(), 43.0),
                    (format!("{before:.3} m to {after:.3} m"), 62.0),
                ] {
                    sheet.text([x + 40.0, y + below], "start", EULER, &line);
                }
            }
            let mut potentials = stable.certificate.potentials();
            if let Some(step) = potentials.position(|potential| potential <= 0.0) {
                let [x, floor] = DISTANCES.pixel([step as f64, ZERO]);
                let note = format!("on the goal after {step} steps");
                sheet.text([x - 12.0, floor - 13.0], "end", STABLE, &note);
            }
        },
    );
}
