//! Coverage of forecast regions over time, one panel for each recording.

use crate::figure::error::FigureError;
use crate::figure::over_time::{OverTime, TimePanel, Values};

const MOST_PANELS: usize = 9;
/// Range of the vertical axis if all values lie in it.
const LOWEST: f64 = 0.7;

/// Draws the share (0 to 1) of true positions inside fixed (first curve) and adaptive regions (second curve) of 1 to 9
/// recordings over time, with the nominal probability and a band of 2 % around it, as the text of an SVG file. The same
/// input gives the same bytes.
///
/// # Errors
/// There are no panels, or more than 9.
pub fn coverage(title: &str, probability: f64, panels: &[TimePanel]) -> Result<String, FigureError> {
    if !(1..=MOST_PANELS).contains(&panels.len()) {
        let (found, most) = (panels.len(), MOST_PANELS);
        return Err(FigureError::Recordings { found, most });
    }
    let shares = panels.iter().flat_map(|panel| panel.curves.iter().flatten());
    let lowest = shares.fold(LOWEST, |low, point| low.min(point[1]));
    let drawn = OverTime {
        title,
        keys: ["fixed, calibrated on other places", "adaptive"],
        values: Values::Shares {
            lowest: (10.0 * lowest).floor() / 10.0,
            aim: probability,
        },
        panels,
    };
    Ok(drawn.to_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recording_has_its_curves_and_the_picture_its_limits() {
        let curve = |share: f64| (0..5).map(|t| [f64::from(t), share]).collect();
        let panel = TimePanel {
            name: "a <yard>".to_owned(),
            notes: ["31 %", "90 %"].map(str::to_owned),
            curves: [0.31, 0.9].map(curve),
        };
        let svg = coverage("Shares", 0.9, &vec![panel.clone(); 4]).unwrap();
        assert_eq!(svg.matches("curve c0").count(), 1 + 4);
        assert_eq!(svg.matches("a &lt;yard&gt;").count(), 4);
        assert!(svg.contains("30 %") && !svg.contains("20 %") && !svg.contains("NaN"));
        assert!(svg.contains("88 to 92 %"));
        let none = TimePanel {
            curves: [vec![], vec![]],
            ..panel.clone()
        };
        assert!(!coverage("Empty", 0.9, &[none]).unwrap().contains("NaN"));
        assert!(coverage("None", 0.9, &[]).is_err());
        assert!(coverage("Many", 0.9, &vec![panel; 10]).is_err());
    }
}
