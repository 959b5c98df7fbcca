//! The homography of a camera.

use ddl_data::{Homography, Observation, PedestrianId, PedestrianNames};

/// Pixels to transform: corners, the middle, and beyond the image.
const PIXELS: [[f64; 2]; 4] = [[0.0, 0.0], [320.0, 240.0], [-1e6, 1e6], [1e-300, -0.0]];

/// Reads bytes as a homography, and transforms pixels.
pub fn read(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let Ok(homography) = text.parse::<Homography>() else {
        return;
    };
    for pixel in PIXELS {
        let seen = Observation::new(0, PedestrianId(1), pixel);
        if let Ok(place) = homography.place(&seen, &PedestrianNames::default()) {
            assert!(
                place.iter().all(|c| c.abs() <= ddl_data::COORDINATE_LIMIT),
                "{pixel:?}: {place:?}"
            );
        }
    }
    let with_commas = text.replace([' ', '\t'], ",");
    assert_eq!(with_commas.parse(), Ok(homography));
}
