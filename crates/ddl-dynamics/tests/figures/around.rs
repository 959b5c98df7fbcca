//! The picture of walks around a wall and among pillars shows what the rollouts do.

mod charts;
#[path = "../../examples/around/picture/mod.rs"]
mod picture;

use super::svg::{PIXEL, attributes, circles, group, lines};
use crate::drawing::axes::Plane;
use ddl_dynamics::{
    Attractor, AvoidingFlow, Ball, Chain, CholeskyMetric, DiffeomorphicFlow, Flow,
    LyapunovCertificate, NaturalGradientFlow, StableEuler, rollout,
};
use nalgebra::Vector2;
use picture::{
    PILLARS, Scene, WALL, among_pillars, behind_a_wall,
    scene::{PillarFlow, WallFlow},
};

type Pixel = [f64; 2];

fn scenes() -> (Scene<WallFlow>, Scene<PillarFlow>) {
    (behind_a_wall().unwrap(), among_pillars().unwrap())
}

fn drawn() -> String {
    let (wall, pillars) = scenes();
    picture::draw(&wall, &pillars)
}

/// The flow around the wall, built again.
fn wall_flow() -> WallFlow {
    let shown = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]].map(Vector2::from);
    let psi = Chain::straightening(&shown, 150).unwrap().chain;
    DiffeomorphicFlow::in_chart(Vector2::new(0.0, 1.0), psi, CholeskyMetric::identity()).unwrap()
}

/// The pillars as they are drawn (pixels).
fn drawn_pillars(svg: &str) -> Vec<Ball<f64, 2>> {
    let radii = attributes(group(svg, "pillars"), "r");
    let balls = circles(svg, "pillars").into_iter().zip(radii);
    let ball = |([x, y], radius): (Pixel, &str)| {
        Ball::new(Vector2::new(x, y), radius.parse().unwrap()).unwrap()
    };
    balls.map(ball).collect()
}

fn pillar_flow() -> AvoidingFlow<f64, 2, CholeskyMetric<f64, 2>, Vec<Ball<f64, 2>>> {
    let balls = picture::scene::PILLARS
        .iter()
        .map(|(centre, radius)| Ball::new(Vector2::from(*centre), *radius).unwrap());
    let metric = CholeskyMetric::planar(1.1, 0.0, 1.1, 1e-8).unwrap();
    let straight =
        NaturalGradientFlow::new(Attractor::new(Vector2::new(6.0, 0.0)).unwrap(), metric);
    AvoidingFlow::new(straight, balls.collect(), 0.5).unwrap()
}

/// Every walk of a plane: what is drawn of it, its length of a step (s), and where it starts (m).
fn walks<F>(svg: &str, id: &str, scene: &Scene<F>) -> Vec<(Vec<Pixel>, f64, Vector2<f64>)> {
    let mut walks = vec![(circles(svg, &format!("{id}-walk")), 0.4, scene.walk.path[0])];
    let others = lines(svg, &format!("{id}-others"));
    assert_eq!(others.len(), scene.others.len());
    for (line, walk) in others.into_iter().zip(&scene.others) {
        walks.push((line, 0.05, walk.path[0]));
    }
    walks
}

fn is_at([x, y]: Pixel, [u, v]: Pixel) -> bool {
    (x - u).abs() < PIXEL && (y - v).abs() < PIXEL
}

/// Where a position is to be drawn.
fn pixel(plane: &Plane, p: &Vector2<f64>) -> Pixel {
    let [left, top] = plane.origin;
    let [x, y] = plane.corner;
    [
        left + (p.x - x) * plane.scale,
        top + (y - p.y) * plane.scale,
    ]
}

/// Each walk is the rollout to its end, and ends on the goal.
fn assert_walks_are_rollouts(
    flow: &impl Flow<f64, 2>,
    walks: &[(Vec<Pixel>, f64, Vector2<f64>)],
    plane: &Plane,
) {
    for (points, time_step, start) in walks {
        let steps = points.len() - 1;
        let path = rollout(flow, &StableEuler, *start, *time_step, steps).unwrap();
        for (step, (point, position)) in points.iter().zip(&path).enumerate() {
            assert!(
                is_at(*point, pixel(plane, position)),
                "step {step} from {start}: drawn at {point:?}, is at {position}"
            );
        }
        assert_eq!(path[steps], *flow.goal(), "from {start}");
        assert_ne!(path[steps - 1], *flow.goal(), "rests are not drawn");
        let certificate = LyapunovCertificate::of_rollout(flow, &path, *time_step).unwrap();
        assert_eq!(certificate.holds(), Ok(()), "from {start}");
    }
}

#[test]
fn the_committed_picture_is_up_to_date() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/around.svg");
    let committed = std::fs::read_to_string(file).unwrap();
    assert!(
        committed == drawn(),
        "draw it anew: cargo run -p ddl-dynamics --example around -- docs/around.svg"
    );
}

