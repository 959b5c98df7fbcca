//! Parsing of single fields: whole numbers, pedestrians and coordinates.

use ddl_core::{COORDINATE_LIMIT, FRAME_LIMIT, PedestrianName, is_frame};
use time::format_description::well_known::Iso8601;
use time::{OffsetDateTime, PrimitiveDateTime};

use crate::clock::{STAMPS_A_SECOND, TimeUnit};
use crate::format::fault::Problem;
use crate::format::problem::{not_a_time, not_finite, not_integer, value};
use crate::format::quoted::{escaped, quoted};

/// Longest word that names a pedestrian, in bytes.
const LONGEST_WORD: usize = 256;

const DATE: &str = "a date with a time such as 2026-05-31T12:00:00.4Z";

/// A field without blanks around it. Most fields have none.
pub(super) fn trimmed(field: &str) -> &str {
    let is_letter = |byte: Option<&u8>| byte.is_none_or(u8::is_ascii_graphic);
    let bytes = field.as_bytes();
    if is_letter(bytes.first()) && is_letter(bytes.last()) { field } else { field.trim() }
}

/// A frame or pedestrian number. Files write them as `12`, `12.0` or `1.2e1`.
pub(super) fn integer(text: &str, name: &str) -> Result<i64, Problem> {
    whole_number(trimmed(text)).ok_or_else(|| not_integer(name, trimmed(text)))
}

fn whole_number(text: &str) -> Option<i64> {
    let number = text.parse::<i64>().ok().or_else(|| {
        let number = text.parse::<f64>().ok()?;
        // Within the limit every whole `f64` is exactly an `i64`.
        (number.fract() == 0.0 && number.abs() < FRAME_LIMIT as f64).then_some(number as i64)
    });
    number.filter(|number| is_frame(*number))
}

/// A frame number or, with a unit, a time in microseconds.
pub(super) fn frame(text: &str, name: &str, unit: Option<TimeUnit>) -> Result<i64, Problem> {
    match unit {
        None => integer(text, name),
        Some(unit) => time(text.trim(), name, unit),
    }
}

fn time(text: &str, name: &str, unit: TimeUnit) -> Result<i64, Problem> {
    let Some((a_second, _)) = unit.a_second() else {
        let stamp = date(text).ok_or_else(|| not_a_time(text, DATE))?;
        let near = Some(stamp).filter(|stamp| stamp.abs() < FRAME_LIMIT);
        return near.ok_or_else(|| format!("time {} is not within 285 years of 1970", quoted(text)).into());
    };
    let scale = STAMPS_A_SECOND as f64 / a_second as f64;
    // Whole nanoseconds since 1970 have more digits than an `f64`.
    let whole = text.parse::<i64>().ok().filter(|_| a_second > STAMPS_A_SECOND);
    let whole = whole.map(|number| number.div_euclid(a_second / STAMPS_A_SECOND) as f64);
    let stamp = whole.or_else(|| Some((text.parse::<f64>().ok()? * scale).round()));
    let stamp = stamp.filter(|stamp| stamp.is_finite());
    let stamp = stamp.ok_or_else(|| not_a_time(text, format!("a number, or in all rows {DATE}")))?;
    if stamp.abs() >= FRAME_LIMIT as f64 {
        let finer = match name {
            "frame" => "call the column time_ms, or time_us or time_ns",
            _ => "write seconds",
        };
        let limit = "is not within 285 years of 1970; if it counts milliseconds";
        return Err(format!("time {} {limit}, {finer}; divide ticks of 100 ns", quoted(text)).into());
    }
    Ok(stamp as i64)
}

/// Microseconds since 1970 of a date with a time.
fn date(text: &str) -> Option<i64> {
    let text = text.replacen(' ', "T", 1);
    let zoned = OffsetDateTime::parse(&text, &Iso8601::PARSING).ok();
    let date = zoned.or_else(|| Some(PrimitiveDateTime::parse(&text, &Iso8601::PARSING).ok()?.assume_utc()))?;
    i64::try_from(date.unix_timestamp_nanos().div_euclid(1000)).ok()
}

/// The unit of a column of times without a unit in its name, by its first value.
///
/// Seconds since 1970 have ten digits, finer units three more each.
pub(super) fn unit_of(text: &str) -> TimeUnit {
    let text = trimmed(text);
    match text.parse::<f64>() {
        Err(_) if date(text).is_some() => TimeUnit::Dates,
        Ok(number) if number >= 1e18 => TimeUnit::Nanoseconds,
        Ok(number) if number >= 1e14 => TimeUnit::Microseconds,
        Ok(number) if number >= 1e11 => TimeUnit::Milliseconds,
        _ => TimeUnit::Seconds,
    }
}

