//! Links in Markdown: found outside code, and given another target.

/// `text` with every link and picture outside code changed to what `change` makes of its target.
///
/// Found are `[text](target)`, `[text]: target` at the beginning of a line, and `href="target"` and `src="target"`.
///
/// # Errors
/// The first error of `change`.
pub(super) fn rewrite<E>(
    text: &str,
    mut change: impl FnMut(&str) -> Result<String, E>,
) -> Result<String, E> {
    let mut out = String::with_capacity(text.len());
    let mut fence: Option<&str> = None;
    for line in text.split_inclusive('\n') {
        let start = line.trim_start();
        let mark = ["```", "~~~"]
            .into_iter()
            .find(|mark| start.starts_with(mark));
        match (fence, mark) {
            (None, Some(mark)) => fence = Some(mark),
            (Some(open), Some(mark)) if open == mark => fence = None,
            (None, None) => {
                rewrite_line(line, &mut out, &mut change)?;
                continue;
            }
            _ => {}
        }
        out.push_str(line);
    }
    Ok(out)
}

/// What stands before a target, and what ends it.
const OPENINGS: [(&str, char); 3] = [("](", ')'), ("href=\"", '"'), ("src=\"", '"')];

fn rewrite_line<E>(
    line: &str,
    out: &mut String,
    change: &mut impl FnMut(&str) -> Result<String, E>,
) -> Result<(), E> {
    if let Some((name, target)) = reference(line) {
        out.push_str(name);
        out.push_str(&change(target.trim())?);
        out.push('\n');
        return Ok(());
    }
    let mut rest = line;
    while !rest.is_empty() {
        if rest.starts_with('`') {
            let ticks = rest.len() - rest.trim_start_matches('`').len();
            let (mark, after) = rest.split_at(ticks);
            let end = after.find(mark).map_or(ticks, |at| ticks + at + ticks);
            let (code, after) = rest.split_at(end);
            out.push_str(code);
            rest = after;
            continue;
        }
        let opened = OPENINGS
            .iter()
            .find_map(|(opening, end)| Some((*opening, *end, rest.strip_prefix(opening)?)));
        if let Some((opening, end, after)) = opened
            && let Some(length) = after.find(end)
        {
            let (target, after) = after.split_at(length);
            let (target, title) = target
                .split_once(' ')
                .map_or((target, None), |(t, n)| (t, Some(n)));
            out.push_str(opening);
            out.push_str(&change(target)?);
            if let Some(title) = title {
                out.push(' ');
                out.push_str(title);
            }
            rest = after;
            continue;
        }
        let length = rest.chars().next().map_or(0, char::len_utf8);
        let (one, after) = rest.split_at(length);
        out.push_str(one);
        rest = after;
    }
    Ok(())
}

/// `[name]: target`, parted after the blank.
fn reference(line: &str) -> Option<(&str, &str)> {
    let inside = line.strip_prefix('[')?;
    let end = inside.find("]: ")?;
    (!inside[..end].contains(['[', ']', '('])).then(|| line.split_at(end + "[]: ".len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn marked(text: &str) -> String {
        rewrite(text, |target| Ok::<_, Infallible>(format!("<{target}>"))).unwrap()
    }

    #[test]
    fn links_pictures_references_and_html_are_found() {
        assert_eq!(
            marked("see [a](b.md#c) and ![d](e.svg)\n"),
            "see [a](<b.md#c>) and ![d](<e.svg>)\n"
        );
        assert_eq!(marked("[`X`]: y.md\n"), "[`X`]: <y.md>\n");
        assert_eq!(marked("<img src=\"p.png\">"), "<img src=\"<p.png>\">");
        assert_eq!(marked("[a](b.md \"title\")"), "[a](<b.md> \"title\")");
        assert_eq!(marked("[[x](y)], (z) and [w]"), "[[x](<y>)], (z) and [w]");
    }

    #[test]
    fn code_is_left_alone() {
        for text in [
            "`[a](b)` and ``[c](`d`)``\n",
            "```text\n[a](b)\n```\n",
            "  ```console\n  $ x [a](b)\n  ```\n",
            "~~~\n```\n[a](b)\n~~~\n",
            "an open ` and no more\n",
        ] {
            assert_eq!(marked(text), text);
        }
        assert_eq!(
            marked("```\n[a](b)\n```\n[c](d)\n"),
            "```\n[a](b)\n```\n[c](<d>)\n"
        );
    }

    #[test]
    fn the_first_error_ends_it() {
        assert_eq!(
            rewrite("[a](b) [c](d)", |target| Err::<String, _>(
                target.to_owned()
            )),
            Err("b".to_owned())
        );
    }
}
