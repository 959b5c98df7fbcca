//! Above, the way around the end of a wall: what falls is the distance in the chart, not the distance. Below, ways
//! among pillars: what falls is the distance.

use ddl_dynamics::{
    Attractor, AvoidingFlow, Ball, Chain, CholeskyMetric, DiffeomorphicFlow, DynamicsError, Flow,
    NaturalGradientFlow, PUBLISHED_SIGMA, StableEuler, rollout,
};
use nalgebra::Vector2;

use crate::drawing::{INK, Pixel, Plot, STABLE, Sheet, ticks};

/// Seconds of a step of the pedestrian who is followed, those of the published program; and of those drawn as lines.
const TIME_STEP: f64 = 0.4;
const SHORT_STEP: f64 = 0.05;
/// Seconds after which the last one has arrived by far.
const LONGEST: f64 = 60.0;

/// Out to the end of a wall, around it, and back on its other side, to a goal 1 m away (metres).
const SHOWN: [[f64; 2]; 4] = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]];
/// Lower left and upper right corner of the wall, which goes on to the left (metres).
const WALL: [[f64; 2]; 2] = [[-4.0, 0.4], [2.5, 0.6]];
/// Centre and radius of each pillar (metres).
const PILLARS: [([f64; 2], f64); 6] = [
    ([1.5, 0.55], 0.35),
    ([2.7, -0.55], 0.4),
    ([3.6, 0.75], 0.35),
    ([4.3, -0.25], 0.3),
    ([1.2, -1.05], 0.25),
    ([5.0, 0.9], 0.25),
];
/// From this near on, an approach to a pillar is slowed (metres).
const MARGIN: f64 = 0.5;

/// At 87 and 69.6 pixels a metre.
const WALL_PLANE: Plot = Plot {
    frame: [[58.0, 84.0], [545.2, 388.5]],
    x: [-1.1, 4.5],
    y: [-1.2, 2.3],
};
const PILLAR_PLANE: Plot = Plot {
    frame: [[58.0, 460.0], [545.2, 710.56]],
    x: [-0.4, 6.6],
    y: [-1.8, 1.8],
};

/// The attributes of a way drawn as a line, of one that was shown, of a distance, of equal V, and of what is solid.
const OTHER: &str = "stroke='#0072B2' stroke-width='1.2'";
const SHOWN_WAY: &str =
    "stroke='#E3A9CB' stroke-width='7' stroke-dasharray='13 9' stroke-linecap='round'";
const DISTANCE: &str = "stroke='#444444' stroke-width='1.4' stroke-dasharray='4 4'";
const LEVEL: &str = "stroke='#A3D8C6' stroke-width='1.2'";
const SOLID: &str = "fill='#8C8C8C'";

/// A way to the goal.
pub(crate) struct Arrival {
    /// The start and the position after each step, to the first on the goal (metres).
    pub(crate) path: Vec<Vector2<f64>>,
    /// The potential of the flow and the distance to the goal at each position (metres).
    pub(crate) potentials: Vec<f64>,
    pub(crate) distances: Vec<f64>,
}

/// A flow, the way of one who is followed in steps of 0.4 s, and those of others in short steps.
pub(crate) struct Arrivals<F> {
    pub(crate) followed: Arrival,
    pub(crate) others: Vec<Arrival>,
    pub(crate) flow: F,
}

pub(crate) type AroundWall = DiffeomorphicFlow<f64, 2, Chain<f64, 2>, CholeskyMetric<f64, 2>>;
pub(crate) type AmongPillars = AvoidingFlow<f64, 2, CholeskyMetric<f64, 2>, Vec<Ball<f64, 2>>>;

/// Pedestrians who follow the way shown, at 1 m/s on it.
pub(crate) fn behind_a_wall() -> Result<Arrivals<AroundWall>, DynamicsError> {
    let shown = SHOWN.map(Vector2::from);
    let psi = Chain::straightening(&shown, 150)?.chain;
    let flow = DiffeomorphicFlow::in_chart(shown[3], psi, CholeskyMetric::identity())?;
    let others = [
        [-0.5, -0.5],
        [1.8, -1.0],
        [3.3, -1.0],
        [4.1, -0.4],
        [1.1, 1.8],
        [-0.7, 1.7],
    ];
    Arrivals::new(flow, SHOWN[0], &others)
}

fn pillars() -> Result<Vec<Ball<f64, 2>>, DynamicsError> {
    let pillars = PILLARS.iter();
    pillars
        .map(|(centre, radius)| Ball::new(Vector2::from(*centre), *radius))
        .collect()
}

/// Pedestrians who would go straight to their goal at 1.2 m/s, were it not for the pillars.
fn among_pillars() -> Result<Arrivals<AmongPillars>, DynamicsError> {
    let metric = CholeskyMetric::planar(1.1, 0.0, 1.1, PUBLISHED_SIGMA)?;
    let straight = NaturalGradientFlow::new(Attractor::new(Vector2::new(6.0, 0.0))?, metric);
    let flow = AvoidingFlow::new(straight, pillars()?, MARGIN)?;
    let others = [
        [0.0, 1.3],
        [0.0, -0.4],
        [0.2, -1.4],
        [2.0, 1.5],
        [3.4, -1.5],
        [6.2, 1.5],
    ];
    Arrivals::new(flow, [0.0, 0.6], &others)
}

