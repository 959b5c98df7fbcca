//! A map of a place: the density of tracks, and where tracks begin and end.

use crate::figure::axes::{Axes, PLACE};
use crate::figure::cut::cut;
use crate::figure::drawing::{Drawing, PLOT_STYLE};
use crate::figure::scale::round_step;
use crate::figure::traffic::{Ends, Traffic};
use ddl_core::Position;

/// Side of a square (m), if it is large enough in pixels.
const SIDE: f64 = 0.5;
/// Least side of a square, pixels.
const SMALLEST: f64 = 4.0;
/// Shades, from few tracks to many.
const SHADES: usize = 5;
/// Radius of the largest mark, pixels: that of the square in which most tracks begin or end.
const LARGEST_MARK: f64 = 15.0;
/// Least radius of a mark, so that one track is visible.
const SMALLEST_MARK: f64 = 2.2;
/// Height of a row of the legend, and width of a sample in it, pixels.
const ROW: f64 = 26.0;
const SAMPLE: f64 = 28.0;

/// Draws the tracks of one place as the text of an SVG file: how many cross each square of the ground, and where they
/// begin and end. The same input gives the same bytes.
///
/// # Shapes
/// `title` and `numbers` are lines above the picture; each track holds positions in metres, in temporal order.
pub fn place(title: &str, numbers: &str, tracks: &[Vec<Position>]) -> String {
    let axes = Axes::around(&tracks.concat(), &PLACE);
    let smallest = SMALLEST / axes.plan.scale;
    let side = if smallest <= SIDE { SIDE } else { round_step(smallest) };
    let traffic = Traffic::of(tracks, side);
    let [width, height] = axes.size();
    let mut drawing = Drawing::new(width, height, title);
    let [[left, top], [right, _]] = axes.frame();
    let across = width - left;
    let title = cut(title, 16.0, across);
    let numbers = cut(numbers, 12.0, across);
    drawing.text("heading", [left, top - 36.0], title);
    drawing.text("key", [left, top - 14.0], numbers);
    let shades = shades(traffic.crossed.values().copied().max().unwrap_or(0));
    let most = traffic.ends.values().map(|ends| ends.begun.max(ends.ended)).max().unwrap_or(0);
    axes.draw(&mut drawing);
    axes.draw_names(&mut drawing);
    drawing.within(axes.frame(), |drawing| {
        draw_squares(drawing, &axes, &traffic, &shades);
        draw_ends(drawing, &axes, &traffic, most);
    });
    let mut legend = Legend { drawing: &mut drawing, left: right + 20.0, y: top + 0.5 * ROW };
    legend.shades(&shades, side);
    legend.marks(most, 2.0 * side);
    drawing.to_file(PLOT_STYLE)
}

/// The least number of tracks of each shade: 1, then 1/25, 4/25, 9/25 and 16/25 of `most`.
fn shades(most: usize) -> Vec<usize> {
    let share = |shade: usize| (shade * shade * most).div_ceil(SHADES * SHADES).max(1);
    let mut least: Vec<usize> = (0..SHADES).map(share).collect();
    least.dedup();
    least
}

/// The CSS class of a shade. The last shade has the darkest class, for any number of shades.
fn shade_class(shade: usize, shades: &[usize]) -> String {
    format!("walked w{}", shade + SHADES - shades.len())
}

fn draw_squares(drawing: &mut Drawing, axes: &Axes, traffic: &Traffic, shades: &[usize]) {
    for (square, &count) in &traffic.crossed {
        let shade = shades.partition_point(|&least| least <= count).saturating_sub(1);
        let corner = |by: i64| square.map(|number| (number + by) as f64 * traffic.side);
        let [[left, bottom], [right, top]] = [corner(0), corner(1)].map(|corner| axes.plan.px(corner));
        drawing.rectangle(&shade_class(shade, shades), [[left, top], [right, bottom]]);
    }
}

