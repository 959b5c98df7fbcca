//! Comparison of the output shown on a page with the real output.

/// Whether a shown line matches a line; `...` in it matches any text.
pub fn line_matches(shown: &str, line: &str) -> bool {
    let mut parts = shown.split("...");
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = line.strip_prefix(first) else {
        return false;
    };
    let parts: Vec<&str> = parts.collect();
    let Some((last, middle)) = parts.split_last() else {
        return rest.is_empty();
    };
    for part in middle {
        match rest.find(part) {
            Some(at) => rest = &rest[at + part.len()..],
            None => return false,
        }
    }
    rest.ends_with(last)
}

/// The first shown line that is not in the answer after those before it; a line `...` matches any lines.
pub fn first_missing<'a>(shown: &'a [String], answer: &str) -> Option<&'a str> {
    let mut lines = answer.lines().map(str::trim);
    let lines_to_show = shown.iter().map(|line| line.trim());
    lines_to_show
        .filter(|line| !line.is_empty() && *line != "...")
        .find(|wanted| !lines.any(|line| line_matches(wanted, line)))
}