impl<F: Flow<f64, 2>> Arrivals<F> {
    fn new(flow: F, start: [f64; 2], others: &[[f64; 2]]) -> Result<Self, DynamicsError> {
        let arrival = |start: [f64; 2], time_step: f64| {
            let steps = (LONGEST / time_step) as usize;
            let mut path = rollout(&flow, &StableEuler, start.into(), time_step, steps)?;
            if let Some(steps) = path.iter().position(|p| p == flow.goal()) {
                path.truncate(steps + 1);
            }
            let image = |p: &Vector2<f64>| flow.chart().map_or(*p, |psi| psi.apply(p));
            let potential = |p: &Vector2<f64>| flow.attractor().potential(&image(p));
            Ok(Arrival {
                potentials: path.iter().map(potential).collect(),
                distances: path.iter().map(|p| (p - flow.goal()).norm()).collect(),
                path,
            })
        };
        let ways = others.iter().map(|start| arrival(*start, SHORT_STEP));
        Ok(Self {
            followed: arrival(start, TIME_STEP)?,
            others: ways.collect::<Result<_, DynamicsError>>()?,
            flow,
        })
    }

    fn draw(&self, sheet: &mut Sheet, id: &str, plane: &Plot) {
        sheet.group(&format!("{id}-others"), |sheet| {
            for other in &self.others {
                let points = plane.path(&other.path);
                sheet.line(&points, OTHER);
                sheet.circle(points[0], 2.6, &format!("fill='{STABLE}'"));
            }
        });
        sheet.stable(&format!("{id}-followed"), &plane.path(&self.followed.path));
        sheet.goal(plane.path(&[*self.flow.goal()])[0], 8.0);
    }
}

impl Arrival {
    pub(crate) fn steps(&self) -> usize {
        self.path.len() - 1
    }

    /// The step that leads away from the direction to the goal most, and the angle between both (radians).
    pub(crate) fn largest_angle(&self) -> (usize, f64) {
        let goal = self.path[self.steps()];
        let moves = self
            .path
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).angle(&(goal - pair[0])));
        let larger =
            |most: (usize, f64), next: (usize, f64)| if next.1 > most.1 { next } else { most };
        moves.enumerate().fold((0, 0.0), larger)
    }
}

/// How many of the steps lower the number.
pub(crate) fn falls(numbers: &[f64]) -> usize {
    numbers.windows(2).filter(|pair| pair[1] < pair[0]).count()
}

/// The picture as the text of an SVG file; the same bytes each time.
pub(crate) fn draw() -> Result<String, DynamicsError> {
    let (wall, pillars) = (behind_a_wall()?, among_pillars()?);
    let [steps, among] = [wall.followed.steps(), pillars.followed.steps()];
    let (_, angle) = wall.followed.largest_angle();
    let rises = steps - falls(&wall.followed.distances);
    let description = format!(
        "Above: the goal is 1 m away, behind a wall. A walker follows the path shown around its end, at up to {:.0} degrees from \
         the direction to the goal, and arrives after {steps} steps of {TIME_STEP} s. V, the distance in the chart, falls in \
         every step; the distance rises in {rises}. Walkers from elsewhere arrive too. Below: walkers among six pillars \
         to one goal. None is entered, and the distance falls in each of the {among} steps of one of them.",
        angle.to_degrees()
    );
    let title = "Around the end of a wall, and among pillars";
    let mut sheet = Sheet::new([900.0, 746.0], title, &description);
    draw_legend(&mut sheet);
    draw_wall(&mut sheet, &wall);
    draw_pillars(&mut sheet, &pillars);
    let (v, distances) = (&wall.followed.potentials, &wall.followed.distances);
    draw_falling(&mut sheet, "wall", 84.0, v, Some(distances));
    let distances = &pillars.followed.distances;
    draw_falling(&mut sheet, "pillars", 460.0, distances, None);
    Ok(sheet.finish())
}

fn draw_legend(sheet: &mut Sheet) {
    let sample = |left: f64| [0.0, 18.0, 36.0].map(|x| [left + x, 27.0]);
    sheet.stable("legend-stable", &sample(64.0));
    sheet.line(&sample(222.0), OTHER);
    sheet.goal([390.0, 27.0], 8.0);
    sheet.line(&sample(460.0), SHOWN_WAY);
    sheet.line(&sample(612.0), LEVEL);
    sheet.circle([746.0, 27.0], 10.0, "fill='#FBEBCB'");
    sheet.circle([746.0, 27.0], 5.0, SOLID);
    for (left, name) in [
        (110.0, "steps of 0.4 s"),
        (268.0, "other walkers"),
        (406.0, "goal"),
        (508.0, "path shown"),
        (658.0, "equal V"),
        (762.0, "pillar, margin"),
    ] {
        sheet.text([left, 27.0], "start", INK, name);
    }
}

