//! The folds and windows that a training uses.

use ddl_data::{Convention, DataError, Dataset, Fold, Recording, WindowRule};

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
    fold.training_recordings().iter().chain(fold.validation_recordings()).copied()
}