fn draw_ends(drawing: &mut Drawing, axes: &Axes, traffic: &Traffic, most: usize) {
    let mut ends: Vec<_> = traffic.ends.iter().collect();
    // The largest first, so that a mark does not hide a smaller one.
    ends.sort_by_key(|(_, ends)| std::cmp::Reverse(ends.begun.max(ends.ended)));
    for (square, ends) in ends {
        let middle = square.map(|number| (number as f64 + 0.5) * 2.0 * traffic.side);
        draw_mark(drawing, axes.plan.px(middle), *ends, most);
    }
}

/// Two half discs whose areas are proportional to the counts, down to a least size: tracks that begin on the left,
/// tracks that end on the right.
fn draw_mark(drawing: &mut Drawing, centre: [f64; 2], ends: Ends, most: usize) {
    for (class, count, side) in [("come", ends.begun, -1.0), ("leave", ends.ended, 1.0)] {
        if count > 0 {
            drawing.polygon(class, &half_disc(centre, radius(count, most), side));
        }
    }
}

fn radius(count: usize, most: usize) -> f64 {
    (LARGEST_MARK * (count as f64 / most.max(1) as f64).sqrt()).max(SMALLEST_MARK)
}

fn half_disc([x, y]: [f64; 2], radius: f64, side: f64) -> Vec<[f64; 2]> {
    let corner = |part: u32| {
        let (sin, cos) = (15.0 * f64::from(part)).to_radians().sin_cos();
        [x + side * radius * sin, y - radius * cos]
    };
    (0..=12).map(corner).collect()
}

/// A column of samples with their labels.
struct Legend<'a> {
    drawing: &'a mut Drawing,
    left: f64,
    /// Vertical centre of the next row.
    y: f64,
}

impl Legend<'_> {
    fn shades(&mut self, shades: &[usize], side: f64) {
        self.heading("pedestrians in", side);
        for (shade, &least) in shades.iter().enumerate().rev() {
            let words = match shades.get(shade + 1) {
                None => format!("{least} and more"),
                Some(next) if *next == least + 1 => least.to_string(),
                Some(next) => format!("{least} to {}", next - 1),
            };
            let (left, y) = (self.left, self.y);
            let sample = [[left, y - 0.5 * ROW], [left + SAMPLE, y + 0.5 * ROW]];
            self.drawing.rectangle(&shade_class(shade, shades), sample);
            self.write(&words);
        }
        self.y += 0.5 * ROW;
    }

    fn marks(&mut self, most: usize, side: f64) {
        self.heading("tracks in", side);
        for (words, begun, ended) in [("begin there", most, 0), ("end there", 0, most)] {
            let centre = [self.left + 0.5 * SAMPLE, self.y];
            draw_mark(self.drawing, centre, Ends { begun, ended }, most);
            self.write(&format!("{most} {words}"));
            self.y += 0.3 * ROW;
        }
    }

    fn heading(&mut self, words: &str, side: f64) {
        let words = format!("{words} a square of {side} m");
        self.drawing.text("key", [self.left, self.y + 4.0], words);
        self.y += ROW;
    }

    fn write(&mut self, words: &str) {
        let start = [self.left + SAMPLE + 12.0, self.y + 4.0];
        self.drawing.text("key", start, words);
        self.y += ROW;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_tracks_has_one_shade() {
        for (most, expected) in [(0, vec![1]), (1, vec![1]), (3, vec![1, 2]), (50, vec![1, 2, 8, 18, 32])] {
            assert_eq!(shades(most), expected, "{most}");
        }
        assert!((1..2_000).all(|most| shades(most).len() <= SHADES));
    }

    #[test]
    fn what_is_drawn_depends_on_the_tracks_alone_and_has_a_size_for_any() {
        let track: Vec<Position> = (0..20).map(|t| [0.5 * f64::from(t), 1.0]).collect();
        let far = vec![[-1e7, -1e7], [1e7, 1e7]];
        for tracks in [vec![], vec![track.clone(); 3], vec![track, far]] {
            let drawn = place("a place", "3 tracks", &tracks);
            assert_eq!(drawn, place("a place", "3 tracks", &tracks));
            assert_eq!(drawn.contains("class=\"come\""), !tracks.is_empty());
            assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "{drawn}");
        }
    }
}