#[test]
fn walks_around_the_wall_are_rollouts_that_end_on_the_goal() {
    let (svg, (scene, _)) = (drawn(), scenes());
    let walks = walks(&svg, "wall", &scene);
    assert_walks_are_rollouts(&wall_flow(), &walks, &WALL);
}

#[test]
fn walks_among_pillars_are_rollouts_that_end_on_the_goal() {
    let (svg, (_, scene)) = (drawn(), scenes());
    let walks = walks(&svg, "pillars", &scene);
    assert_walks_are_rollouts(&pillar_flow(), &walks, &PILLARS);
}

#[test]
fn everybody_stays_on_the_sheet() {
    let (svg, (wall, pillars)) = (drawn(), scenes());
    for (id, frame, walks) in [
        ("wall", WALL.frame(), walks(&svg, "wall", &wall)),
        ("pillars", PILLARS.frame(), walks(&svg, "pillars", &pillars)),
    ] {
        let [[left, top], [right, bottom]] = frame;
        for [x, y] in walks.iter().flat_map(|(points, ..)| points) {
            assert!(
                (left..right).contains(x) && (top..bottom).contains(y),
                "{id}: {x}, {y}"
            );
        }
    }
}

/// Not only the positions: the lines between them neither.
#[test]
fn no_pillar_is_entered() {
    let (svg, (_, scene)) = (drawn(), scenes());
    let pillars = drawn_pillars(&svg);
    assert_eq!(pillars.len(), 6);
    for (points, _, start) in walks(&svg, "pillars", &scene) {
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(Vector2::from);
            for pillar in &pillars {
                let (ahead, offset) = (to - from, pillar.centre() - from);
                let share = (offset.dot(&ahead) / ahead.norm_squared().max(1e-12)).clamp(0.0, 1.0);
                let distance = (offset - ahead * share).norm();
                assert!(
                    distance >= pillar.radius() + PIXEL,
                    "from {start}: {distance} of {} pixels",
                    pillar.radius()
                );
            }
        }
    }
}

/// The wall is the rectangle that is drawn; in every line a point each tenth of a pixel is looked at.
#[test]
fn nobody_walks_through_the_wall() {
    let (svg, (scene, _)) = (drawn(), scenes());
    let corners = &lines(&svg, "wall")[0];
    let bounds = |axis: usize| {
        let values = corners.iter().map(|corner| corner[axis]);
        let low = values.clone().fold(f64::INFINITY, f64::min);
        low..values.fold(f64::NEG_INFINITY, f64::max)
    };
    let (across, down) = (bounds(0), bounds(1));
    for (points, _, start) in walks(&svg, "wall", &scene) {
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(Vector2::from);
            let pieces = ((to - from).norm() * 10.0).ceil() as u32;
            for piece in 0..=pieces {
                let p = from.lerp(&to, f64::from(piece) / f64::from(pieces.max(1)));
                assert!(!(across.contains(&p.x) && down.contains(&p.y)), "{start}");
            }
        }
    }
}

#[test]
fn the_angle_written_is_the_largest_of_the_steps_drawn() {
    let svg = drawn();
    let points: Vec<_> = circles(&svg, "wall-walk")
        .into_iter()
        .map(Vector2::from)
        .collect();
    let goal = points[points.len() - 1];
    let angles = points
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).angle(&(goal - pair[0])).to_degrees());
    let largest = angles.fold(0.0, f64::max);
    let (before, _) = svg.split_once("\u{B0} away from the goal<").unwrap();
    let written = &before[before.rfind('>').unwrap() + 1..];
    let written: f64 = written.parse().unwrap();
    assert!((written - largest).abs() < 0.6, "{written} for {largest}");
    assert!(written > 120.0, "{written}");
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/stability.md");
    let caption = format!("at up to {written}\u{B0} from the direction");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains(&caption), "the caption is to say: {caption}");
}

/// On every line V is the same whole number of metres, to the hundredth of a pixel.
#[test]
fn lines_of_equal_v_are_where_they_are_drawn() {
    let (svg, flow) = (drawn(), wall_flow());
    let mut levels = Vec::new();
    for line in lines(&svg, "levels") {
        let potential = |[x, y]: &Pixel| {
            let [left, top] = WALL.origin;
            let x = WALL.corner[0] + (x - left) / WALL.scale;
            let y = WALL.corner[1] - (y - top) / WALL.scale;
            flow.potential(&Vector2::new(x, y))
        };
        let level = potential(&line[0]).round();
        levels.push(level as u32);
        for point in &line {
            let found = potential(point);
            assert!((found - level).abs() < 5e-3, "{found} m on {level} m");
        }
    }
    levels.dedup();
    let farthest = flow.potential(&Vector2::zeros()) as u32;
    assert_eq!(levels, (1..=farthest).collect::<Vec<_>>());
}

#[test]
fn readers_who_do_not_see_it_are_told_what_it_shows() {
    let svg = drawn();
    for element in ["<title id=", "<desc id=", "role=\"img\""] {
        assert!(svg.contains(element), "{element}");
    }
}
