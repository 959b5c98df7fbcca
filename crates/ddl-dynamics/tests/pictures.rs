//! The pictures of `docs/stability.md` are current, and their caption agrees with them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "../examples/pictures/around.rs"]
mod around;
#[path = "../examples/pictures/circling.rs"]
mod circling;
#[path = "../examples/pictures/drawing.rs"]
mod drawing;

use std::fs;

use ddl_dynamics::Flow as _;

fn committed(file: &str) -> String {
    fs::read_to_string(format!("{}/../../docs/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn the_committed_pictures_are_current() {
    for (file, svg) in [
        ("stability.svg", circling::draw().unwrap()),
        ("around.svg", around::draw().unwrap()),
    ] {
        let advice = "draw them again: cargo run -p ddl-dynamics --example pictures -- docs";
        assert!(committed(file) == svg, "{file}: {advice}");
    }
}

/// The angle of the caption is the largest one, and `V` falls in every step.
#[test]
fn the_caption_agrees_with_the_pictures() {
    let followed = around::behind_a_wall().unwrap();
    assert!(followed.potentials().is_sorted_by(|before, after| before > after));
    let goal = followed.flow.goal();
    let steps = followed.path.windows(2);
    let angles = steps.map(|pair| (pair[1] - pair[0]).angle(&(goal - pair[0])));
    let largest = angles.fold(0.0, f64::max).to_degrees();
    let caption = format!("at up to {largest:.0}\u{B0} from the direction");
    assert!(
        committed("stability.md").contains(&caption),
        "the caption must contain: {caption}"
    );
}
