//! The picture of `docs/stability.md` is current.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "../examples/pictures/circling.rs"]
mod circling;
#[path = "../examples/pictures/drawing.rs"]
mod drawing;

use std::fs;

#[test]
fn the_committed_picture_is_current() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/stability.svg");
    let advice = "draw it again: cargo run -p ddl-dynamics --example pictures -- docs";
    assert!(
        fs::read_to_string(file).unwrap() == circling::draw().unwrap(),
        "{advice}"
    );
}