fn draw_wall(sheet: &mut Sheet, wall: &Arrivals<AroundWall>) {
    let grid = [ticks(WALL_PLANE.x, 1.0, ""), ticks(WALL_PLANE.y, 1.0, "")];
    WALL_PLANE.draw(
        sheet,
        "Around the end of a wall (axes in m)",
        grid,
        |sheet| {
            sheet.group("levels", |sheet| draw_levels(sheet, wall));
            let [[left, low], [right, high]] = WALL;
            let corners = [[left, low], [right, low], [right, high], [left, high]];
            sheet.line(&corners.map(|corner| WALL_PLANE.pixel(corner)), SOLID);
            sheet.text(WALL_PLANE.pixel([-0.75, 0.5]), "start", "#FFFFFF", "wall");
            sheet.line(&SHOWN.map(|p| WALL_PLANE.pixel(p)), SHOWN_WAY);
            wall.draw(sheet, "wall", &WALL_PLANE);
            let (step, angle) = wall.followed.largest_angle();
            let from = wall.followed.path[step];
            sheet.line(&WALL_PLANE.path(&[from, SHOWN[3].into()]), DISTANCE);
            let [x, y] = WALL_PLANE.pixel([from.x, from.y]);
            let note = format!("{:.0}\u{B0} away from the goal", angle.to_degrees());
            sheet.text([x + 8.0, y + 22.0], "end", INK, &note);
        },
    );
}

/// The circles around the image of the goal, a metre apart, seen in space: `psi^-1(psi(p*) + r (cos a, sin a))`.
fn draw_levels(sheet: &mut Sheet, wall: &Arrivals<AroundWall>) {
    let Some(psi) = wall.flow.chart() else { return };
    for radius in 1..=wall.followed.potentials[0] as u32 {
        let mut line: Vec<Pixel> = Vec::new();
        for piece in 0..=2000 {
            let angle = f64::from(piece) / 2000.0 * std::f64::consts::TAU;
            let away = Vector2::new(angle.cos(), angle.sin()) * f64::from(radius);
            let [x, y] = WALL_PLANE.path(&[psi.inverse(&(wall.flow.attractor().goal() + away))])[0];
            let [[left, top], [right, bottom]] = WALL_PLANE.frame;
            if !(left - 9.0..right + 9.0).contains(&x) || !(top - 9.0..bottom + 9.0).contains(&y) {
                draw_level(sheet, &mut line);
            } else if line.last().is_none_or(|[u, v]| (x - u).hypot(y - v) > 4.0) {
                line.push([x, y]);
            }
        }
        draw_level(sheet, &mut line);
    }
}

fn draw_level(sheet: &mut Sheet, line: &mut Vec<Pixel>) {
    if line.len() > 1 {
        sheet.line(line, LEVEL);
    }
    line.clear();
}

fn draw_pillars(sheet: &mut Sheet, pillars: &Arrivals<AmongPillars>) {
    let grid = [
        ticks(PILLAR_PLANE.x, 1.0, ""),
        ticks(PILLAR_PLANE.y, 1.0, ""),
    ];
    PILLAR_PLANE.draw(sheet, "Among pillars (axes in m)", grid, |sheet| {
        for (id, beyond, look) in [
            ("margins", MARGIN, "fill='#FBEBCB'"),
            ("pillars", 0.0, SOLID),
        ] {
            sheet.group(id, |sheet| {
                for (centre, radius) in PILLARS {
                    sheet.circle(PILLAR_PLANE.pixel(centre), (radius + beyond) * 69.6, look);
                }
            });
        }
        pillars.draw(sheet, "pillars", &PILLAR_PLANE);
    });
}

/// Over the steps, what falls in each; and the distance beside it, where that is something else.
fn draw_falling(sheet: &mut Sheet, id: &str, top: f64, falling: &[f64], distance: Option<&[f64]>) {
    let steps = falling.len() - 1;
    let chart = Plot {
        frame: [
            [614.0, top],
            [880.0, top + if distance.is_some() { 304.5 } else { 250.56 }],
        ],
        x: [-0.5, steps as f64 + 0.5],
        y: [-0.3, falling[0] + 0.4],
    };
    let (heading, name) = match distance {
        Some(_) => ("What falls: V, not the distance", "V"),
        None => ("What falls: the distance itself", "distance"),
    };
    let grid = [ticks(chart.x, 5.0, ""), ticks(chart.y, 1.0, " m")];
    chart.draw(sheet, heading, grid, |sheet| {
        if let Some(distance) = distance {
            sheet.group(&format!("{id}-distance"), |sheet| {
                sheet.line(&chart.by_step(distance.iter().copied()), DISTANCE);
            });
            let note = format!("distance rises in {} steps", steps - falls(distance));
            sheet.text([624.0, chart.pixel([0.0, 0.5])[1]], "start", INK, &note);
        }
        sheet.stable(
            &format!("{id}-falling"),
            &chart.by_step(falling.iter().copied()),
        );
        let note = format!("{name} falls in {} of {steps} steps", falls(falling));
        sheet.text(
            [870.0, chart.pixel([0.0, falling[0].floor() - 0.5])[1]],
            "end",
            STABLE,
            &note,
        );
    });
}
