//! The shapes that a picture is made of, as the text of an SVG file.

use std::fmt::Write as _;

/// Pixels from the left, pixels from the top.
pub(crate) type Pixel = [f64; 2];

/// Vermilion of Okabe and Ito.
pub(crate) const EULER: &str = "#D55E00";
/// Blue of Okabe and Ito.
pub(crate) const STABLE: &str = "#0072B2";
/// Bluish green of Okabe and Ito.
pub(crate) const GOAL: &str = "#009E73";
/// A region in which something else holds than outside: orange of Okabe and Ito, on paper.
pub(crate) const REGION: &str = "#FBEBCB";
/// Its edge.
pub(crate) const REGION_EDGE: &str = "#E69F00";
pub(crate) const PAPER: &str = "#FFFFFF";
pub(crate) const GRID: &str = "#E4E4E4";
pub(crate) const INK: &str = "#444444";

/// Size of the letters at a width of 900 pixels.
pub(crate) const LETTERS: f64 = 14.0;

/// How a text sits at its place, centred in height.
#[derive(Clone, Copy)]
pub(crate) enum Place {
    RightOf,
    LeftOf,
    Centred,
}

impl Place {
    fn anchor(self) -> &'static str {
        match self {
            Self::RightOf => "start",
            Self::LeftOf => "end",
            Self::Centred => "middle",
        }
    }
}

/// A line: colour, width in pixels, dashes.
#[derive(Clone, Copy)]
pub(crate) struct Stroke(
    pub(crate) &'static str,
    pub(crate) f64,
    pub(crate) &'static str,
);

/// A white sheet, so that the picture reads the same on light and dark pages.
pub(crate) struct Sheet(String);

impl Sheet {
    pub(crate) fn new([width, height]: Pixel, title: &str, description: &str) -> Self {
        Self(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" role=\"img\" aria-labelledby=\"title description\" \
             font-family=\"sans-serif\" font-size=\"{LETTERS}\" fill=\"none\">\n\
             <title id=\"title\">{title}</title>\n<desc id=\"description\">{description}</desc>\n\
             <rect width=\"{width}\" height=\"{height}\" rx=\"6\" fill=\"{PAPER}\"/>\n"
        ))
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.0.write_fmt(element);
        self.0.push('\n');
    }

    /// A named group of what `draw` draws.
    pub(crate) fn group(&mut self, id: &str, draw: impl FnOnce(&mut Self)) {
        self.push(format_args!("<g id=\"{id}\">"));
        draw(self);
        self.push(format_args!("</g>"));
    }

    /// A named group of which only what lies within the frame is seen.
    pub(crate) fn clipped(&mut self, id: &str, frame: [Pixel; 2], draw: impl FnOnce(&mut Self)) {
        let [[left, top], [right, bottom]] = frame;
        let (width, height) = (right - left, bottom - top);
        self.push(format_args!(
            "<clipPath id=\"{id}-frame\"><rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" \
             height=\"{height:.2}\"/></clipPath>\n<g id=\"{id}\" clip-path=\"url(#{id}-frame)\">"
        ));
        draw(self);
        self.push(format_args!("</g>"));
    }

    pub(crate) fn frame(&mut self, frame: [Pixel; 2], Stroke(colour, thick, dashes): Stroke) {
        let [[left, top], [right, bottom]] = frame;
        let (width, height) = (right - left, bottom - top);
        self.push(format_args!(
            "<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" \
             stroke=\"{colour}\" stroke-width=\"{thick}\" stroke-dasharray=\"{dashes}\"/>"
        ));
    }

    pub(crate) fn line(&mut self, points: &[Pixel], Stroke(colour, width, dashes): Stroke) {
        let points = listed(points);
        self.push(format_args!(
            "<polyline points=\"{points}\" stroke=\"{colour}\" stroke-width=\"{width}\" \
             stroke-dasharray=\"{dashes}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
        ));
    }

    /// A filled outline.
    pub(crate) fn area(&mut self, points: &[Pixel], fill: &str, Stroke(colour, width, _): Stroke) {
        let points = listed(points);
        self.push(format_args!(
            "<polygon points=\"{points}\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"{width}\"/>"
        ));
    }

    pub(crate) fn dot(&mut self, [x, y]: Pixel, radius: f64, colour: &str) {
        self.push(format_args!(
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"{colour}\"/>"
        ));
    }

    pub(crate) fn ring(&mut self, [x, y]: Pixel, radius: f64, Stroke(colour, width, _): Stroke) {
        self.push(format_args!(
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" stroke=\"{colour}\" stroke-width=\"{width}\"/>"
        ));
    }

    pub(crate) fn text(&mut self, [x, y]: Pixel, place: Place, colour: &str, text: &str) {
        let anchor = place.anchor();
        self.push(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" dy=\"0.35em\" text-anchor=\"{anchor}\" fill=\"{colour}\">{text}</text>"
        ));
    }

    /// A text on a rim of paper, which keeps it clear of the lines below.
    pub(crate) fn text_over_lines(&mut self, at: Pixel, place: Place, colour: &str, text: &str) {
        let ([x, y], anchor) = (at, place.anchor());
        self.push(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" dy=\"0.35em\" text-anchor=\"{anchor}\" stroke=\"{PAPER}\" \
             stroke-width=\"5\" stroke-linejoin=\"round\">{text}</text>"
        ));
        self.text(at, place, colour, text);
    }

    /// A text in bold letters that begins there.
    pub(crate) fn heading(&mut self, [x, y]: Pixel, text: &str) {
        self.push(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" dy=\"0.35em\" font-weight=\"bold\" fill=\"{INK}\">{text}</text>"
        ));
    }

    pub(crate) fn finish(mut self) -> String {
        self.0.push_str("</svg>\n");
        self.0
    }
}

fn listed(points: &[Pixel]) -> String {
    let pairs: Vec<String> = points
        .iter()
        .map(|[x, y]| format!("{x:.2},{y:.2}"))
        .collect();
    pairs.join(" ")
}
