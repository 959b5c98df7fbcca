//! Metres to pixels: the plane at one scale for both axes, and distances over steps, in metres or decades.

use nalgebra::Vector2;

use super::sheet::{GRID, INK, Pixel, Place, Sheet, Stroke};

/// Lines of the grid.
const FINE: Stroke = Stroke(GRID, 1.0, "none");
/// The frame around a plot.
const FRAME: Stroke = Stroke(INK, 1.2, "none");
/// Space between a frame and its numbers, pixels.
const GAP: f64 = 8.0;
const MINUS: &str = "\u{2212}";

/// A part of the plane.
#[derive(Clone, Copy)]
pub(crate) struct Plane {
    /// Upper left corner, metres and pixels.
    pub(crate) corner: [f64; 2],
    pub(crate) origin: Pixel,
    /// Across and down, metres.
    pub(crate) size: [f64; 2],
    /// Pixels a metre.
    pub(crate) scale: f64,
    /// Metres between two lines of the grid, and digits behind the point of their numbers.
    pub(crate) grid: (f64, usize),
}

impl Plane {
    pub(crate) fn pixel(&self, p: &Vector2<f64>) -> Pixel {
        [
            self.origin[0] + (p.x - self.corner[0]) * self.scale,
            self.origin[1] + (self.corner[1] - p.y) * self.scale,
        ]
    }

    pub(crate) fn pixels(&self, path: &[Vector2<f64>]) -> Vec<Pixel> {
        path.iter().map(|p| self.pixel(p)).collect()
    }

    /// Upper left and lower right corner, pixels.
    pub(crate) fn frame(&self) -> [Pixel; 2] {
        let [x, y] = self.origin;
        let [width, height] = self.size.map(|metres| metres * self.scale);
        [[x, y], [x + width, y + height]]
    }

    /// The corners of this part on another plot, pixels.
    pub(crate) fn within(&self, other: &Self) -> [Pixel; 2] {
        let [x, y] = self.corner;
        let far = Vector2::new(x + self.size[0], y - self.size[1]);
        [other.pixel(&Vector2::new(x, y)), other.pixel(&far)]
    }

    pub(crate) fn draw(&self, sheet: &mut Sheet) {
        let [[left, top], [right, bottom]] = self.frame();
        let (step, digits) = self.grid;
        let [x, y] = self.corner;
        for tick in ticks(x, x + self.size[0], step) {
            let [at, _] = self.pixel(&Vector2::new(tick, y));
            sheet.line(&[[at, top], [at, bottom]], FINE);
            let number = format!("{tick:.digits$}").replace('-', MINUS);
            sheet.text([at, bottom + 2.0 * GAP], Place::Centred, INK, &number);
        }
        for tick in ticks(y - self.size[1], y, step) {
            let [_, at] = self.pixel(&Vector2::new(x, tick));
            sheet.line(&[[left, at], [right, at]], FINE);
            let number = format!("{tick:.digits$}").replace('-', MINUS);
            sheet.text([left - GAP, at], Place::LeftOf, INK, &number);
        }
        sheet.frame(self.frame(), FRAME);
    }
}

/// Steps across; metres upwards from 0.
#[derive(Clone, Copy)]
pub(crate) struct Lengths {
    pub(crate) frame: [Pixel; 2],
    pub(crate) steps: usize,
    /// The top of the frame, metres.
    pub(crate) longest: f64,
}

impl Lengths {
    /// Pixels below 0, so that a dot there is seen whole.
    const FLOOR: f64 = 12.0;

    pub(crate) fn pixel(&self, step: usize, length: f64) -> Pixel {
        let [[_, top], [_, bottom]] = self.frame;
        let zero = bottom - Self::FLOOR;
        let y = zero - (zero - top) * length / self.longest;
        [across(self.frame, self.steps, step), y]
    }

