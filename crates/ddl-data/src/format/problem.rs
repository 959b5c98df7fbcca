//! Texts of problems in files of tracks; each says how to solve it.

use std::fmt::Display;

use ddl_core::Setting;

use crate::clock::{Clock, TimeUnit};

pub(super) const EMPTY: &str = "the file holds no observation; is it empty or cut off?";
pub(super) const MIXED_TIMES: &str = "the time is of another kind than that of the first row; give all rows frame \
    numbers, seconds, or dates; a table calls a column of seconds time";
pub(super) const NOT_UTF8: &str = "the text is not UTF-8; export the file as plain UTF-8 or ASCII text";

pub(super) fn field_count(expected: usize, found: usize, names: &str) -> String {
    format!("{found} fields where {expected} are expected ({names})")
}

pub(super) fn duplicate(pedestrian: impl Display, (frame, unit): (i64, Option<TimeUnit>), first_line: usize) -> String {
    let coarse = unit.map_or_else(String::new, |_| {
        let frames = Setting::Columns.to("frame=NAME");
        format!(", or take frame numbers if the times are too coarse (of a table: {frames})")
    });
    let when = when(frame, unit);
    format!("pedestrian {pedestrian} is in {when} already (line {first_line}); keep one row{coarse}")
}

/// A frame, or a time in microseconds, in words.
pub(super) fn when(frame: i64, unit: Option<TimeUnit>) -> String {
    match unit {
        None => format!("frame {frame}"),
        Some(unit) => format!("time {}", Clock::with_stamps(unit).number(frame)),
    }
}

pub(super) fn not_a_time(name: &str, found: &str, wanted: &str) -> String {
    let advice = advice_on_number(found);
    format!("{name} must be {wanted}, found {found:?}{advice}")
}

pub(super) fn not_integer(name: &str, found: &str) -> String {
    let wanted = match name {
        "pedestrian" => "a whole number or a word",
        _ => "a whole number below 2^53 in size",
    };
    let is_number = found.parse::<f64>().is_ok_and(f64::is_finite);
    let advice = match name {
        "frame" if is_number && found.contains('.') => "; if it is a time in seconds, call the column time",
        "track.f" if is_number && found.contains('.') => "; if it is a time in seconds, write it as track.t",
        _ => advice_on_number(found),
    };
    format!("{name} must be {wanted}, found {found:?}{advice}")
}

pub(super) fn not_finite(name: &str, found: &str) -> String {
    let advice = advice_on_number(found);
    format!("{name} must be a finite number in metres, found {found:?}{advice}")
}

fn advice_on_number(found: &str) -> &'static str {
    if found.is_empty() || found.eq_ignore_ascii_case("nan") {
        "; leave out the row where a pedestrian was not seen"
    } else if found.replacen(',', ".", 1).parse::<f64>().is_ok() && found.contains(',') {
        "; use a decimal point"
    } else {
        ""
    }
}
