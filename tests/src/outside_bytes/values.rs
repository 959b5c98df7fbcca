//! Values of a few lines: results (`report.json`, `moments.json`), the homography of a camera, and the goal
//! estimator's parameters as JSON.

use ddl_core::{PedestrianId, PedestrianNames};
use ddl_data::{Homography, Observation};
use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams};
use ddl_report::{ForecastSnapshot, Report, page::Page};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Pixels to transform: corners, the middle, and beyond the image.
const PIXELS: [[f64; 2]; 4] = [[0.0, 0.0], [320.0, 240.0], [-1e6, 1e6], [1e-300, -0.0]];

/// A value of JSON; written, it is read back unchanged.
fn json<T: Serialize + DeserializeOwned + PartialEq>(bytes: &[u8]) -> Option<T> {
    let value: T = serde_json::from_slice(bytes).ok()?;
    let text = serde_json::to_string(&value).expect("valid values can be written");
    assert!(serde_json::from_str(&text).ok().as_ref() == Some(&value), "{text}");
    Some(value)
}

/// Reads bytes as `report.json` and creates a page. A report that was read is written and read back unchanged.
pub(super) fn report(bytes: &[u8]) {
    let Ok(report) = Report::from_json(&String::from_utf8_lossy(bytes)) else {
        return;
    };
    let text = report.to_json().expect("valid data can be written");
    let again = Report::from_json(&text).unwrap_or_else(|error| panic!("a written report is refused: {error}\n{text}"));
    assert_eq!(again, report);
    assert!(report.files().is_ok());
    let page = Page::new(&report);
    assert!(page.comparison().is_ok() && page.to_html().is_ok());
}

/// Reads bytes as `moments.json` and draws them.
pub(super) fn moments(bytes: &[u8]) {
    let Some(moments) = json::<Vec<ForecastSnapshot>>(bytes) else {
        return;
    };
    let empty = Report::new("none", []).expect("no rows, no conflict");
    let page = Page { moments: &moments, ..Page::new(&empty) };
    // Incomplete moments are refused, by both functions alike.
    assert_eq!(page.comparison().is_ok(), page.to_html().is_ok());
}

/// Reads bytes as a homography, and transforms pixels.
pub(super) fn homography(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let Ok(homography) = text.parse::<Homography>() else {
        return;
    };
    for pixel in PIXELS {
        let seen = Observation::new(0, PedestrianId(1), pixel);
        if let Ok(place) = homography.place(&seen, &PedestrianNames::default()) {
            let is_near = place.iter().all(|c| c.abs() <= ddl_core::COORDINATE_LIMIT);
            assert!(is_near, "{pixel:?}: {place:?}");
        }
    }
    let with_commas = text.replace([' ', '\t'], ",");
    assert_eq!(with_commas.parse(), Ok(homography));
}

/// Reads bytes as parameters for goals from a library of one pedestrian.
pub(super) fn goal_params(bytes: &[u8]) {
    if let Some(params) = json::<GoalEstimatorParams>(bytes) {
        let track = (0..20).map(|t| [0.5 * f64::from(t), 0.0]).collect();
        let library = ExpertLibrary::new(vec![track], 0.4).expect("a sound library");
        let _ = GoalEstimator::new(params, library);
    }
}