/// Whether a text is a number with a fraction, which is a time and no frame number.
pub(super) fn has_fraction(text: &str) -> bool {
    text.contains(['.', 'e', 'E']) && text.trim().parse::<f64>().is_ok_and(|number| number.fract().abs() > 0.0)
}

/// A pedestrian, by the rule of [`PedestrianName::of_text`]. Fractions, NaN, infinite numbers and empty fields are
/// refused.
pub(super) fn pedestrian(text: &str, name: &str) -> Result<PedestrianName, Problem> {
    let text = trimmed(text);
    match PedestrianName::of_text(text) {
        number @ PedestrianName::Number(_) => Ok(number),
        PedestrianName::Word(_) if text.is_empty() || is_fraction_or_infinite(text) => Err(not_integer(name, text)),
        PedestrianName::Word(_) => word(text, name),
    }
}

/// A pedestrian that is named by a word. Control characters, which would act on terminals, are replaced by their
/// escapes.
pub(super) fn word(text: &str, name: &str) -> Result<PedestrianName, Problem> {
    if text.len() > LONGEST_WORD {
        let (found, length) = (quoted(text), text.len());
        return Err(format!("{name} has {length} bytes, at most {LONGEST_WORD} are read, found {found:?}").into());
    }
    if !text.contains(char::is_control) {
        return Ok(PedestrianName::Word(text.to_owned()));
    }
    Ok(PedestrianName::Word(escaped(text)))
}

/// Whether a text is a fraction with a decimal point, NaN or infinite. `12e4567` is not: it counts as a word.
fn is_fraction_or_infinite(text: &str) -> bool {
    let digit = text.starts_with(|c: char| c.is_ascii_digit());
    let is_fraction = |number: f64| number.fract() != 0.0 && text.contains('.');
    text.parse::<f64>().is_ok_and(|number| if number.is_finite() { is_fraction(number) } else { !digit })
}

/// A coordinate in metres, written in units of which `per_metre` make a metre.
pub(super) fn coordinate(text: &str, name: &str, per_metre: f64) -> Result<f64, Problem> {
    let text = trimmed(text);
    match text.parse::<f64>().map(|number| number / per_metre) {
        Ok(number) if number.abs() <= COORDINATE_LIMIT => Ok(number),
        Ok(number) if number.is_finite() => {
            let found = format!("found {:?}; use an origin near the scene", quoted(text));
            Err(format!("{name} must lie within {COORDINATE_LIMIT} m of the origin, {found}").into())
        }
        _ => Err(not_finite(name, text)),
    }
}

/// Checks that an unused field holds a number, of any size or NaN.
pub(super) fn number(text: &str, name: &str) -> Result<(), Problem> {
    text.parse::<f64>().map(drop).map_err(|_| value(name, "a number", text))
}

/// Whether two values are the same word or the same number.
#[expect(clippy::float_cmp, reason = "1 and 1.0 are the same number")]
pub(super) fn are_alike(found: &str, asked: &str) -> bool {
    let numbers = found.parse::<f64>().ok().zip(asked.parse::<f64>().ok());
    found.eq_ignore_ascii_case(asked) || numbers.is_some_and(|(found, asked)| found == asked)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_parsed_in_every_spelling_and_other_texts_are_words() {
        for text in ["12", " 12.0", "1.2e1"] {
            assert_eq!(integer(text, "frame"), Ok(12), "{text}");
        }
        let read = |text: &str| pedestrian(text, "pedestrian");
        for text in ["12", " 12.0", "1.2e1"] {
            assert_eq!(read(text), Ok(PedestrianName::Number(12)));
        }
        for text in ["7f3e", "cam.0", "12e4567", "5e20", "9007199254740992", " a b ", "-0", "007", "0e12", "7e-2"] {
            assert_eq!(read(text), Ok(PedestrianName::Word(text.trim().into())));
        }
        assert_eq!(read("a\u{1b}[2Jb"), Ok(PedestrianName::Word("a\\u{1b}[2Jb".into())));
        assert!(read(&"w".repeat(256)).is_ok() && read(&"w".repeat(257)).is_err());
        for text in ["", " ", "1.5", "NaN", "inf", "-inf"] {
            assert!(integer(text, "frame").is_err() && read(text).is_err(), "{text}");
        }
        for text in ["1e300", "9007199254740992", "1,0", "0x10"] {
            assert!(integer(text, "frame").is_err(), "{text}");
        }
        for text in ["10000000.1", "1.2.3", "one", "-Infinity", "1e999"] {
            assert!(coordinate(text, "x", 1.0).is_err(), "{text}");
        }
        assert_eq!(coordinate("-1e7", "x", 1.0), Ok(-1e7));
        assert_eq!(quoted(&"ä".repeat(500)).chars().count(), 43);
    }
}
