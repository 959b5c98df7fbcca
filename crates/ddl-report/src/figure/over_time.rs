//! Two curves of errors over time, one panel for each recording.

use crate::figure::cut::cut;
use crate::figure::drawing::{Drawing, PLOT_STYLE};
use crate::figure::scale::Scale;

const COLUMNS: usize = 3;
/// Margin of the picture, and horizontal and vertical space between panels, pixels.
const EDGE: f64 = 20.0;
const BETWEEN: [f64; 2] = [56.0, 66.0];
/// Size of the plot of a panel, and width of the labels on its left, pixels.
const PLOT: [f64; 2] = [270.0, 150.0];
const LEFT: f64 = 40.0;
/// Height of heading and legend, pixels.
const HEAD: f64 = 84.0;
const SAMPLE: f64 = 28.0;
/// Width of a note, pixels.
const NOTE: f64 = 92.0;
/// Classes of the two curves.
const CLASSES: [&str; 2] = ["c1", "c0"];

/// Curves of the errors of several recordings, one panel for each.
#[derive(Debug)]
pub(crate) struct OverTime<'a> {
    pub(crate) title: &'a str,
    /// Names of the two curves.
    pub(crate) keys: [&'a str; 2],
    pub(crate) panels: &'a [TimePanel],
}

/// Two curves of one recording.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TimePanel {
    /// The recording.
    pub(crate) name: String,
    /// Two notes beside the name, in the colours of the curves.
    pub(crate) notes: [String; 2],
    /// Points of both curves: time (minutes, ascending) and error (m). Each panel has its own scale.
    pub(crate) curves: [Vec<[f64; 2]>; 2],
}

impl OverTime<'_> {
    /// The text of an SVG file. The same input gives the same bytes.
    pub(crate) fn to_file(&self) -> String {
        let count = self.panels.len();
        let across = |count: usize| count as f64 * (PLOT[0] + BETWEEN[0]);
        let up = |count: usize| count as f64 * (PLOT[1] + BETWEEN[1]);
        let size = [
            EDGE + LEFT + across(count.min(COLUMNS)) - BETWEEN[0] + EDGE,
            HEAD + up(count.div_ceil(COLUMNS)) + EDGE,
        ];
        let mut drawing = Drawing::new(size[0], size[1], self.title);
        let heading = cut(self.title, 16.0, size[0] - 2.0 * EDGE);
        drawing.text("heading", [EDGE, EDGE + 14.0], heading);
        self.draw_legend(&mut drawing);
        for (index, panel) in self.panels.iter().enumerate() {
            let left = EDGE + LEFT + across(index % COLUMNS);
            let top = HEAD + 26.0 + up(index / COLUMNS);
            panel.draw(&mut drawing, [left, top]);
        }
        drawing.to_file(PLOT_STYLE)
    }

    fn draw_legend(&self, drawing: &mut Drawing) {
        let y = EDGE + 40.0;
        let mut left = EDGE;
        for (class, words) in CLASSES.into_iter().zip(self.keys) {
            drawing.path(&format!("curve {class}"), &[[left, y], [left + SAMPLE, y]]);
            drawing.text("key", [left + SAMPLE + 8.0, y + 4.0], words);
            left += SAMPLE + 36.0 + 6.7 * words.len() as f64;
        }
    }
}

impl TimePanel {
    fn draw(&self, drawing: &mut Drawing, [left, top]: [f64; 2]) {
        let [right, bottom] = [left + PLOT[0], top + PLOT[1]];
        let points = || self.curves.iter().flatten();
        let longest = points().fold(0.0, |longest, point| point[0].max(longest));
        let time = Scale::from_zero(longest, [left, right]);
        drawing.text("title", [left, top - 10.0], self.name.as_str());
        let ends = [right - NOTE, right];
        for ((class, note), end) in CLASSES.into_iter().zip(&self.notes).zip(ends) {
            let class = format!("small end {class}");
            drawing.text(&class, [end, top - 10.0], note.as_str());
        }
        let largest = points().fold(0.0, |largest, point| point[1].max(largest));
        let metres = Scale::from_zero(largest, [bottom, top]);
        for (tick, label) in time.ticks() {
            let x = time.at(tick);
            drawing.line("grid", [x, top], [x, bottom]);
            drawing.text("small middle", [x, bottom + 16.0], label);
        }
        for (tick, label) in metres.ticks() {
            let y = metres.at(tick);
            drawing.line("grid", [left, y], [right, y]);
            drawing.text("small end", [left - 6.0, y + 4.0], label);
        }
        for (class, curve) in CLASSES.into_iter().zip(&self.curves) {
            let points = curve
                .iter()
                .map(|&[minutes, value]| [time.at(minutes), metres.at(value)]);
            let class = format!("curve {class}");
            drawing.path(&class, &points.collect::<Vec<_>>());
        }
        drawing.rectangle("frame", [[left, top], [right, bottom]]);
        drawing.text("small end", [right, bottom + 30.0], "minutes");
    }
}
