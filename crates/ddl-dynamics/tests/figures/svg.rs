//! What is drawn, read back from the text of a picture.

/// Coordinates are written to a hundredth of a pixel.
pub(crate) const PIXEL: f64 = 0.006;

/// What is written between `<g id="group">` and the end of the group.
pub(crate) fn group<'a>(svg: &'a str, group: &str) -> &'a str {
    let start = svg.find(&format!("<g id=\"{group}\"")).unwrap();
    &svg[start..start + svg[start..].find("</g>").unwrap()]
}

/// The values of an attribute of all elements of a group that have it.
pub(crate) fn attributes<'a>(group: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!(" {name}=\"");
    let values = group.split(&start).skip(1);
    values
        .map(|value| &value[..value.find('"').unwrap()])
        .collect()
}

/// Centres of the circles of a group (pixels).
pub(crate) fn circles(svg: &str, name: &str) -> Vec<[f64; 2]> {
    let group = group(svg, name);
    let [x, y] = ["cx", "cy"].map(|name| attributes(group, name));
    let number = |text: &str| -> f64 { text.parse().unwrap() };
    let centres = x.iter().zip(&y);
    centres.map(|(x, y)| [number(x), number(y)]).collect()
}

/// Points of the lines of a group, line by line (pixels).
pub(crate) fn lines(svg: &str, name: &str) -> Vec<Vec<[f64; 2]>> {
    let point = |pair: &str| {
        let (x, y) = pair.split_once(',').unwrap();
        [x, y].map(|text| text.parse().unwrap())
    };
    let lines = attributes(group(svg, name), "points");
    lines
        .iter()
        .map(|points| points.split(' ').map(point).collect())
        .collect()
}
