//! Single fields: whole numbers and coordinates.

use crate::COORDINATE_LIMIT;
use crate::error::FormatProblem;
use crate::recording::FRAME_LIMIT;

/// Longest piece of a file that an error message quotes, in characters.
const QUOTED: usize = 40;

/// A frame or pedestrian number. Files write them as `12`, `12.0` or `1.2e1`.
pub(super) fn integer(text: &str, name: &'static str) -> Result<i64, FormatProblem> {
    let text = text.trim();
    let number = text.parse::<i64>().ok().or_else(|| {
        let number = text.parse::<f64>().ok()?;
        // Within the limit every whole f64 is an i64 exactly.
        (number.fract() == 0.0 && number.abs() < FRAME_LIMIT as f64).then_some(number as i64)
    });
    number
        .filter(|n| n.unsigned_abs() < FRAME_LIMIT.unsigned_abs())
        .ok_or_else(|| FormatProblem::NotInteger {
            name,
            found: quoted(text),
        })
}

/// A coordinate (m).
pub(super) fn coordinate(text: &str, name: &'static str) -> Result<f64, FormatProblem> {
    let text = text.trim();
    match text.parse::<f64>() {
        Ok(number) if number.abs() <= COORDINATE_LIMIT => Ok(number),
        Ok(number) if number.is_finite() => Err(FormatProblem::TooFar {
            name,
            found: quoted(text),
        }),
        _ => Err(FormatProblem::NotFinite {
            name,
            found: quoted(text),
        }),
    }
}

/// A number of any size, NaN included, that is not used: it must be there.
pub(super) fn number(text: &str, name: &'static str) -> Result<(), FormatProblem> {
    text.parse::<f64>()
        .map(|_| ())
        .map_err(|_| FormatProblem::NotNumber {
            name,
            found: quoted(text),
        })
}

/// A piece of a file, shortened for a message.
pub(super) fn quoted(text: &str) -> String {
    match text.char_indices().nth(QUOTED) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_read_however_they_are_written() {
        for (text, number) in [
            ("12", 12),
            (" 12.0", 12),
            ("1.2e1", 12),
            ("-3", -3),
            ("0.0", 0),
        ] {
            assert_eq!(integer(text, "frame"), Ok(number), "{text}");
        }
        for text in [
            "",
            "1.5",
            "NaN",
            "inf",
            "1e300",
            "9007199254740992",
            "1,0",
            "0x10",
        ] {
            assert!(integer(text, "frame").is_err(), "{text}");
        }
    }

    #[test]
    fn only_finite_coordinates_are_read() {
        assert_eq!(coordinate("-1.5e-1", "x"), Ok(-0.15));
        for text in ["", "NaN", "inf", "-Infinity", "1e999", "1.2.3", "one"] {
            assert!(coordinate(text, "x").is_err(), "{text}");
        }
    }

    #[test]
    fn coordinates_beyond_the_world_are_refused() {
        for text in ["1e7", "-10000000"] {
            assert!(coordinate(text, "x").is_ok(), "{text}");
        }
        for text in ["10000000.1", "-1e30", "1e38", "1.7976931348623157e308"] {
            let refused = matches!(coordinate(text, "x"), Err(FormatProblem::TooFar { .. }));
            assert!(refused, "{text}");
        }
    }

    #[test]
    fn long_garbage_is_quoted_in_part() {
        let Err(FormatProblem::NotFinite { found, .. }) = coordinate(&"ä".repeat(500), "x") else {
            panic!("garbage must not be read");
        };
        assert_eq!(found.chars().count(), QUOTED + 3);
    }
}
