//! What the shapes mean: as a column beside a plot or in rows above several.

use plotters::style::Color;

use super::{
    canvas::{Canvas, EXPERT, FORECAST, GOAL, OBSERVED, Pixel, Place, TRUTH, text_width},
    error::FigureError,
    goal_ring,
};

/// Height of an entry, pixels.
const ENTRY: i32 = 46;
/// Length of a sample line, pixels.
const SAMPLE: i32 = 72;
/// Space between a sample and its text, pixels.
const GAP: i32 = 28;
/// Space between two entries of a row, pixels.
const BETWEEN: i32 = 56;
/// Size of the letters.
const LETTERS: i32 = 26;
/// Probabilities whose rings are shown as samples.
const PROBABILITIES: [f64; 3] = [0.01, 0.05, 0.2];

/// One line of a legend.
#[derive(Debug, Clone, Copy)]
pub(super) enum Entry {
    Observed,
    Truth,
    /// The only hypothesis.
    Forecast,
    /// The one of several hypotheses that stands for them.
    Representative,
    OtherHypotheses,
    /// Text alone.
    Note(&'static str),
    /// Rings of one size.
    Goals(&'static str),
    /// Rings whose area is the probability.
    WeightedGoals,
    NearestGoal,
    Experts,
}

impl Entry {
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
            Self::Experts => "how similar walkers went on",
        }
    }

    /// Where the text begins, from the left of the entry.
    fn indent(self, beside_samples: bool) -> i32 {
        match self {
            Self::Note(_) if !beside_samples => 0,
            _ => SAMPLE + GAP,
        }
    }

    fn draw_sample(self, canvas: &Canvas<'_>, (left, y): Pixel) -> Result<(), FigureError> {
        let right = left + SAMPLE;
        let middle = i32::midpoint(left, right);
        match self {
            Self::Observed => {
                canvas.line(&[(left, y), (right, y)], OBSERVED.mix(0.5), 2)?;
                [left, middle, right]
                    .into_iter()
                    .try_for_each(|x| canvas.dot((x, y), OBSERVED, 6))
            }
            Self::Truth => {
                canvas.line(&[(left, y), (right, y)], TRUTH, 5)?;
                canvas.dot((right, y), TRUTH, 9)
            }
            Self::Forecast | Self::Representative => {
                canvas.dashes(&[(left, y), (right, y)], FORECAST, 5)?;
                canvas.star((right, y), FORECAST, 15)
            }
            Self::OtherHypotheses => {
                for (line, opacity) in [(-8, 0.6), (0, 0.4), (8, 0.2)] {
                    let y = y + line;
                    canvas.line(&[(left, y), (right, y)], FORECAST.mix(opacity), 3)?;
                    canvas.dot((right, y), FORECAST.mix(opacity), 5)?;
                }
                Ok(())
            }
            Self::Note(_) => Ok(()),
            Self::Goals(_) => canvas.ring((middle, y), GOAL, 11, 3),
            Self::WeightedGoals => PROBABILITIES
                .into_iter()
                .zip([left + 6, left + 26, left + 58])
                .try_for_each(|(weight, x)| goal_ring::draw(canvas, (x, y), weight)),
            Self::NearestGoal => goal_ring::draw_nearest(canvas, (middle, y), 0.05),
            Self::Experts => {
                for rise in [-10, 0, 10] {
                    canvas.line(
                        &[(left, y), (right, y + rise)],
                        EXPERT.mix(goal_ring::EXPERT_OPACITY),
                        2,
                    )?;
                }
                Ok(())
            }
        }
    }
}

/// One entry below the other, from the upper left corner on.
pub(super) fn draw_column(
    canvas: &Canvas<'_>,
    (left, top): Pixel,
    entries: &[Entry],
) -> Result<(), FigureError> {
    for (row, entry) in (0..).zip(entries) {
        let y = top + ENTRY / 2 + row * ENTRY;
        let text = (left + entry.indent(true), y);
        canvas.text(entry.text(), text, LETTERS, Place::RightOf)?;
        entry.draw_sample(canvas, (left, y))?;
    }
    Ok(())
}

/// Entries in rows that fill a width.
#[derive(Debug)]
pub(super) struct Rows<'a> {
    entries: &'a [Entry],
    /// Upper left corner of each entry, from that of the legend.
    places: Vec<Pixel>,
}

impl<'a> Rows<'a> {
    /// Begins a row whenever the next entry would reach beyond `width`.
    pub(super) fn new(entries: &'a [Entry], width: i32) -> Self {
        let (mut x, mut y) = (0, 0);
        let mut places = Vec::with_capacity(entries.len());
        for entry in entries {
            let needed = entry.indent(false) + text_width(entry.text(), LETTERS);
            if x > 0 && x + needed > width {
                (x, y) = (0, y + ENTRY);
            }
            places.push((x, y));
            x += needed + BETWEEN;
        }
        Self { entries, places }
    }

    /// Height of all rows, pixels.
    pub(super) fn height(&self) -> i32 {
        self.places.last().map_or(0, |(_, y)| y + ENTRY)
    }

    /// Draws them from the upper left corner on.
    pub(super) fn draw(&self, canvas: &Canvas<'_>, (left, top): Pixel) -> Result<(), FigureError> {
        for (entry, (x, y)) in self.entries.iter().zip(&self.places) {
            let (x, y) = (left + x, top + y + ENTRY / 2);
            let text = (x + entry.indent(false), y);
            canvas.text(entry.text(), text, LETTERS, Place::RightOf)?;
            entry.draw_sample(canvas, (x, y))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_to_the_width_and_do_not_overlap() {
        let entries = [
            Entry::Observed,
            Entry::Truth,
            Entry::Experts,
            Entry::Note("a note"),
        ];
        for width in [100, 500, 900, 3000] {
            let rows = Rows::new(&entries, width);
            let mut end = (0, -1);
            for (entry, &(x, y)) in entries.iter().zip(&rows.places) {
                let right = x + entry.indent(false) + text_width(entry.text(), LETTERS);
                assert!(x == 0 || right <= width);
                assert!(y > end.1 || x > end.0, "overlaps the entry before");
                end = (right, y);
            }
            assert_eq!(rows.height(), end.1 + ENTRY);
        }
        assert_eq!(Rows::new(&entries, 3000).height(), ENTRY);
        assert_eq!(Rows::new(&[], 100).height(), 0);
    }
}
