//! Scores of a file's forecasts and of the baselines on the same pedestrians.

use ddl_core::{OBSERVED, Position, distance};

use crate::baseline;
use crate::conditions::{Conditions, ResultRow};
use crate::external::error::ExternalError;
use crate::external::matched::Matched;
use crate::protocol::Protocol;

/// Distance (m) above that of any step of 0.4 s. If half of the forecasts start farther from their pedestrians, the
/// file is refused.
const FARTHEST: f64 = 3.0;

/// Scores forecasts of a file under the protocol of the conditions, then the baselines on the same pedestrians.
///
/// [`Matched::test_subset`] is added to the test subset of the conditions; a part of the pedestrians is scored as in
/// [`Scores::under`](crate::Scores::under).
///
/// # Errors
/// [`ExternalError::Published`] under the protocol `published`; [`ExternalError::OutOfPlace`] if half of the forecasts
/// start more than 3 m from their pedestrians; too many hypotheses; windows that cannot be scored.
pub fn measure(conditions: &Conditions, matched: &Matched) -> Result<Vec<ResultRow>, ExternalError> {
    if conditions.protocol == Protocol::Published {
        return Err(ExternalError::Published);
    }
    matched.ensure_in_place()?;
    let subsets: Vec<String> = conditions.test_subset.iter().cloned().chain(matched.test_subset()).collect();
    let conditions = Conditions {
        test_subset: (!subsets.is_empty()).then(|| subsets.join("; ")),
        selection: Some("made by another program".to_owned()),
        ..conditions.clone()
    };
    let forecasts = conditions.protocol.admit(matched.forecasts.clone(), &conditions.forecaster)?;
    let mut rows =
        vec![ResultRow::score_among(conditions.clone(), &matched.windows, &matched.full_windows, &forecasts)?];
    rows.extend(baseline::measure_among(&conditions, &matched.windows, &matched.full_windows)?);
    Ok(rows)
}

impl Matched {
    fn ensure_in_place(&self) -> Result<(), ExternalError> {
        let starts: Vec<(Position, Position)> = self
            .windows
            .iter()
            .zip(&self.forecasts)
            .flat_map(|(window, forecast)| {
                (0..window.len()).map(move |i| {
                    (window.observed(i)[OBSERVED - 1], forecast.hypothesis(i, forecast.most_likely(i))[0])
                })
            })
            .collect();
        let apart = |as_if: fn(Position, Position) -> Position| {
            median(starts.iter().map(|&(last, first)| distance(last, as_if(last, first))))
        };
        let metres = apart(|_, first| first);
        if metres <= FARTHEST {
            return Ok(());
        }
        let hint = if apart(|_, [x, y]| [y, x]) <= FARTHEST {
            "they would start there if x and y were exchanged, as they are between the conventions star and social-gan"
        } else if apart(|last, first| [last[0] + first[0], last[1] + first[1]]) <= FARTHEST {
            "they would start there if they were relative to the last observed position: add it"
        } else {
            "are they in metres, and of the same data convention and fold?"
        };
        Err(ExternalError::OutOfPlace { origin: self.file.clone(), metres, hint })
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}
