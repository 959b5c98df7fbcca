//! Whether forecasts begin where their pedestrians are.

use ddl_data::{OBSERVED, Position};

use super::error::ExternalError;
use super::matched::Matched;
use crate::metric::displacement::distance;

/// Nobody is this far away after 0.4 s, m: half of the pedestrians of a file cannot be.
const FARTHEST: f64 = 3.0;

impl Matched {
    /// Refuses files of which half of the likeliest forecasts begin more than 3 m from the last observed position.
    pub(super) fn ensure_in_place(&self) -> Result<(), ExternalError> {
        let starts: Vec<(Position, Position)> = self
            .windows
            .iter()
            .zip(&self.forecasts)
            .flat_map(|(window, forecast)| {
                (0..window.len()).map(move |i| {
                    let first = forecast.hypothesis(i, forecast.most_likely(i))[0];
                    (window.observed(i)[OBSERVED - 1], first)
                })
            })
            .collect();
        let apart = |as_if: fn(Position, Position) -> Position| {
            median(
                starts
                    .iter()
                    .map(|&(last, first)| distance(last, as_if(last, first))),
            )
        };
        let metres = apart(|_, first| first);
        if metres <= FARTHEST {
            return Ok(());
        }
        let hint = if apart(|_, [x, y]| [y, x]) <= FARTHEST {
            "they would begin there if x and y were exchanged, as they are between the conventions star and social-gan"
        } else if apart(|last, first| [last[0] + first[0], last[1] + first[1]]) <= FARTHEST {
            "they would begin there if they were relative to the last observed position: add it"
        } else {
            "are they in metres, and of the same data convention and fold?"
        };
        Err(ExternalError::OutOfPlace {
            origin: self.file().to_owned(),
            metres,
            hint,
        })
    }
}

/// The middle value, of an even number the lower of the two; 0 of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
        .get(values.len().saturating_sub(1) / 2)
        .copied()
        .unwrap_or(0.0)
}
