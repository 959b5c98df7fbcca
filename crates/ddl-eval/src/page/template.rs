//! A text with `{{slots}}`, filled once: what is filled in is never looked at again.

/// Replaces every `{{name}}` that `slots` knows.
///
/// # Panics
/// When a slot of the template is not among `slots`: both are part of this crate.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_is_not_filled_again() {
        let slots = [("a", "{{b}}"), ("b", "2")];
        assert_eq!(fill("x {{a}} y {{b}} {{", &slots), "x {{b}} y 2 {{");
    }

    #[test]
    #[should_panic(expected = "unknown slot `c`")]
    fn an_unknown_slot_is_a_mistake_of_ours() {
        let _ = fill("{{c}}", &[]);
    }
}
