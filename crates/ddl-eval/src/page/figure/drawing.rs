//! A picture of known size, made of shapes that carry classes and no colours.

use svg::{
    Document, Node,
    node::element::{Circle, Group, Line, Path, Rectangle, Style, Text, Title},
};

/// The rules of `figure.css`; each colour in it is `var(--name, COLOUR ON WHITE)`.
pub(crate) const STYLE: &str = include_str!("figure.css");

/// Shapes in pixels, y down.
#[derive(Debug, Clone)]
pub(crate) struct Drawing {
    width: f64,
    height: f64,
    title: String,
    data: Vec<(String, String)>,
    shapes: Group,
}

impl Drawing {
    /// An empty picture; the title is what is read out instead of it.
    pub(crate) fn new(width: f64, height: f64, title: impl Into<String>) -> Self {
        Self {
            width,
            height,
            title: title.into(),
            data: Vec::new(),
            shapes: Group::new(),
        }
    }

    /// Something a script wants to know of the picture: the attribute `data-NAME`.
    pub(crate) fn data(&mut self, name: &str, value: impl Into<String>) {
        self.data.push((format!("data-{name}"), value.into()));
    }

    fn add(&mut self, shape: impl Into<Box<dyn Node>>) {
        self.shapes.append(shape);
    }

    pub(crate) fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let line = Line::new()
            .set("class", class)
            .set("x1", px(from[0]))
            .set("y1", px(from[1]))
            .set("x2", px(to[0]))
            .set("y2", px(to[1]));
        self.add(line);
    }

    pub(crate) fn path(&mut self, class: &str, points: &[[f64; 2]]) {
        self.styled_path(class, points, "");
    }

    /// An open path; `style` is what varies from shape to shape, such as its opacity.
    pub(crate) fn styled_path(&mut self, class: &str, points: &[[f64; 2]], style: &str) {
        self.outline(class, &outline(points), style);
    }

    /// A closed path.
    pub(crate) fn polygon(&mut self, class: &str, points: &[[f64; 2]]) {
        self.outline(class, &(outline(points) + "Z"), "");
    }

    fn outline(&mut self, class: &str, outline: &str, style: &str) {
        let path = Path::new().set("class", class).set("d", outline);
        let path = if style.is_empty() {
            path
        } else {
            path.set("style", style)
        };
        self.add(path);
    }

    pub(crate) fn circle(&mut self, class: &str, at: [f64; 2], radius: f64) {
        self.styled_circle(class, at, radius, "");
    }

    pub(crate) fn styled_circle(&mut self, class: &str, at: [f64; 2], radius: f64, style: &str) {
        let circle = Circle::new()
            .set("class", class)
            .set("cx", px(at[0]))
            .set("cy", px(at[1]))
            .set("r", px(radius));
        let circle = if style.is_empty() {
            circle
        } else {
            circle.set("style", style)
        };
        self.add(circle);
    }

    pub(crate) fn text(&mut self, class: &str, at: [f64; 2], words: impl Into<String>) {
        let text = Text::new(words)
            .set("class", class)
            .set("x", px(at[0]))
            .set("y", px(at[1]));
        self.add(text);
    }

    /// Markup to stand in a page that has the rules of [`STYLE`]; `class` is added to that of the picture.
    pub(crate) fn inline(&self, class: &str) -> String {
        self.document(&format!("figure {class}"), None).to_string()
    }

    /// A file of its own: rules with the colours for white, and the white itself.
    pub(crate) fn to_file(&self) -> String {
        let document = self.document("figure", Some(&style_on_white()));
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{document}\n")
    }

    fn document(&self, class: &str, style: Option<&str>) -> Document {
        let mut document = Document::new()
            .set("class", class.trim_end())
            .set("viewBox", (0, 0, px(self.width), px(self.height)))
            .set("width", px(self.width))
            .set("height", px(self.height))
            .set("role", "img");
        for (name, value) in &self.data {
            document = document.set(name.as_str(), value.as_str());
        }
        document = document.add(Title::new(self.title.as_str()));
        if let Some(style) = style {
            let plate = Rectangle::new()
                .set("class", "plate")
                .set("width", "100%")
                .set("height", "100%");
            document = document.add(Style::new(style)).add(plate);
        }
        document.add(self.shapes.clone())
    }
}

fn outline(points: &[[f64; 2]]) -> String {
    let step = |(at, point): (usize, &[f64; 2])| {
        let letter = if at == 0 { 'M' } else { 'L' };
        format!("{letter}{} {}", px(point[0]), px(point[1]))
    };
    points.iter().enumerate().map(step).collect()
}

/// Tenths of a pixel are fine enough for lines, and keep the page small.
fn px(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// [`STYLE`] with `var(--name, COLOUR)` replaced by the colour: not every program that shows SVG knows variables.
fn style_on_white() -> String {
    let mut resolved = String::with_capacity(STYLE.len());
    let mut rest = STYLE;
    while let Some((before, after)) = rest.split_once("var(") {
        resolved.push_str(before);
        let (variable, after) = after.split_once(')').unwrap_or((after, ""));
        resolved.push_str(
            variable
                .split_once(',')
                .map_or(variable, |(_, colour)| colour)
                .trim(),
        );
        rest = after;
    }
    resolved + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_needs_no_variable_and_a_page_no_colour() {
        let mut drawing = Drawing::new(100.0, 50.0, "a < b");
        drawing.circle("goal", [1.04, 2.0], 3.0);
        drawing.text("title", [0.0, 9.0], "x & y");
        let file = drawing.to_file();
        assert!(!file.contains("var(") && file.contains("stroke: #1d5fc2"));
        assert!(file.contains("<rect") && file.contains("a &lt; b") && file.contains("x &amp; y"));
        let inline = drawing.inline("wide");
        assert!(inline.contains("class=\"figure wide\"") && !inline.contains('#'));
        assert!(inline.contains("cx=\"1\""));
    }

    #[test]
    fn every_colour_has_its_fallback() {
        assert!(STYLE.split("var(").skip(1).all(|rest| {
            let (variable, _) = rest.split_once(')').unwrap();
            variable.contains(", #")
        }));
    }
}
