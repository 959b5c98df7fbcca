//! Above: a path around the end of a wall; the distance in the chart falls, but not the distance in space. Below: paths
//! among pillars; the distance in space falls.

use ddl_dynamics::{
    Attractor, AvoidingFlow, Ball, Chain, CholeskyMetric, DiffeomorphicFlow, DynamicsError, Flow, NaturalGradientFlow,
    PUBLISHED_SIGMA, StableEuler, rollout,
};
use nalgebra::Vector2;

use crate::drawing::{GOAL, INK, Plot, STABLE, Sheet};

/// A demonstrated path to the end of a wall, around it, and back on its other side, to a goal 1 m away (metres).
const SHOWN: [[f64; 2]; 4] = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]];
const WALL: [[f64; 2]; 4] = [[-4.0, 0.4], [2.5, 0.4], [2.5, 0.6], [-4.0, 0.6]];
/// Centres of the pillars, their radius, and the distance from which an approach is slowed (metres).
const PILLARS: [[f64; 2]; 4] = [[1.5, 0.55], [2.7, -0.55], [3.6, 0.75], [4.3, -0.25]];
const RADIUS: f64 = 0.35;
const MARGIN: f64 = 0.5;

/// 69.6 pixels per metre.
const AROUND: Plot = Plot {
    frame: [[58.0, 84.0], [545.2, 334.56]],
    x: [-1.6, 5.4],
    y: [-1.3, 2.3],
    grid: [1.0, 1.0],
};
const AMONG: Plot = Plot {
    frame: [[58.0, 406.0], [545.2, 656.56]],
    x: [-0.4, 6.6],
    y: [-1.8, 1.8],
    grid: [1.0, 1.0],
};
const SHOWN_WAY: &str = "stroke='#E3A9CB' stroke-width='7' stroke-dasharray='13 9'";
const SOLID: &str = "fill='#8C8C8C'";

/// The start and the position after each step, up to the goal (metres).
type Way = Vec<Vector2<f64>>;

fn walked(flow: &impl Flow<f64, 2>, start: [f64; 2], dt: f64) -> Result<Way, DynamicsError> {
    let mut path = rollout(flow, &StableEuler, start.into(), dt, (60.0 / dt) as usize)?;
    path.dedup();
    Ok(path)
}

/// A flow, and a path that follows it in steps of 0.4 s, as in the published program.
pub(crate) struct Followed<F> {
    pub(crate) flow: F,
    pub(crate) path: Way,
}

impl<F: Flow<f64, 2>> Followed<F> {
    fn new(flow: F, start: [f64; 2]) -> Result<Self, DynamicsError> {
        let path = walked(&flow, start, 0.4)?;
        Ok(Self { flow, path })
    }

    fn others(&self, starts: [[f64; 2]; 4]) -> Result<Vec<Way>, DynamicsError> {
        let ways = starts.into_iter();
        ways.map(|start| walked(&self.flow, start, 0.05)).collect()
    }

    pub(crate) fn potentials(&self) -> impl Iterator<Item = f64> {
        let image = |p: &Vector2<f64>| self.flow.chart().map_or(*p, |psi| psi.apply(p));
        let images = self.path.iter().map(image);
        images.map(|image| self.flow.attractor().potential(&image))
    }

    /// Plots the potential and the distance (metres) over the steps, to the right of the plane.
    fn draw_falling(&self, sheet: &mut Sheet, heading: &str, plane: &Plot) {
        let [[_, top], [_, bottom]] = plane.frame;
        let chart = Plot {
            frame: [[614.0, top], [880.0, bottom]],
            x: [-0.5, self.path.len() as f64 - 0.5],
            y: [-0.3, self.path.len() as f64 / 2.5],
            grid: [5.0, 1.0],
        };
        chart.draw(sheet, heading, |sheet| {
            let distances = self.path.iter().map(|p| (p - self.flow.goal()).norm());
            let dashed = format!("stroke='{INK}' stroke-dasharray='4 4'");
            sheet.line(&chart.by_step(distances), &dashed);
            sheet.stable(&chart.by_step(self.potentials()));
        });
    }
}

pub(crate) fn behind_a_wall() -> Result<Followed<impl Flow<f64, 2>>, DynamicsError> {
    let psi = Chain::straightening(&SHOWN.map(Vector2::from), 150)?.chain;
    let flow = DiffeomorphicFlow::in_chart(SHOWN[3].into(), psi, CholeskyMetric::identity())?;
    Followed::new(flow, SHOWN[0])
}

/// A pedestrian that would go straight to the goal at 1.2 m/s without the pillars.
fn among_pillars() -> Result<Followed<impl Flow<f64, 2>>, DynamicsError> {
    let metric = CholeskyMetric::planar(1.1, 0.0, 1.1, PUBLISHED_SIGMA)?;
    let straight = NaturalGradientFlow::new(Attractor::new(Vector2::new(6.0, 0.0))?, metric);
    let pillars = PILLARS.map(|centre| Ball::new(centre.into(), RADIUS));
    let pillars = pillars.into_iter().collect::<Result<Vec<_>, _>>()?;
    Followed::new(AvoidingFlow::new(straight, pillars, MARGIN)?, [0.0, 0.6])
}

/// The picture as the text of an SVG file; deterministic.
pub(crate) fn draw() -> Result<String, DynamicsError> {
    let legend = [
        (58.0, STABLE, "\u{25CF} steps of 0.4 s"),
        (190.0, STABLE, "\u{2014} other starts"),
        (330.0, GOAL, "\u{25EF} goal"),
        (410.0, "#B0578D", "\u{2013} \u{2013} path shown"),
        (540.0, INK, "\u{25CF} pillar, in its margin"),
        (720.0, INK, "- - distance"),
    ];
    let title = "Around the end of a wall, and among pillars";
    let mut sheet = Sheet::new(692.0, title, &legend);
    let (wall, pillars) = (behind_a_wall()?, among_pillars()?);
    let others = wall.others([[-0.5, -0.5], [1.8, -1.0], [4.1, -0.4], [1.1, 1.8]])?;
    AROUND.draw(&mut sheet, "Around the end of a wall (axes in m)", |sheet| {
        sheet.line(&WALL.map(|corner| AROUND.pixel(corner)), SOLID);
        sheet.line(&SHOWN.map(|p| AROUND.pixel(p)), SHOWN_WAY);
        draw_ways(sheet, &AROUND, &wall.path, &others);
    });
    wall.draw_falling(&mut sheet, "V falls in every step (m)", &AROUND);
    let others = pillars.others([[0.0, -0.4], [0.2, -1.4], [2.0, 1.5], [3.4, -1.5]])?;
    AMONG.draw(&mut sheet, "Among pillars (axes in m)", |sheet| {
        let centres = PILLARS.map(|centre| AMONG.pixel(centre));
        sheet.circles(&centres, (RADIUS + MARGIN) * 69.6, "fill='#FBEBCB'");
        sheet.circles(&centres, RADIUS * 69.6, SOLID);
        draw_ways(sheet, &AMONG, &pillars.path, &others);
    });
    pillars.draw_falling(&mut sheet, "The distance falls in every step (m)", &AMONG);
    Ok(sheet.finish())
}

fn draw_ways(sheet: &mut Sheet, plane: &Plot, followed: &Way, others: &[Way]) {
    for other in others {
        let way = plane.path(other);
        sheet.line(&way, &format!("stroke='{STABLE}'"));
        sheet.circles(&way[..1], 2.6, &format!("fill='{STABLE}'"));
    }
    let steps = plane.path(followed);
    sheet.stable(&steps);
    sheet.goal(steps[steps.len() - 1], 8.0);
}