    pub(crate) fn draw(&self, sheet: &mut Sheet) {
        let [[left, _], [right, _]] = self.frame;
        for length in ticks(0.0, self.longest, 1.0) {
            let [_, at] = self.pixel(0, length);
            sheet.line(&[[left, at], [right, at]], FINE);
            let number = format!("{length} m");
            sheet.text([left - GAP, at], Place::LeftOf, INK, &number);
        }
        number_steps(sheet, self.frame, self.steps);
        sheet.frame(self.frame, FRAME);
    }
}

/// Steps across; distances upwards, a power of ten each, with a row below all of them for 0.
#[derive(Clone, Copy)]
pub(crate) struct Decades {
    pub(crate) frame: [Pixel; 2],
    pub(crate) steps: usize,
    /// Exponents of the largest and the smallest distance shown.
    pub(crate) exponents: [i32; 2],
}

impl Decades {
    /// Height of one decade, pixels. The row of 0 takes one and a half.
    fn height(&self) -> f64 {
        let [[_, top], [_, bottom]] = self.frame;
        let [high, low] = self.exponents;
        (bottom - top) / (f64::from(high - low) + 1.5)
    }

    pub(crate) fn pixel(&self, step: usize, distance: f64) -> Pixel {
        let [_, [_, bottom]] = self.frame;
        let x = across(self.frame, self.steps, step);
        let above = |decades: f64| bottom - self.height() * decades;
        if distance > 0.0 {
            [
                x,
                above(distance.log10() - f64::from(self.exponents[1]) + 1.5),
            ]
        } else {
            [x, above(0.6)]
        }
    }

    pub(crate) fn draw(&self, sheet: &mut Sheet) {
        let [[left, _], [right, _]] = self.frame;
        let [high, low] = self.exponents;
        for exponent in (low..=high).filter(|exponent| exponent % 3 == 0) {
            let [_, at] = self.pixel(0, 10_f64.powi(exponent));
            sheet.line(&[[left, at], [right, at]], FINE);
            let number = match exponent {
                0 => "1 m".to_owned(),
                -3 => "1 mm".to_owned(),
                _ => format!("10{} m", raised(exponent)),
            };
            sheet.text([left - GAP, at], Place::LeftOf, INK, &number);
        }
        let [_, floor] = self.pixel(0, 0.0);
        sheet.line(&[[left, floor], [right, floor]], FINE);
        sheet.text([left - GAP, floor], Place::LeftOf, INK, "0");
        number_steps(sheet, self.frame, self.steps);
        sheet.frame(self.frame, FRAME);
    }
}

/// Where a step of `steps` lies, with half a step left free on both sides.
fn across([[left, _], [right, _]]: [Pixel; 2], steps: usize, step: usize) -> f64 {
    left + (right - left) * (step as f64 + 0.5) / (steps as f64 + 1.0)
}

/// Every fifth step: its line and its number.
fn number_steps(sheet: &mut Sheet, frame: [Pixel; 2], steps: usize) {
    let [[_, top], [_, bottom]] = frame;
    for step in (0..=steps).step_by(5) {
        let at = across(frame, steps, step);
        sheet.line(&[[at, top], [at, bottom]], FINE);
        let number = step.to_string();
        sheet.text([at, bottom + 2.0 * GAP], Place::Centred, INK, &number);
    }
}

fn ticks(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    // A corner on a line of the grid counts, whatever the rounding. Adding zero turns -0 into 0.
    let first = (low / step - 1e-9).ceil() as i32;
    let last = (high / step + 1e-9).floor() as i32;
    (first..=last).map(move |n| f64::from(n) * step + 0.0)
}

/// A number as an exponent.
fn raised(exponent: i32) -> String {
    let raise = |digit| match digit {
        '-' => '\u{207B}',
        '1' => '\u{B9}',
        '2' => '\u{B2}',
        '3' => '\u{B3}',
        // The other digits follow one another from the raised 0 on.
        _ => char::from_u32(0x2070 + u32::from(digit) - u32::from('0')).unwrap_or(digit),
    };
    exponent.to_string().chars().map(raise).collect()
}
