//! The recordings and windows of a training, and their digests.

use ddl_core::Window;
use ddl_data::{Convention, DataError, Dataset, Fold, Recording, WindowRule};
use ddl_network::weights::in_hex;
use sha2::{Digest as _, Sha256};

/// Training uses every window of 20 steps of the convention.
pub(crate) fn training_rule(convention: Convention) -> WindowRule {
    match convention {
        Convention::SocialGan => WindowRule::SocialGan { min_pedestrians: 1 },
        Convention::Own => WindowRule::Observed,
        _ => WindowRule::Complete,
    }
}

/// The fold of that name. For own recordings this includes the fold that leaves none out ([`Fold::NO_HELD_OUT`]).
///
/// # Errors
/// When it is missing; the message lists the existing folds.
pub fn fold_by_name<'a>(dataset: &'a Dataset, name: &str) -> Result<Fold<'a>, DataError> {
    if dataset.convention() == Convention::Own && name == Fold::NO_HELD_OUT {
        Ok(dataset.whole())
    } else {
        dataset.fold(name)
    }
}

pub(crate) fn learned_from<'a>(fold: &'a Fold<'_>) -> impl Iterator<Item = &'a Recording> {
    let learned = fold.training_recordings().iter();
    learned.chain(fold.validation_recordings()).copied()
}

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
