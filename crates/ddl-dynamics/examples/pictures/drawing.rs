//! A sheet of SVG elements, and plots on it.

use nalgebra::Vector2;

/// Pixels from the left, pixels from the top.
pub(crate) type Pixel = [f64; 2];

/// The blue and bluish green of Okabe and Ito.
pub(crate) const STABLE: &str = "#0072B2";
pub(crate) const GOAL: &str = "#009E73";
pub(crate) const INK: &str = "#444444";

/// A white sheet, so that the picture looks the same on light and dark pages.
pub(crate) struct Sheet(Vec<String>);

impl Sheet {
    /// `legend`: for each entry the horizontal place, the colour and the text.
    pub(crate) fn new(height: f64, title: &str, legend: &[(f64, &str, &str)]) -> Self {
        let mut sheet = Self(vec![format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='900' height='{height}' viewBox='0 0 900 {height}' \
             role='img' font-family='sans-serif' font-size='14' fill='none' stroke-linejoin='round'>\n\
             <title>{title}</title>\n<rect width='900' height='{height}' rx='6' fill='#FFFFFF'/>"
        )]);
        for (left, colour, name) in legend {
            sheet.text([*left, 27.0], "start", colour, name);
        }
        sheet
    }

    pub(crate) fn line(&mut self, points: &[Pixel], attributes: &str) {
        let points = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}"));
        let points = points.collect::<Vec<_>>().join(" ");
        self.0.push(format!("<polyline points='{points}' {attributes}/>"));
    }

    pub(crate) fn circles(&mut self, centres: &[Pixel], radius: f64, attributes: &str) {
        for [x, y] in centres {
            self.0.push(format!(
                "<circle cx='{x:.2}' cy='{y:.2}' r='{radius:.2}' {attributes}/>"
            ));
        }
    }

    /// A text whose `anchor` (`start`, `middle` or `end`) is at this point.
    pub(crate) fn text(&mut self, [x, y]: Pixel, anchor: &str, colour: &str, text: &str) {
        let place = format!("x='{x:.2}' y='{y:.2}' dy='0.35em' text-anchor='{anchor}'");
        self.0.push(format!("<text {place} fill='{colour}'>{text}</text>"));
    }

    /// Steps of `StableEuler`: a strong line through dots.
    pub(crate) fn stable(&mut self, points: &[Pixel]) {
        self.line(points, &format!("stroke='{STABLE}' stroke-width='2.6'"));
        self.circles(points, 3.4, &format!("fill='{STABLE}'"));
    }

    pub(crate) fn goal(&mut self, centre: Pixel, radius: f64) {
        self.circles(&[centre], radius, &format!("stroke='{GOAL}' stroke-width='3'"));
    }

    pub(crate) fn finish(self) -> String {
        self.0.join("\n") + "\n</svg>\n"
    }
}

pub(crate) struct Plot {
    /// Upper left and lower right corner (pixels).
    pub(crate) frame: [Pixel; 2],
    /// Values at the left and right end, and at the lower and upper end.
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
    pub(crate) grid: [f64; 2],
}

impl Plot {
    pub(crate) fn pixel(&self, [x, y]: [f64; 2]) -> Pixel {
        let [[left, top], [right, bottom]] = self.frame;
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        let up = (bottom - top) * share(y, self.y);
        [left + (right - left) * share(x, self.x), bottom - up]
    }

    pub(crate) fn path(&self, path: &[Vector2<f64>]) -> Vec<Pixel> {
        path.iter().map(|p| self.pixel([p.x, p.y])).collect()
    }

    pub(crate) fn by_step(&self, values: impl Iterator<Item = f64>) -> Vec<Pixel> {
        let pixels = values
            .zip(0..)
            .map(|(value, step)| self.pixel([f64::from(step), value]));
        pixels.collect()
    }

    pub(crate) fn draw(&self, sheet: &mut Sheet, heading: &str, content: impl FnOnce(&mut Sheet)) {
        let [[left, top], [right, bottom]] = self.frame;
        let grey = "stroke='#E4E4E4'";
        let number = |value: f64| value.to_string().replace('-', "\u{2212}");
        sheet.text([left, top - 16.0], "start", INK, heading);
        for value in multiples(self.x, self.grid[0]) {
            let [at, _] = self.pixel([value, 0.0]);
            sheet.line(&[[at, top], [at, bottom]], grey);
            sheet.text([at, bottom + 16.0], "middle", INK, &number(value));
        }
        for value in multiples(self.y, self.grid[1]) {
            let [_, at] = self.pixel([0.0, value]);
            sheet.line(&[[left, at], [right, at]], grey);
            sheet.text([left - 8.0, at], "end", INK, &number(value));
        }
        let (width, height) = (right - left, bottom - top);
        let place = format!("x='{left}' y='{top}' width='{width:.2}' height='{height:.2}'");
        sheet
            .0
            .push(format!("<svg {place} viewBox='{left} {top} {width:.2} {height:.2}'>"));
        content(sheet);
        sheet.0.push(format!("</svg>\n<rect {place} stroke='{INK}'/>"));
    }
}

fn multiples([low, high]: [f64; 2], step: f64) -> impl Iterator<Item = f64> {
    let range = (low / step).ceil() as i32..=(high / step).floor() as i32;
    range.map(move |n| f64::from(n) * step)
}
