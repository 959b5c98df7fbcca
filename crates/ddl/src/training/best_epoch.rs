//! The epoch with the smallest validation error.

use ddl_network::EpochReport;

/// The first epoch with the smallest validation error; `None` if none was measured.
#[must_use]
pub fn best_epoch(epochs: &[EpochReport]) -> Option<&EpochReport> {
    let measured = epochs.iter().filter(|epoch| epoch.validation.is_some());
    // `min_by` takes the first of equals
    measured.min_by(|a, b| {
        let error = |epoch: &EpochReport| epoch.validation.unwrap_or(f64::INFINITY);
        error(a).total_cmp(&error(b))
    })
}

/// Whether at least `patience` epochs have passed since the best one.
#[cfg(any(test, feature = "torch"))]
pub(crate) fn is_over(epochs: &[EpochReport], patience: usize) -> bool {
    match (best_epoch(epochs), epochs.last()) {
        (Some(best), Some(last)) => last.epoch.saturating_sub(best.epoch) >= patience,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn epochs(errors: &[f64]) -> Vec<EpochReport> {
        (1..)
            .zip(errors)
            .map(|(epoch, &error)| EpochReport { epoch, loss: 1.0, batches: 1, seconds: 1.0, validation: Some(error) })
            .collect()
    }

    #[test]
    fn training_is_over_when_the_best_epoch_is_long_past() {
        let errors = [0.5, 0.3, 0.4, 0.3, 0.35];
        let epochs = epochs(&errors);
        assert_eq!(best_epoch(&epochs).map(|epoch| epoch.epoch), Some(2));
        assert!(is_over(&epochs, 3));
        assert!(!is_over(&epochs, 4));
        assert!(!is_over(&epochs[..2], 1));
    }
}
