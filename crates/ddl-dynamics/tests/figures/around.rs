//! The picture of ways around a wall and among pillars.

#[path = "../../examples/around/picture.rs"]
mod picture;

use super::{PIXEL, assert_committed, attributes, lines};
use crate::drawing::Plot;
use ddl_dynamics::{Flow, LyapunovCertificate, StableEuler, rollout};
use nalgebra::Vector2;
use picture::{
    Arrivals, PILLAR_PLANE, TIME_STEP, WALL, WALL_PLANE, among_pillars, behind_a_wall, falls,
};

/// Every way of a plane, as it is drawn and in metres, is a rollout that ends on the goal, within the plane.
fn ways<F: Flow<f64, 2>>(
    svg: &str,
    id: &str,
    plane: &Plot,
    arrivals: &Arrivals<F>,
) -> Vec<Vec<Vector2<f64>>> {
    let [[left, top], [right, bottom]] = plane.frame;
    let scale = (right - left) / (plane.x[1] - plane.x[0]);
    let drawn = [
        lines(svg, &format!("{id}-followed")),
        lines(svg, &format!("{id}-others")),
    ]
    .concat();
    let arrivals_of = std::iter::once((&arrivals.followed, TIME_STEP));
    let all = arrivals_of.chain(arrivals.others.iter().map(|other| (other, 0.05)));
    assert_eq!(drawn.len(), 7);
    for (points, (arrival, time_step)) in drawn.iter().zip(all) {
        let (start, steps) = (arrival.path[0], points.len() - 1);
        let path = rollout(&arrivals.flow, &StableEuler, start, time_step, steps).unwrap();
        for ([x, y], p) in points.iter().zip(&path) {
            let off =
                (x - left - (p.x - plane.x[0]) * scale).hypot(y - top - (plane.y[1] - p.y) * scale);
            assert!(
                off < 1.5 * PIXEL,
                "from {start}: drawn at {x}, {y}, is at {p}"
            );
            assert!(
                (left..right).contains(x) && (top..bottom).contains(y),
                "off the sheet"
            );
        }
        assert_eq!(path[steps], *arrivals.flow.goal(), "from {start}");
        assert_ne!(
            path[steps - 1],
            *arrivals.flow.goal(),
            "rests are not drawn"
        );
        let certificate =
            LyapunovCertificate::of_rollout(&arrivals.flow, &path, time_step).unwrap();
        assert_eq!(certificate.holds(), Ok(()), "from {start}");
    }
    let metres = |[x, y]: &[f64; 2]| {
        Vector2::new(
            plane.x[0] + (x - left) / scale,
            plane.y[1] - (y - top) / scale,
        )
    };
    drawn
        .iter()
        .map(|points| points.iter().map(metres).collect())
        .collect()
}

/// A point on a way each millimetre: not only its positions.
fn all_points(way: &[Vector2<f64>]) -> impl Iterator<Item = Vector2<f64>> + '_ {
    way.windows(2).flat_map(|pair| {
        let pieces = ((pair[1] - pair[0]).norm() * 1000.0).ceil() as u32;
        (0..=pieces)
            .map(move |piece| pair[0].lerp(&pair[1], f64::from(piece) / f64::from(pieces.max(1))))
    })
}

#[test]
fn the_committed_picture_shows_what_the_rollouts_do() {
    let (wall, pillars) = (behind_a_wall().unwrap(), among_pillars().unwrap());
    let svg = picture::draw(&wall, &pillars);
    assert_committed("around.svg", "around", &svg);

    let [[left, low], [right, high]] = WALL;
    for way in ways(&svg, "wall", &WALL_PLANE, &wall) {
        let through = |p: &Vector2<f64>| (left..right).contains(&p.x) && (low..high).contains(&p.y);
        assert!(
            !all_points(&way).any(|p| through(&p)),
            "through the wall from {}",
            way[0]
        );
    }
    let balls = picture::pillars().unwrap();
    let radii = attributes(&svg, "pillars", "r");
    for (ball, radius) in balls.iter().zip(&radii) {
        assert!((ball.radius() * 69.6 - radius.parse::<f64>().unwrap()).abs() < 1e-9);
    }
    for way in ways(&svg, "pillars", &PILLAR_PLANE, &pillars) {
        let into = |p: Vector2<f64>| balls.iter().any(|ball| ball.gap_and_normal(&p).0 < 1e-4);
        assert!(!all_points(&way).any(into), "into a pillar from {}", way[0]);
    }

    let distances = &wall.followed.distances;
    let potentials: Vec<_> = wall
        .followed
        .path
        .iter()
        .map(|p| wall.flow.potential(p))
        .collect();
    let (steps, rises) = (
        wall.followed.steps(),
        wall.followed.steps() - falls(distances),
    );
    assert!(distances[1] > distances[0] && rises > steps / 3);
    let among = pillars.followed.steps();
    assert_eq!(
        (falls(&potentials), falls(&pillars.followed.distances)),
        (steps, among)
    );
    for note in [
        format!(">V falls in {steps} of {steps} steps<"),
        format!(">distance rises in {rises} steps<"),
        format!(">distance falls in {among} of {among} steps<"),
    ] {
        assert!(svg.contains(&note), "{note}");
    }
}

#[test]
fn the_angle_written_is_the_largest_of_the_steps_drawn() {
    let wall = behind_a_wall().unwrap();
    let svg = picture::draw(&wall, &among_pillars().unwrap());
    let drawn = lines(&svg, "wall-followed").remove(0);
    let points: Vec<_> = drawn.into_iter().map(Vector2::from).collect();
    let goal = points[points.len() - 1];
    let moves = points.windows(2);
    let angles = moves.map(|pair| (pair[1] - pair[0]).angle(&(goal - pair[0])).to_degrees());
    let written = format!("{:.0}\u{B0}", angles.fold(0.0, f64::max));
    assert!(
        svg.contains(&format!(">{written} away from the goal<")),
        "{written}"
    );
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/stability.md");
    let caption = format!("at up to {written} from the direction");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains(&caption), "the caption is to say: {caption}");
}

/// On every line V is the same whole number of metres, to the hundredth of a pixel.
#[test]
fn lines_of_equal_v_are_where_they_are_drawn() {
    let wall = behind_a_wall().unwrap();
    let svg = picture::draw(&wall, &among_pillars().unwrap());
    let [[left, top], _] = WALL_PLANE.frame;
    let mut levels = Vec::new();
    for line in lines(&svg, "levels") {
        let place =
            |[x, y]: &[f64; 2]| Vector2::new(-1.1 + (x - left) / 87.0, 2.3 - (y - top) / 87.0);
        let potentials: Vec<_> = line
            .iter()
            .map(|point| wall.flow.potential(&place(point)))
            .collect();
        let level = potentials[0].round();
        levels.push(level as u32);
        assert!(
            potentials.iter().all(|found| (found - level).abs() < 5e-3),
            "{level} m"
        );
    }
    levels.dedup();
    let farthest = wall.followed.potentials[0] as u32;
    assert_eq!(levels, (1..=farthest).collect::<Vec<_>>());
}
