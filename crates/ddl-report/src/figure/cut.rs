//! Titles that do not fit.

use crate::figure::drawing::text_width;

/// A text of at most this width (pixels) at a size of letters; the rest is cut.
pub(crate) fn cut(text: &str, size: f64, width: f64) -> String {
    let fits = |line: &str| text_width(line, size) <= width;
    if fits(text) {
        return text.to_owned();
    }
    let mut line = text.to_owned();
    while !line.is_empty() && !fits(&format!("{line}…")) {
        line.pop();
    }
    line + "…"
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_line_fits_and_is_cut_only_if_it_must_be(text in "[a-zé,: ]{0,200}", width in 20.0..500.0_f64) {
            let line = cut(&text, 12.0, width);
            prop_assert!(text_width(&line, 12.0) <= width);
            prop_assert!(line == text || line.ends_with('…') && text_width(&text, 12.0) > width);
        }
    }
}
