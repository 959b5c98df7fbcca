//! Comments of text: lines that hold no observation, and what they say.

use crate::format::choice::ColumnChoice;
use crate::format::column_names::is_known;
use crate::format::header::ColumnRoles;
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
    let mut rates = Vec::new();
    for word in ["framerate", "frame rate", "frame_rate", "fps"] {
        for (at, _) in text.match_indices(word) {
            let after = text[at + word.len()..].trim_start();
            let value = after.trim_start_matches([':', '=', ' ', '\t']);
            let before = text[..at].rsplit(char::is_whitespace).find(|word| !word.is_empty());
            let near = [before, value.split_ascii_whitespace().next()].map(|word| word.and_then(rate));
            match near {
                // What is assigned is the rate, even if it is none.
                [_, assigned] if value.len() < after.len() => rates.push(assigned?),
                near => rates.extend(near.into_iter().flatten()),
            }
        }
    }
    rates.dedup();
    <[f64; 1]>::try_from(rates).ok().map(|[rate]| rate)
}

/// A word that is a rate, as `25`, `25fps`, `30000/1001`.
fn rate(word: &str) -> Option<f64> {
    let number = word.trim_matches(|c: char| ",;.()".contains(c));
    let number = number.strip_suffix("fps").or(number.strip_suffix("hz")).unwrap_or(number);
    let (above, below) = number.split_once('/').unwrap_or((number, "1"));
    let rate = above.parse::<f64>().ok()? / below.parse::<f64>().ok()?;
    (rate.is_finite() && rate > 0.0).then_some(rate)
}

/// The names of `count` columns in a comment, as numpy writes them: at least three of them are known. Without such a
/// comment fewer names that make a whole header, which the reader of the rows refuses.
pub(super) fn names_in_comments<'a>(
    comments: impl Iterator<Item = &'a str>,
    count: usize,
    choice: &ColumnChoice,
) -> Option<Vec<String>> {
    let names: Vec<Vec<String>> = comments.filter_map(|comment| names_in(comment, choice)).collect();
    let is_header = |names: &&Vec<String>| {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        names.len() < count && ColumnRoles::of_names(&names, choice).is_ok()
    };
    names.iter().rev().find(|names| names.len() == count).or_else(|| names.iter().rev().find(is_header)).cloned()
}

fn names_in(comment: &str, choice: &ColumnChoice) -> Option<Vec<String>> {
    let text = comment.trim_start().trim_start_matches(COMMENTS).trim();
    let text = text.rsplit_once(':').map_or(text, |(_, names)| names.trim());
    let names = Separator::of(text).fields(text).ok()?;
    let names: Vec<String> = names.into_iter().map(std::borrow::Cow::into_owned).collect();
    let is_known =
        |name: &&String| is_known(name) || choice.roles.iter().any(|(_, chosen)| chosen.eq_ignore_ascii_case(name));
    (names.iter().filter(is_known).count() >= KNOWN_NAMES).then_some(names)
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
            ("# 1080p, 25 fps", Some(25.0)),
            ("# 25 fps 1080p", Some(25.0)),
            ("# camera 25 fps, tracks at 2.5 fps", None),
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
