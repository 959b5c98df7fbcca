//! JSON inside a page.

/// JSON that can stand in a `<script type="application/json">`: the same value to a parser, and nothing in it that ends
/// the element or that older scripts take for the end of a line.
///
/// `<` occurs in JSON inside strings alone, so that its escape `\u003c` means the same.
pub(super) fn json_in_script(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    let mut rest = json;
    while let Some(at) = rest.find(['<', '\u{2028}', '\u{2029}']) {
        escaped.push_str(&rest[..at]);
        let mut characters = rest[at..].chars();
        match characters.next() {
            Some('\u{2028}') => escaped.push_str("\\u2028"),
            Some('\u{2029}') => escaped.push_str("\\u2029"),
            // What `</script`, `<!--` and `<script` begin with.
            _ if rest[at + 1..].starts_with(['/', '!', 's', 'S']) => {
                escaped.push_str("\\u003c");
            }
            _ => escaped.push('<'),
        }
        rest = characters.as_str();
    }
    escaped + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_ends_the_element_and_the_value_stays() {
        let value =
            serde_json::json!({"a </script>": ["<!-- <script>", "x < y", "\u{2028}\u{2029}"]});
        let text = json_in_script(&value.to_string());
        for end in ["</", "<!--", "<script", "\u{2028}", "\u{2029}"] {
            assert!(!text.contains(end), "{text}");
        }
        assert!(text.contains("x < y"));
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&text).unwrap(),
            value
        );
    }
}
