//! Digests of the recordings and windows of a training.

use ddl_core::Window;
use ddl_data::Recording;
use ddl_network::weights::in_hex;
use sha2::{Digest as _, Sha256};

/// SHA-256 of a recording's frames, pedestrians and positions; its name does not matter.
pub(crate) fn digest_of_recording(recording: &Recording) -> String {
    let mut hasher = Sha256::new();
    for seen in recording.observations() {
        hasher.update(seen.frame.to_le_bytes());
        hasher.update(seen.pedestrian.0.to_le_bytes());
        for coordinate in seen.position {
            hasher.update(coordinate.to_le_bytes());
        }
    }
    in_hex(hasher)
}

/// SHA-256 of the windows' positions.
pub(crate) fn digest(windows: &[Window]) -> String {
    let mut hasher = Sha256::new();
    for window in windows {
        hasher.update(window.recording().as_bytes());
        hasher.update(window.start_frame().to_le_bytes());
        for i in 0..window.len() {
            for coordinate in window.track(i).iter().flatten() {
                hasher.update(coordinate.to_le_bytes());
            }
        }
    }
    in_hex(hasher)
}
