//! A picture of fixed size as SVG, whose shapes have classes instead of colours.

use maud::{Markup, PreEscaped, Render, html};

/// The rules of `figure.css`; each colour in it is `var(--name, COLOUR ON WHITE)`.
pub(crate) const STYLE: &str = include_str!("figure.css");
pub(super) const PLOT_STYLE: &str = include_str!("plot.css");
const NAMESPACE: &str = "http://www.w3.org/2000/svg";

#[derive(Debug, Clone)]
pub(crate) struct Drawing {
    size: [f64; 2],
    title: String,
    /// Markup of the shapes, one a line.
    shapes: String,
}

impl Drawing {
    pub(crate) fn new(width: f64, height: f64, title: impl Into<String>) -> Self {
        Self { size: [width, height], title: printable(title), shapes: String::new() }
    }

    fn add(&mut self, shape: &Markup) {
        shape.render_to(&mut self.shapes);
        self.shapes.push('\n');
    }

    pub(crate) fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let ([x1, y1], [x2, y2]) = (from.map(px), to.map(px));
        self.add(&html! { line class=(class) x1=(x1) y1=(y1) x2=(x2) y2=(y2) {} });
    }

    pub(crate) fn path(&mut self, class: &str, points: &[[f64; 2]]) {
        self.outline(class, &outline(points), None);
    }

    pub(crate) fn styled_path(&mut self, class: &str, points: &[[f64; 2]], style: &str) {
        self.outline(class, &outline(points), Some(style));
    }

    pub(crate) fn polygon(&mut self, class: &str, points: &[[f64; 2]]) {
        self.outline(class, &(outline(points) + "Z"), None);
    }

    pub(crate) fn rectangle(&mut self, class: &str, [[left, top], [right, bottom]]: [[f64; 2]; 2]) {
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
        self.polygon(class, &corners);
    }

    fn outline(&mut self, class: &str, outline: &str, style: Option<&str>) {
        self.add(&html! { path class=(class) d=(outline) style=[style] {} });
    }

    pub(crate) fn circle(&mut self, class: &str, centre: [f64; 2], radius: f64) {
        self.styled_circle(class, centre, radius, None);
    }

    pub(crate) fn styled_circle(&mut self, class: &str, centre: [f64; 2], radius: f64, style: Option<&str>) {
        let ([cx, cy], r) = (centre.map(px), px(radius));
        self.add(&html! { circle class=(class) cx=(cx) cy=(cy) r=(r) style=[style] {} });
    }

    pub(crate) fn text(&mut self, class: &str, start: [f64; 2], words: impl Into<String>) {
        self.turned_text(class, start, words, None);
    }

    pub(crate) fn upward_text(&mut self, class: &str, start: [f64; 2], words: &str) {
        let [x, y] = start.map(px);
        self.turned_text(class, start, words, Some(format!("rotate(-90 {x} {y})")));
    }

    fn turned_text(&mut self, class: &str, start: [f64; 2], words: impl Into<String>, transform: Option<String>) {
        let [x, y] = start.map(px);
        self.add(&html! { text class=(class) x=(x) y=(y) transform=[transform] { (printable(words)) } });
    }

    pub(crate) fn within(&mut self, [[left, top], [right, bottom]]: [[f64; 2]; 2], draw: impl FnOnce(&mut Self)) {
        let around = std::mem::take(&mut self.shapes);
        draw(self);
        let inside = std::mem::replace(&mut self.shapes, around);
        let [x, y, width, height] = [left, top, right - left, bottom - top].map(px);
        let shown = format!("{x} {y} {width} {height}");
        self.add(&html! {
            svg x=(x) y=(y) width=(width) height=(height) viewBox=(shown) { "\n" (PreEscaped(inside)) }
        });
    }

    /// Markup for a page that has the rules of [`STYLE`]; `class` is added to the class of the picture.
    pub(crate) fn inline(&self, class: &str) -> Markup {
        self.document(&format!("figure {class}"), None)
    }

    /// A separate file on a white background, with the rules for it; `rules` are added to those of [`STYLE`].
    pub(crate) fn to_file(&self, rules: &str) -> String {
        let style = on_white(STYLE) + &on_white(rules);
        let document = self.document("figure", Some(style)).into_string();
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{document}\n")
    }

    fn document(&self, class: &str, style: Option<String>) -> Markup {
        let [width, height] = self.size.map(px);
        html! {
            svg class=(class.trim_end()) viewBox=(format!("0 0 {width} {height}")) width=(width) height=(height)
                role="img" xmlns=(NAMESPACE)
            {
                title { (self.title) }
                "\n"
                @if let Some(style) = style {
                    style { (PreEscaped(style)) }
                    rect.plate width="100%" height="100%" {}
                    "\n"
                }
                (PreEscaped(&self.shapes))
            }
        }
    }
}

/// Approximate width of a text in pixels at this font size; the font of the reader is unknown.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    // A letter of a wide sans-serif font is about 0.56 of the font size wide.
    0.56 * size * text.chars().count() as f64
}

/// Titles come from users, and XML does not allow control characters.
fn printable(words: impl Into<String>) -> String {
    words.into().replace(char::is_control, " ")
}

fn outline(points: &[[f64; 2]]) -> String {
    let step = |(index, point): (usize, &[f64; 2])| {
        let letter = if index == 0 { 'M' } else { 'L' };
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
        let inline = drawing.inline("wide").into_string();
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
