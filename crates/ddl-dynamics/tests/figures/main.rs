//! The pictures of `docs/stability.md` are those that the examples draw, and show what the rollouts do.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod around;
mod circling;
#[path = "../../examples/drawing/mod.rs"]
mod drawing;

/// Coordinates are written to a hundredth of a pixel.
const PIXEL: f64 = 0.006;

/// A picture is that of the documentation, and says what it shows to those who do not see it.
fn assert_committed(file: &str, example: &str, svg: &str) {
    let path = format!("{}/../../docs/{file}", env!("CARGO_MANIFEST_DIR"));
    assert!(
        std::fs::read_to_string(path).unwrap() == svg,
        "draw it anew: cargo run -p ddl-dynamics --example {example} -- docs/{file}"
    );
    for element in ["<title id=", "<desc id=", "role=\"img\""] {
        assert!(svg.contains(element), "{element}");
    }
}

/// The values of an attribute in a group of the picture.
fn attributes<'a>(svg: &'a str, group: &str, name: &str) -> Vec<&'a str> {
    let (_, from) = svg.split_once(&format!("<g id=\"{group}\"")).unwrap();
    let (inside, _) = from.split_once("</g>").unwrap();
    let start = format!(" {name}=\"");
    let values = inside.split(&start).skip(1);
    values
        .map(|value| value.split_once('"').unwrap().0)
        .collect()
}

/// Points of the lines of a group, line by line (pixels).
fn lines(svg: &str, group: &str) -> Vec<Vec<[f64; 2]>> {
    let point = |pair: &str| {
        let (x, y) = pair.split_once(',').unwrap();
        [x, y].map(|text| text.parse().unwrap())
    };
    let lines = attributes(svg, group, "points");
    lines
        .iter()
        .map(|points| points.split(' ').map(point).collect())
        .collect()
}
