//! Templates with `{{slots}}`, and JSON that is safe inside an HTML page.

/// Replaces every `{{name}}` by its slot, once: slots in the inserted text are not replaced.
pub(super) fn fill(template: &str, slots: &[(&str, &str)]) -> String {
    let mut filled = String::with_capacity(template.len());
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let Some((name, after)) = after.split_once("}}") else {
            break;
        };
        let slot = slots.iter().find(|(known, _)| *known == name);
        assert!(slot.is_some(), "the template has an unknown slot `{name}`");
        filled.push_str(before);
        filled.push_str(slot.map_or("", |(_, text)| text));
        rest = after;
    }
    filled.push_str(rest);
    filled
}

/// JSON for a `<script type="application/json">` that cannot end the element.
pub(super) fn json_in_script(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    let mut rest = json;
    while let Some(at) = rest.find(['<', '\u{2028}', '\u{2029}']) {
        escaped.push_str(&rest[..at]);
        let mut characters = rest[at..].chars();
        match characters.next() {
            Some('\u{2028}') => escaped.push_str("\\u2028"),
            Some('\u{2029}') => escaped.push_str("\\u2029"),
            // `</script`, `<!--` and `<script` begin with it.
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
    fn what_is_filled_in_is_not_filled_again() {
        let slots = [("a", "{{b}}"), ("b", "2")];
        assert_eq!(fill("x {{a}} y {{b}} {{", &slots), "x {{b}} y 2 {{");
    }
}
