//! The pictures of `docs/stability.md` are those that the example draws, and its caption says what they show.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "../examples/pictures/around.rs"]
mod around;
#[path = "../examples/pictures/circling.rs"]
mod circling;
#[path = "../examples/pictures/drawing.rs"]
mod drawing;

use std::fs;

fn committed(file: &str) -> String {
    fs::read_to_string(format!("{}/../../docs/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn the_committed_pictures_are_those_drawn() {
    for (file, svg) in [
        ("stability.svg", circling::draw().unwrap()),
        ("around.svg", around::draw().unwrap()),
    ] {
        let anew = "draw them anew: cargo run -p ddl-dynamics --example pictures -- docs";
        assert!(committed(file) == svg, "{file}: {anew}");
    }
}

/// The numbers written in the pictures hold for the rollouts: no way enters what is solid, `V` falls in every step, and
/// the angle of the caption is the largest one.
#[test]
fn the_ways_drawn_keep_clear_and_what_falls_falls() {
    let (wall, pillars) = (
        around::behind_a_wall().unwrap(),
        around::among_pillars().unwrap(),
    );
    let steps = wall.followed.steps();
    assert_eq!(around::falls(&wall.followed.potentials), steps);
    assert!(around::falls(&wall.followed.distances) < 2 * steps / 3);
    assert_eq!(
        around::falls(&pillars.followed.distances),
        pillars.followed.steps()
    );
    let [[left, low], [right, high]] = around::WALL;
    for way in wall.others.iter().chain([&wall.followed]) {
        let mut points = way.path.iter();
        let solid = points.any(|p| (left..right).contains(&p.x) && (low..high).contains(&p.y));
        assert!(!solid, "through the wall from {}", way.path[0]);
    }
    let balls = around::pillars().unwrap();
    for way in pillars.others.iter().chain([&pillars.followed]) {
        let mut gaps = balls
            .iter()
            .flat_map(|ball| way.path.iter().map(|p| ball.gap_and_normal(p).0));
        assert!(
            gaps.all(|gap| gap > 1e-4),
            "into a pillar from {}",
            way.path[0]
        );
    }
    let written = format!("{:.0}\u{B0}", wall.followed.largest_angle().1.to_degrees());
    let caption = format!("at up to {written} from the direction");
    assert!(
        committed("stability.md").contains(&caption),
        "the caption is to say: {caption}"
    );
}
