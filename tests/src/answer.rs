//! Comparison of the output of a command on a page with its real output.

/// The first difference between the shown lines and the output; `None` if they agree. A shown line `...` stands for any
/// lines that are left out. Blanks at both ends of a line, and empty lines, do not count.
pub fn difference(shown: &[String], answer: &str) -> Option<String> {
    let is_there = |line: &&str| !line.is_empty();
    let shown: Vec<&str> = shown.iter().map(|line| line.trim()).collect();
    let parts: Vec<Vec<&str>> = shown
        .split(|line| *line == "...")
        .map(|part| part.iter().copied().filter(is_there).collect())
        .collect();
    let lines: Vec<&str> = answer.lines().map(str::trim).filter(is_there).collect();
    let last = parts.len() - 1;
    let mut at = 0;
    for (i, part) in parts.iter().enumerate() {
        let starts = match (i == 0, i == last) {
            (true, _) => 0..=0,
            (false, true) => lines.len().saturating_sub(part.len()).max(at)..=lines.len(),
            (false, false) => at..=lines.len(),
        };
        let fits = |&start: &usize| agree(part, lines.get(start..).unwrap_or_default());
        let Some(start) = starts.into_iter().find(fits) else {
            return Some(explain(part, &lines[at..], i > 0));
        };
        at = start + part.len();
    }
    let left = &lines[at..];
    let is_open = parts[last].is_empty() && last > 0;
    (!left.is_empty() && !is_open).then(|| format!("the page does not show {:?}, or `...` in its place", left[0]))
}

fn agree(part: &[&str], lines: &[&str]) -> bool {
    part.len() <= lines.len() && part.iter().zip(lines).all(|(a, b)| line_agrees(a, b))
}

fn explain(part: &[&str], lines: &[&str], anywhere: bool) -> String {
    let differs = |(shown, line): &(&&str, &&str)| !line_agrees(shown, line);
    // A part that may be anywhere is compared from its first line on.
    let begins = |line: &&str| anywhere && line_agrees(part[0], line);
    let lines = &lines[lines.iter().position(begins).unwrap_or(0)..];
    match part.iter().zip(lines).find(differs) {
        Some((shown, line)) => format!("the page shows {shown:?}, the answer has {line:?}"),
        None => format!("the page shows {:?}, the answer is shorter", part[part.len() - 1]),
    }
}

/// Whether two lines agree: their words are equal, and numbers with a decimal point differ by at most one unit of the
/// last shown digit, or 1e-5. The tolerance is needed because processors with other vector instructions round
/// differently.
fn line_agrees(shown: &str, line: &str) -> bool {
    let (mut shown, mut line) = (shown, line);
    loop {
        let (a, b) = (number_length(shown), number_length(line));
        if (a == 0) != (b == 0) {
            return false;
        }
        if a > 0 {
            if !numbers_agree(&shown[..a], &line[..b]) {
                return false;
            }
            (shown, line) = (&shown[a..], &line[b..]);
            continue;
        }
        match (shown.chars().next(), line.chars().next()) {
            (None, None) => return true,
            (Some(a), Some(b)) if a == b => {
                (shown, line) = (&shown[a.len_utf8()..], &line[a.len_utf8()..]);
            }
            _ => return false,
        }
    }
}

/// Length in bytes of the number at the beginning of a text: digits with a decimal point.
fn number_length(text: &str) -> usize {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let whole = digits(text);
    let after = text[whole..].strip_prefix('.').map_or(0, digits);
    if whole == 0 || after == 0 {
        whole
    } else {
        whole + 1 + after
    }
}

fn numbers_agree(shown: &str, number: &str) -> bool {
    let decimals = |text: &str| text.split_once('.').map_or(0, |(_, after)| after.len());
    let places = decimals(shown).max(decimals(number));
    if places == 0 || shown == number {
        return shown == number;
    }
    let (Ok(a), Ok(b)) = (shown.parse::<f64>(), number.parse::<f64>()) else {
        return false;
    };
    let places = i32::try_from(places).unwrap_or(i32::MAX);
    (a - b).abs() <= 1.01 * 10_f64.powi(-places) + 1e-5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn differs(shown: &[&str], answer: &str) -> Option<String> {
        let shown: Vec<String> = shown.iter().map(|&line| line.to_owned()).collect();
        difference(&shown, answer)
    }

    #[test]
    fn what_a_page_leaves_out_is_marked_by_a_line_of_dots() {
        for shown in [
            &["a", "b", "c"][..],
            &["a", "..."],
            &["...", "c"],
            &["a", "...", "c"],
            &["...", "b", "..."],
            &["..."],
        ] {
            assert_eq!(differs(shown, "a\n\n  b\nc\n"), None, "{shown:?}");
        }
        for (shown, wrong) in [
            (&["a", "b"][..], "does not show \"c\""),
            (&["b", "c"], "shows \"b\", the answer has \"a\""),
            (&["a", "c"], "shows \"c\", the answer has \"b\""),
            (&["...", "b"], "shows \"b\""),
            (&["a", "...", "d"], "shows \"d\""),
            (&["a", "b", "c", "d"], "shows \"d\", the answer is shorter"),
            (&["...", "c", "...", "b", "..."], "shows \"b\""),
            (&["a", "b..."], "shows \"b...\""),
        ] {
            let found = differs(shown, "a\nb\nc\n").unwrap_or_default();
            assert!(found.contains(wrong), "{shown:?}: {found}");
        }
    }

    #[test]
    fn the_last_place_of_a_decimal_number_may_differ_and_no_word_or_count() {
        for (shown, line) in [("x 0.123 m", "x 0.124 m"), ("-1.50,2", "-1.49,2"), ("0.9999999", "1.0")] {
            assert!(line_agrees(shown, line), "{shown}, {line}");
        }
        for (shown, line) in [
            ("x 0.123 m", "x 0.125 m"),
            ("x 0.123 m", "y 0.123 m"),
            ("12 of 20", "13 of 20"),
            ("1.", "2."),
            ("-0.5", "0.5"),
            ("a 1", "a"),
        ] {
            assert!(!line_agrees(shown, line), "{shown}, {line}");
        }
    }
}
