//! Coverage of forecast regions over time, one panel for each recording.

use super::{
    error::FigureError,
    over_time::{OverTime, TimePanel, Values},
};

const MOST_PANELS: usize = 9;
/// Range of the vertical axis if all values lie in it.
const LOWEST: f64 = 0.7;

/// Coverage in one recording: the share of true positions inside their regions.
#[derive(Debug, Clone, PartialEq)]
pub struct CoveragePanel {
    /// The recording.
    pub name: String,
    /// Two notes beside the name, in the colours of the curves: fixed and adaptive.
    pub notes: [String; 2],
    /// Coverage of fixed regions: time (minutes, ascending) and share (0 to 1).
    pub fixed: Vec<[f64; 2]>,
    /// Coverage of adaptive regions, in the same form.
    pub adaptive: Vec<[f64; 2]>,
}

/// Draws the coverage of 1 to 9 recordings over time, with the nominal probability and a band of 2 % around it, as the
/// text of an SVG file. The same input gives the same bytes.
///
/// # Errors
/// There are no panels, or more than 9.
pub fn coverage(title: &str, probability: f64, panels: &[CoveragePanel]) -> Result<String, FigureError> {
    if !(1..=MOST_PANELS).contains(&panels.len()) {
        let (found, most) = (panels.len(), MOST_PANELS);
        return Err(FigureError::Recordings { found, most });
    }
    let shares = panels
        .iter()
        .flat_map(|panel| panel.fixed.iter().chain(&panel.adaptive));
    let lowest = shares.fold(LOWEST, |low, point| low.min(point[1]));
    let curves = |panel: &CoveragePanel| TimePanel {
        name: panel.name.clone(),
        notes: panel.notes.clone(),
        curves: [panel.fixed.clone(), panel.adaptive.clone()],
    };
    let drawn = OverTime {
        title,
        keys: ["fixed, calibrated on other places", "adaptive"],
        values: Values::Shares {
            lowest: (10.0 * lowest).floor() / 10.0,
            aim: probability,
        },
        panels: panels.iter().map(curves).collect(),
    };
    Ok(drawn.to_file())
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
