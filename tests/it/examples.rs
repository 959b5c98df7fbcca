//! The example that draws the picture of the README.

use ddl_tests::place::Place;
use ddl_tests::program;
use std::path::Path;
use std::process::Command;

#[test]
fn the_picture_of_the_readme_is_drawn() {
    let place = Place::empty();
    place.write("sample.csv", include_str!("../../datasets/sample.csv"));
    let target = "-p ddl-forecast --example draw_forecast --features report".split(' ').collect::<Vec<_>>();
    let drawing = program::built(Path::new("examples/draw_forecast"), &target);
    let arguments = ["sample.csv", "15", "forecast.svg"];
    let drawn = Command::new(drawing).args(arguments).current_dir(place.path()).status();
    assert!(drawn.unwrap().success());
    let shapes = |svg: &str| ["<path", "<circle", "<text", "class"].map(|shape| svg.matches(shape).count());
    let of_readme = include_str!("../../docs/forecast.svg");
    assert_eq!(shapes(&place.text("forecast.svg")), shapes(of_readme));
}
