//! What the pictures of the documentation have in common: a sheet of SVG elements, plots on it, and how paths are
//! drawn.

use std::fmt::{Arguments, Write as _};

use nalgebra::Vector2;

/// Pixels from the left, pixels from the top.
pub(crate) type Pixel = [f64; 2];

/// Blue and bluish green of Okabe and Ito.
pub(crate) const STABLE: &str = "#0072B2";
const GOAL: &str = "#009E73";
pub(crate) const INK: &str = "#444444";
const GRID: &str = "stroke='#E4E4E4'";
/// Between a frame and its numbers (pixels).
const GAP: f64 = 8.0;

/// A white sheet, so that the picture reads the same on light and dark pages.
pub(crate) struct Sheet(String);

impl Sheet {
    pub(crate) fn new([width, height]: Pixel, title: &str, description: &str) -> Self {
        Self(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" role=\"img\" aria-labelledby=\"title description\" \
             font-family=\"sans-serif\" font-size=\"14\" fill=\"none\">\n\
             <title id=\"title\">{title}</title>\n<desc id=\"description\">{description}</desc>\n\
             <rect width=\"{width}\" height=\"{height}\" rx=\"6\" fill=\"#FFFFFF\"/>\n"
        ))
    }

    fn push(&mut self, element: Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.0, "{element}");
    }

    /// A named group of what `draw` draws.
    pub(crate) fn group(&mut self, id: &str, draw: impl FnOnce(&mut Self)) {
        self.push(format_args!("<g id=\"{id}\">"));
        draw(self);
        self.push(format_args!("</g>"));
    }

    pub(crate) fn line(&mut self, points: &[Pixel], attributes: &str) {
        let points = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}"));
        let points = points.collect::<Vec<_>>().join(" ");
        self.push(format_args!(
            "<polyline points=\"{points}\" stroke-linejoin=\"round\" {attributes}/>"
        ));
    }

    pub(crate) fn circle(&mut self, [x, y]: Pixel, radius: f64, attributes: &str) {
        self.push(format_args!(
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" {attributes}/>"
        ));
    }

    /// A text whose `anchor` (`start`, `middle` or `end`) is there.
    pub(crate) fn text(&mut self, [x, y]: Pixel, anchor: &str, colour: &str, text: &str) {
        self.push(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" dy=\"0.35em\" text-anchor=\"{anchor}\" fill=\"{colour}\">{text}</text>"
        ));
    }

    /// Steps of `StableEuler`: a strong line through dots.
    pub(crate) fn stable(&mut self, id: &str, points: &[Pixel]) {
        self.group(id, |sheet| {
            sheet.line(points, &format!("stroke='{STABLE}' stroke-width='2.6'"));
            for &at in points {
                sheet.circle(at, 3.4, &format!("fill='{STABLE}'"));
            }
        });
    }

    pub(crate) fn goal(&mut self, at: Pixel, radius: f64) {
        self.circle(at, radius, &format!("stroke='{GOAL}' stroke-width='3'"));
    }

    pub(crate) fn finish(mut self) -> String {
        self.0.push_str("</svg>\n");
        self.0
    }
}

/// A frame with its axes.
#[derive(Clone, Copy)]
pub(crate) struct Plot {
    /// Upper left and lower right corner (pixels).
    pub(crate) frame: [Pixel; 2],
    /// What is at the left and the right end, and at the lower and the upper one.
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
}

impl Plot {
    pub(crate) fn pixel(&self, [x, y]: [f64; 2]) -> Pixel {
        let [[left, top], [right, bottom]] = self.frame;
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        [
            left + (right - left) * share(x, self.x),
            bottom - (bottom - top) * share(y, self.y),
        ]
    }

    pub(crate) fn path(&self, path: &[Vector2<f64>]) -> Vec<Pixel> {
        path.iter().map(|p| self.pixel([p.x, p.y])).collect()
    }

    /// Values by the number of the step.
    pub(crate) fn by_step(&self, values: impl IntoIterator<Item = f64>) -> Vec<Pixel> {
        let values = values.into_iter().enumerate();
        values
            .map(|(step, value)| self.pixel([step as f64, value]))
            .collect()
    }

    /// The heading, lines of the grid with what is written at them, what `content` draws (of which only what lies
    /// within the frame is seen), and the frame.
    pub(crate) fn draw(
        &self,
        sheet: &mut Sheet,
        heading: &str,
        [across, up]: [Vec<(f64, String)>; 2],
        content: impl FnOnce(&mut Sheet),
    ) {
        let [[left, top], [right, bottom]] = self.frame;
        let (width, height) = (right - left, bottom - top);
        sheet.push(format_args!(
            "<text x=\"{left}\" y=\"{:.2}\" font-weight=\"bold\" fill=\"{INK}\">{heading}</text>",
            top - 10.0
        ));
        for (value, name) in across {
            let [at, _] = self.pixel([value, self.y[0]]);
            sheet.line(&[[at, top], [at, bottom]], GRID);
            sheet.text([at, bottom + 2.0 * GAP], "middle", INK, &name);
        }
        for (value, name) in up {
            let [_, at] = self.pixel([self.x[0], value]);
            sheet.line(&[[left, at], [right, at]], GRID);
            sheet.text([left - GAP, at], "end", INK, &name);
        }
        let place = format!("x=\"{left}\" y=\"{top}\" width=\"{width:.2}\" height=\"{height:.2}\"");
        sheet.push(format_args!(
            "<svg {place} viewBox=\"{left} {top} {width:.2} {height:.2}\">"
        ));
        content(sheet);
        sheet.push(format_args!(
            "</svg>\n<rect {place} stroke=\"{INK}\" stroke-width=\"1.2\"/>"
        ));
    }
}

/// The multiples of `step` from `low` to `high`, as they are written.
pub(crate) fn ticks([low, high]: [f64; 2], step: f64, unit: &str) -> Vec<(f64, String)> {
    // A corner on a line of the grid counts, whatever the rounding.
    let (first, last) = (
        (low / step - 1e-9).ceil() as i32,
        (high / step + 1e-9).floor() as i32,
    );
    let tick = |n: i32| f64::from(n) * step;
    let name = |n: i32| format!("{}{unit}", tick(n)).replace('-', "\u{2212}");
    (first..=last).map(|n| (tick(n), name(n))).collect()
}
