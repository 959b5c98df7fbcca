//! The legend: a column beside a plot.

use crate::figure::drawing::Drawing;
use crate::figure::marks::star;
use crate::figure::pedestrian::hypothesis_style;

const ENTRY: f64 = 26.0;
const WIDTH: f64 = 42.0;
/// Space between a sample and its text, pixels.
const GAP: f64 = 16.0;

#[derive(Debug, Clone, Copy)]
pub(super) enum LegendSample {
    Observed,
    Truth,
    Forecast,
    OtherHypotheses,
    /// Words alone.
    Note,
    /// Rings at the goals of hypotheses.
    Goals,
    Region,
}

impl LegendSample {
    fn draw(self, drawing: &mut Drawing, [left, y]: [f64; 2]) {
        let right = left + WIDTH;
        let middle = f64::midpoint(left, right);
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
            Self::Forecast => {
                drawing.path("forecast", &[[left, y], [right, y]]);
                drawing.polygon("star", &star([right, y], 7.0));
            }
            Self::OtherHypotheses => {
                for (rise, share) in [(-5.0, 1.0), (0.0, 0.5), (5.0, 0.0)] {
                    let line = [[left, y + rise], [right, y + rise]];
                    drawing.styled_path("hypothesis", &line, &hypothesis_style(share));
                }
            }
            Self::Note => {}
            Self::Goals => drawing.circle("goal", [middle, y], 6.0),
            Self::Region => drawing.circle("region", [middle, y], 9.0),
        }
    }
}

pub(super) fn draw_column(drawing: &mut Drawing, [left, top]: [f64; 2], entries: &[(LegendSample, &str)]) {
    for (row, (sample, words)) in entries.iter().enumerate() {
        let y = top + ENTRY * (row as f64 + 0.5);
        drawing.text("key", [left + WIDTH + GAP, y + 4.0], *words);
        sample.draw(drawing, [left, y]);
    }
}
