//! Scores of a file's forecasts, beside the baselines on the same walkers.

use super::error::ForeignError;
use super::matched::Matched;
use crate::{Conditions, Protocol, ResultRow, baseline};

/// Seed of the baseline with angular noise that `ddl evaluate` takes, so that its rows are the same everywhere.
pub const NOISE_SEED: u64 = 1;

/// Scores forecasts of a file under the protocol of the conditions, then the baselines on the same walkers.
///
/// The conditions are taken at their word for the fold and the rule, as by [`ResultRow::measure`]; the test subset is
/// set to [`Matched::test_subset`], and the selection to where the forecasts are from. Under `single` the hypothesis of greatest weight is scored, of equals the first.
///
/// # Errors
/// [`ForeignError::Published`] under the protocol `published`; more hypotheses than the protocol allows; windows that
/// cannot be scored.
pub fn measure(
    conditions: &Conditions,
    matched: &Matched,
    noise_seed: u64,
) -> Result<Vec<ResultRow>, ForeignError> {
    if conditions.protocol == Protocol::Published {
        return Err(ForeignError::Published);
    }
    let conditions = Conditions {
        test_subset: matched.test_subset(),
        selection: Some(format!(
            "made by another program, read from {}",
            matched.file()
        )),
        ..conditions.clone()
    };
    let forecasts = conditions
        .protocol
        .admit(matched.forecasts.clone(), &conditions.forecaster)?;
    let mut rows = vec![ResultRow::score(
        conditions.clone(),
        &matched.windows,
        &forecasts,
    )?];
    rows.extend(baseline::measure(
        &conditions,
        &matched.windows,
        noise_seed,
    )?);
    Ok(rows)
}
