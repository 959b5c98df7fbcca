//! Texts of problems in files of tracks; each says how to solve it.

use std::fmt::Display;

pub(super) const EMPTY: &str = "the file holds no observation; is it empty or cut off?";
pub(super) const NOT_UTF8: &str = "the text is not UTF-8; export the file as plain UTF-8 or ASCII text";

pub(super) fn field_count(expected: usize, found: usize, names: &str) -> String {
    format!("{found} fields where {expected} are expected ({names})")
}

pub(super) fn duplicate(pedestrian: impl Display, frame: i64, first_line: usize) -> String {
    format!("pedestrian {pedestrian} is in frame {frame} already (line {first_line}); keep one row")
}

pub(super) fn not_integer(name: &str, found: &str) -> String {
    let wanted = match name {
        "pedestrian" => "a whole number or a word",
        _ => "a whole number below 2^53 in size",
    };
    let is_number = found.parse::<f64>().is_ok_and(f64::is_finite);
    let advice = match name {
        "frame" if is_number && found.contains('.') => "; is it a time? Count frames instead: 0, 1, 2, and so on",
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
