//! Lines along which the distance in the chart is the same.

use std::f64::consts::TAU;

use ddl_dynamics::{Diffeomorphism, Flow};
use nalgebra::Vector2;

use super::{LEVEL, Scene, WALL, scene::WallFlow};
use crate::drawing::sheet::Sheet;

/// Metres between two levels.
const BETWEEN: f64 = 1.0;
/// Neighbours on a line are this near (metres), where halving their angle often enough allows it.
const NEAR: f64 = 0.05;
const HALVINGS: u32 = 8;
/// Arcs that a circle is cut into before any are halved.
const ARCS: u32 = 48;

/// The circles around the image of the goal, seen in space: `psi^-1(psi(p*) + r (cos a, sin a))`.
pub(super) fn draw(sheet: &mut Sheet, scene: &Scene<WallFlow>) {
    let Some(psi) = scene.flow.chart() else {
        return;
    };
    let farthest = scene.walk.potentials[0];
    let circles = (farthest / BETWEEN) as u32;
    for radius in (1..=circles).map(|circle| f64::from(circle) * BETWEEN) {
        let circle = Circle {
            psi,
            centre: *scene.flow.attractor().goal(),
            radius,
        };
        for run in circle.line().split(|p| !is_near_the_plot(p)) {
            if run.len() > 1 {
                sheet.line(&WALL.pixels(run), LEVEL);
            }
        }
    }
}

fn is_near_the_plot(p: &Vector2<f64>) -> bool {
    let ([x, y], [width, height]) = (WALL.corner, WALL.size);
    let from_centre = p - Vector2::new(x + width / 2.0, y - height / 2.0);
    from_centre.x.abs() < width / 2.0 + 0.2 && from_centre.y.abs() < height / 2.0 + 0.2
}

struct Circle<'a> {
    psi: &'a dyn Diffeomorphism<f64, 2>,
    centre: Vector2<f64>,
    radius: f64,
}

impl Circle<'_> {
    fn at(&self, angle: f64) -> Vector2<f64> {
        let away = Vector2::new(angle.cos(), angle.sin());
        self.psi.inverse(&(self.centre + away * self.radius))
    }

    /// Points all around.
    fn line(&self) -> Vec<Vector2<f64>> {
        let mut points = vec![self.at(0.0)];
        for arc in 0..ARCS {
            let [from, to] = [arc, arc + 1].map(|n| f64::from(n) / f64::from(ARCS) * TAU);
            self.extend(&mut points, [from, to], self.at(to), HALVINGS);
        }
        points
    }

    /// Goes on from the last point to `end`.
    fn extend(
        &self,
        points: &mut Vec<Vector2<f64>>,
        [from, to]: [f64; 2],
        end: Vector2<f64>,
        halvings: u32,
    ) {
        let last = points[points.len() - 1];
        if halvings == 0 || (end - last).norm() <= NEAR {
            points.push(end);
        } else {
            let middle = f64::midpoint(from, to);
            self.extend(points, [from, middle], self.at(middle), halvings - 1);
            self.extend(points, [middle, to], end, halvings - 1);
        }
    }
}
