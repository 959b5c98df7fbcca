//! Scores of a file's forecasts, beside the baselines on the same pedestrians.

use super::error::ExternalError;
use super::matched::Matched;
use crate::{Conditions, Protocol, ResultRow, baseline};

/// Scores forecasts of a file under the protocol of the conditions, then the baselines on the same pedestrians.
///
/// [`Matched::test_subset`] is added to the test subset of the conditions; a part of the pedestrians is scored as by
/// [`Scores::evaluate_among`](crate::Scores::evaluate_among).
///
/// # Errors
/// [`ExternalError::Published`] under the protocol `published`; [`ExternalError::OutOfPlace`] where half of the
/// forecasts begin more than 3 m from their pedestrians; too many hypotheses; windows that cannot be scored.
pub fn measure(
    conditions: &Conditions,
    matched: &Matched,
    noise_seed: u64,
) -> Result<Vec<ResultRow>, ExternalError> {
    if conditions.protocol == Protocol::Published {
        return Err(ExternalError::Published);
    }
    matched.ensure_in_place()?;
    let subsets: Vec<String> = conditions
        .test_subset
        .iter()
        .cloned()
        .chain(matched.test_subset())
        .collect();
    let conditions = Conditions {
        test_subset: (!subsets.is_empty()).then(|| subsets.join("; ")),
        selection: Some(format!(
            "made by another program, read from {}",
            matched.file()
        )),
        ..conditions.clone()
    };
    let forecasts = conditions
        .protocol
        .admit(matched.forecasts.clone(), &conditions.forecaster)?;
    let mut rows = vec![ResultRow::score_among(
        conditions.clone(),
        &matched.windows,
        &matched.everybody,
        &forecasts,
    )?];
    rows.extend(baseline::measure_among(
        &conditions,
        &matched.windows,
        &matched.everybody,
        noise_seed,
    )?);
    Ok(rows)
}
