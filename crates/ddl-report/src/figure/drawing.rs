//! A picture of fixed size whose shapes have classes instead of colours.

use svg::{
    Document, Node,
    node::element::{Circle, Group, Line, Path, Rectangle, SVG, Style, Text, Title},
};

/// The rules of `figure.css`; each colour in it is `var(--name, COLOUR ON WHITE)`.
pub(crate) const STYLE: &str = include_str!("figure.css");
pub(super) const PLOT_STYLE: &str = include_str!("plot.css");

#[derive(Debug, Clone)]
pub(crate) struct Drawing {
    width: f64,
    height: f64,
    title: String,
    data: Vec<(String, String)>,
    shapes: Group,
}

impl Drawing {
    pub(crate) fn new(width: f64, height: f64, title: impl Into<String>) -> Self {
        Self {
            width,
            height,
            title: printable(title),
            data: Vec::new(),
            shapes: Group::new(),
        }
    }

    /// Data of the picture for scripts: the attribute `data-NAME`.
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

    pub(crate) fn styled_path(&mut self, class: &str, points: &[[f64; 2]], style: &str) {
        self.outline(class, &outline(points), style);
    }

    pub(crate) fn polygon(&mut self, class: &str, points: &[[f64; 2]]) {
        self.outline(class, &(outline(points) + "Z"), "");
    }

    pub(crate) fn rectangle(&mut self, class: &str, [[left, top], [right, bottom]]: [[f64; 2]; 2]) {
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
        self.polygon(class, &corners);
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
        self.add(text(class, at, words));
    }

    pub(crate) fn upward_text(&mut self, class: &str, at: [f64; 2], words: &str) {
        let turn = format!("rotate(-90 {} {})", px(at[0]), px(at[1]));
        self.add(text(class, at, words).set("transform", turn));
    }

    pub(crate) fn within(&mut self, [[left, top], [right, bottom]]: [[f64; 2]; 2], draw: impl FnOnce(&mut Self)) {
        let around = std::mem::take(&mut self.shapes);
        draw(self);
        let inside = std::mem::replace(&mut self.shapes, around);
        let [left, top, width, height] = [left, top, right - left, bottom - top].map(px);
        let window = SVG::new()
            .set("x", left)
            .set("y", top)
            .set("width", width)
            .set("height", height)
            .set("viewBox", (left, top, width, height));
        self.add(window.add(inside));
    }

    /// Markup for a page that has the rules of [`STYLE`]; `class` is added to the class of the picture.
    pub(crate) fn inline(&self, class: &str) -> String {
        self.document(&format!("figure {class}"), None).to_string()
    }

    /// A separate file on a white background, with the rules for it; `rules` are added to those of [`STYLE`].
    pub(crate) fn to_file(&self, rules: &str) -> String {
        let style = on_white(STYLE) + &on_white(rules);
        let document = self.document("figure", Some(&style));
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

/// Approximate width of a text in pixels at this font size; the font of the reader is unknown.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    // A letter of a wide sans-serif font is about 0.56 of the font size wide.
    0.56 * size * text.chars().count() as f64
}

fn text(class: &str, at: [f64; 2], words: impl Into<String>) -> Text {
    Text::new(printable(words))
        .set("class", class)
        .set("x", px(at[0]))
        .set("y", px(at[1]))
}

/// Titles come from users, and XML does not allow control characters.
fn printable(words: impl Into<String>) -> String {
    words.into().replace(char::is_control, " ")
}

fn outline(points: &[[f64; 2]]) -> String {
    let step = |(at, point): (usize, &[f64; 2])| {
        let letter = if at == 0 { 'M' } else { 'L' };
        format!("{letter}{} {}", px(point[0]), px(point[1]))
    };
    points.iter().enumerate().map(step).collect()
}

/// Rounds to tenths of a pixel, which keeps the page small.
fn px(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// The rules with `var(--name, COLOUR)` replaced by the colour, since some SVG viewers do not support variables.
fn on_white(rules: &str) -> String {
    let mut resolved = String::with_capacity(rules.len());
    let mut rest = rules;
    while let Some((before, after)) = rest.split_once("var(") {
        resolved.push_str(before);
        let (variable, after) = after.split_once(')').unwrap_or((after, ""));
        let colour = variable.split_once(',').map_or(variable, |(_, colour)| colour);
        resolved.push_str(colour.trim());
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
        drawing.text("title", [0.0, 9.0], "x & y\u{7}");
        let file = drawing.to_file(".own { fill: var(--x, #010203); }");
        assert!(!file.contains("var(") && file.contains("stroke: #1d5fc2"));
        assert!(file.contains(".own { fill: #010203; }"));
        assert!(file.contains("<rect") && file.contains("a &lt; b") && file.contains("x &amp; y "));
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
