//! Texts of problems in files of tracks; each says how to solve it.

use std::borrow::Cow;
use std::fmt::Display;

use ddl_core::Setting;

use crate::clock::{Clock, TimeUnit};
use crate::format::fault::Problem;
use crate::format::quoted::quoted;

pub(super) const EMPTY: &str = "the file holds no observation; is it empty or cut off?";
pub(super) const MIXED_TIMES: &str = "the time is of another kind than that of the first row; give all rows frame \
    numbers, seconds, or dates; a table calls a column of seconds time";
pub(super) const NOT_UTF8: &str = "the text is not UTF-8; export the file as plain UTF-8 or ASCII text";

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

pub(super) fn not_a_time(found: &str, wanted: impl Into<Cow<'static, str>>) -> Problem {
    value("time", wanted, found).and(advice_on_number(found))
}

pub(super) fn not_integer(name: &str, found: &str) -> Problem {
    let wanted = match name {
        "pedestrian" => "a whole number or a word",
        _ => "a whole number below 2^53 in size",
    };
    let has_point = found.contains('.') && found.parse::<f64>().is_ok_and(f64::is_finite);
    value(name, wanted, found).and(match name {
        "frame" if has_point => "; if it is a time in seconds, call the column time",
        "track.f" if has_point => "; if it is a time in seconds, write it as track.t",
        _ => advice_on_number(found),
    })
}

pub(super) fn not_finite(name: &str, found: &str) -> Problem {
    value(name, "a finite number in metres", found).and(advice_on_number(found))
}

/// A value that must be another; what was found is quoted.
pub(super) fn value(name: &str, wanted: impl Into<Cow<'static, str>>, found: &str) -> Problem {
    Problem::value(name, wanted, format!("{:?}", quoted(found)))
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
