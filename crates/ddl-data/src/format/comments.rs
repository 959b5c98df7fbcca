//! Comments of text: lines that hold no observation, and what they say.

use crate::format::choice::ColumnChoice;
use crate::format::column_names::is_known;
use crate::format::separator::Separator;

/// Begin a line that holds no observation.
const COMMENTS: [char; 2] = ['#', '%'];
/// Known names of columns that make a comment a header: prose may have one or two.
const KNOWN_NAMES: usize = 3;

/// Comments, and the line in which a spreadsheet names its separator.
pub(super) fn is_comment(text: &str) -> bool {
    let text = text.trim_start();
    text.starts_with(COMMENTS) || text.starts_with("//") || text.starts_with("sep=")
}

/// The rate that a comment states, such as `# framerate: 16 fps`.
pub(super) fn rate_of(comment: &str) -> Option<f64> {
    let text = comment.to_ascii_lowercase();
    let after = ["framerate", "frame rate", "frame_rate", "fps"]
        .iter()
        .find_map(|word| {
            let (_, after) = text.split_once(word)?;
            Some(after)
        })?;
    let number = after.trim_start_matches([':', '=', ' ', '\t']);
    let number = number
        .split_ascii_whitespace()
        .next()?
        .trim_end_matches(|c: char| c.is_alphabetic() || ",;.)".contains(c));
    let (above, below) = number.split_once('/').unwrap_or((number, "1"));
    let rate = above.parse::<f64>().ok()? / below.parse::<f64>().ok()?;
    (rate.is_finite() && rate > 0.0).then_some(rate)
}

/// The names of `count` columns in a comment, as numpy writes them: at least three of them are known.
pub(super) fn names_in_comment(comment: &str, count: usize, choice: &ColumnChoice) -> Option<Vec<String>> {
    let text = comment.trim_start().trim_start_matches(COMMENTS).trim();
    let text = text.rsplit_once(':').map_or(text, |(_, names)| names.trim());
    let names = Separator::of(text).fields(text, 1).ok()?;
    let names: Vec<String> = names.into_iter().map(std::borrow::Cow::into_owned).collect();
    let is_known =
        |name: &&String| is_known(name) || choice.roles.iter().any(|(_, chosen)| chosen.eq_ignore_ascii_case(name));
    (names.len() == count && names.iter().filter(is_known).count() >= KNOWN_NAMES).then_some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_read_whole_or_not_at_all() {
        for (comment, rate) in [
            ("# framerate: 16 fps", Some(16.0)),
            ("#framerate: 16.00", Some(16.0)),
            ("# fps=25fps", Some(25.0)),
            ("# r_frame_rate=30000/1001", Some(30_000.0 / 1001.0)),
            ("# fps: 1e1", Some(10.0)),
            ("# fps: 25, exact", Some(25.0)),
            ("# recorded (at fps: 25).", Some(25.0)),
            ("# fps: 29,97", None),
            ("# fps 0", None),
            ("# fps: -1", None),
            ("# fps: 5/0", None),
            ("# no rate", None),
        ] {
            assert_eq!(rate_of(comment), rate, "{comment}");
        }
    }
}
