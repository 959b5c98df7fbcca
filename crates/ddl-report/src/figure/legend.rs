//! The legend: a column beside a plot, or rows above several plots.

use crate::figure::drawing::{Drawing, text_width};
use crate::figure::marks::{goal_ring, nearest_goal, star};
use crate::figure::pedestrian::hypothesis_style;

const ENTRY: f64 = 26.0;
const SAMPLE: f64 = 42.0;
/// Space between a sample and its text, pixels.
const GAP: f64 = 16.0;
/// Space between two entries of a row, pixels.
const BETWEEN: f64 = 30.0;
const LETTERS: f64 = 12.0;
/// Probabilities of the sample rings, and their positions from the left.
const PROBABILITIES: [(f64, f64); 3] = [(0.01, 3.0), (0.05, 14.0), (0.2, 32.0)];

#[derive(Debug, Clone, Copy)]
pub(super) enum LegendEntry {
    Observed,
    Truth,
    Forecast,
    Representative,
    OtherHypotheses,
    Note(&'static str),
    /// Rings at the goals of hypotheses.
    Goals(&'static str),
    /// Rings whose area is proportional to the probability.
    WeightedGoals,
    NearestGoal,
    Experts,
    Region,
}

impl LegendEntry {
    fn text(self) -> &'static str {
        match self {
            Self::Observed => "observed, 3.2 s",
            Self::Truth => "truth, 4.8 s, and its end",
            Self::Forecast => "forecast",
            Self::Representative => "representative forecast",
            Self::OtherHypotheses => "other hypotheses",
            Self::Note(text) | Self::Goals(text) => text,
            Self::WeightedGoals => "goals of 1, 5, 20 % probability",
            Self::NearestGoal => "goal nearest the true end",
            Self::Experts => "how similar pedestrians went on",
            Self::Region => "90 % region at 4.8 s",
        }
    }

    fn indent(self, beside_samples: bool) -> f64 {
        match self {
            Self::Note(_) if !beside_samples => 0.0,
            _ => SAMPLE + GAP,
        }
    }

    fn draw(self, drawing: &mut Drawing, [left, y]: [f64; 2], indent: f64) {
        let right = left + SAMPLE;
        let middle = f64::midpoint(left, right);
        drawing.text("key", [left + indent, y + 4.0], self.text());
        match self {
            Self::Observed => {
                drawing.path("seen", &[[left, y], [right, y]]);
                for x in [left, left + 14.0, left + 28.0, right] {
                    drawing.circle("observed", [x, y], 2.4);
                }
            }
            Self::Truth => {
                drawing.path("truth", &[[left, y], [right, y]]);
                drawing.circle("truth-end", [right, y], 3.6);
            }
            Self::Forecast | Self::Representative => {
                drawing.path("forecast", &[[left, y], [right, y]]);
                drawing.polygon("star", &star([right, y], 7.0));
            }
            Self::OtherHypotheses => {
                for (rise, share) in [(-5.0, 1.0), (0.0, 0.5), (5.0, 0.0)] {
                    let line = [[left, y + rise], [right, y + rise]];
                    drawing.styled_path("hypothesis", &line, &hypothesis_style(share));
                }
            }
            Self::Note(_) => {}
            Self::Goals(_) => drawing.circle("goal", [middle, y], 6.0),
            Self::WeightedGoals => {
                for (weight, x) in PROBABILITIES {
                    goal_ring(drawing, [left + x, y], weight);
                }
            }
            Self::NearestGoal => nearest_goal(drawing, [middle, y], 0.05),
            Self::Experts => {
                for rise in [-6.0, 0.0, 6.0] {
                    drawing.path("expert", &[[left, y], [right, y + rise]]);
                }
            }
            Self::Region => drawing.circle("region", [middle, y], 9.0),
        }
    }
}

pub(super) fn draw_column(drawing: &mut Drawing, [left, top]: [f64; 2], entries: &[LegendEntry]) {
    for (row, entry) in entries.iter().enumerate() {
        let y = top + ENTRY * (row as f64 + 0.5);
        entry.draw(drawing, [left, y], entry.indent(true));
    }
}

pub(super) struct LegendRows<'a> {
    entries: &'a [LegendEntry],
    places: Vec<[f64; 2]>,
}

impl<'a> LegendRows<'a> {
    pub(super) fn new(entries: &'a [LegendEntry], width: f64) -> Self {
        let (mut x, mut y) = (0.0, 0.0);
        let mut places = Vec::with_capacity(entries.len());
        for entry in entries {
            let needed = entry.indent(false) + text_width(entry.text(), LETTERS);
            if x > 0.0 && x + needed > width {
                (x, y) = (0.0, y + ENTRY);
            }
            places.push([x, y]);
            x += needed + BETWEEN;
        }
        Self { entries, places }
    }

    pub(super) fn height(&self) -> f64 {
        self.places.last().map_or(0.0, |[_, y]| y + ENTRY)
    }

    pub(super) fn draw(&self, drawing: &mut Drawing, [left, top]: [f64; 2]) {
        for (entry, [x, y]) in self.entries.iter().zip(&self.places) {
            let start = [left + x, top + y + 0.5 * ENTRY];
            entry.draw(drawing, start, entry.indent(false));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_to_the_width_and_do_not_overlap() {
        let note = LegendEntry::Note("a note");
        let entries = [LegendEntry::Observed, LegendEntry::Truth, LegendEntry::Experts, note];
        for width in [60.0, 300.0, 520.0, 1800.0] {
            let rows = LegendRows::new(&entries, width);
            let mut end = [0.0, -1.0];
            for (entry, &[x, y]) in entries.iter().zip(&rows.places) {
                let right = x + entry.indent(false) + text_width(entry.text(), LETTERS);
                assert!(x == 0.0 || right <= width);
                assert!(y > end[1] || x > end[0], "overlaps the entry before");
                end = [right, y];
            }
            assert!((rows.height() - end[1] - ENTRY).abs() < 1e-9);
        }
        assert!((LegendRows::new(&entries, 1800.0).height() - ENTRY).abs() < 1e-9);
        assert!(LegendRows::new(&[], 100.0).height() <= 0.0);
    }
}
