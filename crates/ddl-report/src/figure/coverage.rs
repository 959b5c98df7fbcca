//! The share of true positions that regions hold, over the time of several recordings, a panel each.

use super::{
    drawing::{Drawing, PLOT_STYLE},
    error::FigureError,
    scale::{Scale, ticks},
};

const MOST_PANELS: usize = 9;
const COLUMNS: usize = 3;
/// Space around everything, and between the panels, across and up, pixels.
const EDGE: f64 = 20.0;
const BETWEEN: [f64; 2] = [56.0, 66.0];
/// The plot of a panel, and what stands to the left of it, pixels.
const PLOT: [f64; 2] = [270.0, 150.0];
const LEFT: f64 = 40.0;
/// Height of heading and legend, pixels.
const HEAD: f64 = 84.0;
const SAMPLE: f64 = 28.0;
/// Shares that are shown where all fit.
const LOWEST: f64 = 0.7;
/// Width of a note, pixels.
const NOTE: f64 = 92.0;

/// Shares of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct CoveragePanel {
    /// The recording.
    pub name: String,
    /// What stands beside the name, in the colours of the curves: fixed and adaptive.
    pub notes: [String; 2],
    /// Of regions that stay as they are: time (minutes, rising) and share (0 to 1).
    pub fixed: Vec<[f64; 2]>,
    /// Of regions that follow what is seen.
    pub adaptive: Vec<[f64; 2]>,
}

/// Draws the shares of 1 to 9 recordings over time, with the probability asked for and a band of 2 % about it, as the
/// text of an SVG file. The same input gives the same bytes.
///
/// # Errors
/// There is no panel or there are more than 9.
pub fn coverage(
    title: &str,
    probability: f64,
    panels: &[CoveragePanel],
) -> Result<String, FigureError> {
    if !(1..=MOST_PANELS).contains(&panels.len()) {
        let (found, most) = (panels.len(), MOST_PANELS);
        return Err(FigureError::Recordings { found, most });
    }
    let columns = panels.len().min(COLUMNS);
    let rows = panels.len().div_ceil(COLUMNS);
    let across = |count: usize| count as f64 * (PLOT[0] + BETWEEN[0]);
    let up = |count: usize| count as f64 * (PLOT[1] + BETWEEN[1]);
    let size = [
        EDGE + LEFT + across(columns) - BETWEEN[0] + EDGE,
        HEAD + up(rows) + EDGE,
    ];
    let mut drawing = Drawing::new(size[0], size[1], title);
    drawing.text("heading", [EDGE, EDGE + 14.0], title);
    draw_legend(&mut drawing, probability);
    let lowest = panels
        .iter()
        .flat_map(|panel| panel.fixed.iter().chain(&panel.adaptive))
        .fold(LOWEST, |low, point| low.min(point[1]));
    let lowest = (10.0 * lowest).floor() / 10.0;
    for (at, panel) in panels.iter().enumerate() {
        let left = EDGE + LEFT + across(at % COLUMNS);
        let top = HEAD + 26.0 + up(at / COLUMNS);
        panel.draw(&mut drawing, [left, top], lowest, probability);
    }
    Ok(drawing.to_file(PLOT_STYLE))
}

fn draw_legend(drawing: &mut Drawing, probability: f64) {
    let y = EDGE + 40.0;
    let samples = [
        ("curve c1", "fixed, calibrated on other places"),
        ("curve c0", "adaptive"),
    ];
    let mut left = EDGE;
    for (class, words) in samples {
        drawing.path(class, &[[left, y], [left + SAMPLE, y]]);
        drawing.text("key", [left + SAMPLE + 8.0, y + 4.0], words);
        left += SAMPLE + 36.0 + 6.7 * words.len() as f64;
    }
    drawing.rectangle("aim", [[left, y - 6.0], [left + SAMPLE, y + 6.0]]);
    let percent = 100.0 * probability;
    let words = format!("{} to {} %, the aim", percent - 2.0, percent + 2.0);
    drawing.text("key", [left + SAMPLE + 8.0, y + 4.0], words);
}

impl CoveragePanel {
    fn draw(&self, drawing: &mut Drawing, [left, top]: [f64; 2], lowest: f64, probability: f64) {
        let [right, bottom] = [left + PLOT[0], top + PLOT[1]];
        let last = |curve: &[[f64; 2]]| curve.last().map_or(0.0, |point| point[0]);
        let longest = last(&self.fixed).max(last(&self.adaptive));
        let time = Scale::from_zero(longest, [left, right]);
        let share = |share: f64| bottom - (share - lowest) / (1.0 - lowest) * PLOT[1];
        drawing.text("title", [left, top - 10.0], self.name.as_str());
        let [fixed, adaptive] = &self.notes;
        let above = top - 10.0;
        drawing.text("small end c1", [right - NOTE, above], fixed.as_str());
        drawing.text("small end c0", [right, above], adaptive.as_str());
        let aim = [-0.02, 0.02].map(|off| share((probability + off).clamp(lowest, 1.0)));
        drawing.rectangle("aim", [[left, aim[1]], [right, aim[0]]]);
        for (tick, label) in time.ticks() {
            let x = time.at(tick);
            drawing.line("grid", [x, top], [x, bottom]);
            drawing.text("small middle", [x, bottom + 16.0], label);
        }
        for (tick, _) in ticks(lowest, 1.0, 0.1) {
            let y = share(tick);
            drawing.line("grid", [left, y], [right, y]);
            let label = format!("{:.0} %", 100.0 * tick);
            drawing.text("small end", [left - 6.0, y + 4.0], label);
        }
        for (class, curve) in [("curve c1", &self.fixed), ("curve c0", &self.adaptive)] {
            let points = curve
                .iter()
                .map(|&[minutes, held]| [time.at(minutes), share(held)]);
            drawing.path(class, &points.collect::<Vec<_>>());
        }
        drawing.rectangle("frame", [[left, top], [right, bottom]]);
        drawing.text("small end", [right, bottom + 30.0], "minutes");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recording_has_its_curves_and_the_picture_its_limits() {
        let curve = |share: f64| (0..5).map(|t| [f64::from(t), share]).collect();
        let panel = CoveragePanel {
            name: "a <yard>".to_owned(),
            notes: ["31 %", "90 %"].map(str::to_owned),
            fixed: curve(0.31),
            adaptive: curve(0.9),
        };
        let svg = coverage("Shares", 0.9, &vec![panel.clone(); 4]).unwrap();
        assert_eq!(svg.matches("curve c0").count(), 1 + 4);
        assert_eq!(svg.matches("a &lt;yard&gt;").count(), 4);
        assert!(svg.contains("30 %") && !svg.contains("20 %") && !svg.contains("NaN"));
        assert!(svg.contains("88 to 92 %"));
        let none = CoveragePanel {
            fixed: Vec::new(),
            adaptive: Vec::new(),
            ..panel.clone()
        };
        assert!(!coverage("Empty", 0.9, &[none]).unwrap().contains("NaN"));
        assert!(coverage("None", 0.9, &[]).is_err());
        assert!(coverage("Many", 0.9, &vec![panel; 10]).is_err());
    }
}
