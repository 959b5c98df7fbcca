//! Line breaks of titles.

use crate::figure::drawing::text_width;

/// A text in at most `most` lines (at least one); the rest is cut.
pub(super) fn wrapped(text: &str, size: f64, width: f64, most: usize) -> Vec<String> {
    let fits = |line: &str| text_width(line, size) <= width;
    let at_pauses = broken(text, fits, most, true);
    if at_pauses.iter().all(|line| fits(line)) {
        return at_pauses;
    }
    let mut lines = broken(text, fits, most, false);
    for line in &mut lines {
        if !fits(line) {
            while !line.is_empty() && !fits(&format!("{line}…")) {
                line.pop();
            }
            line.push('…');
        }
    }
    lines
}

fn broken(text: &str, fits: impl Fn(&str) -> bool, most: usize, at_pauses: bool) -> Vec<String> {
    let (mut lines, mut line) = (Vec::new(), String::new());
    for word in text.split_whitespace() {
        if line.is_empty() {
            word.clone_into(&mut line);
            continue;
        }
        let longer = format!("{line} {word}");
        if fits(&longer) || lines.len() + 1 >= most {
            line = longer;
            continue;
        }
        let (full, rest) = match line.rfind([',', ':']) {
            // A comma inside a number is not a break.
            Some(pause) if at_pauses && line[pause + 1..].starts_with(' ') => {
                let (full, rest) = line.split_at(pause + 1);
                (full.to_owned(), format!("{} {word}", rest.trim_start()))
            }
            _ => (line, word.to_owned()),
        };
        lines.push(full);
        line = rest;
    }
    lines.push(line);
    lines
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SIZE: f64 = 12.0;

    #[test]
    fn long_titles_break_after_a_comma_or_colon() {
        for (lines, width) in [
            ("eth, frame 1234", 300.0),
            ("students003, frame 10510, pedestrian 204:|straight on", 300.0),
            ("pedestrians of the test scene whose goal is|the median one", 300.0),
            ("1,000 goals,|and one more", 112.0),
            ("many hypotheses,|so few goals", 112.0),
            ("all, of them as|it happens", 112.0),
        ] {
            let title = lines.replace('|', " ");
            assert_eq!(wrapped(&title, SIZE, width, 2).join("|"), lines);
        }
    }

    proptest! {
        #[test]
        fn lines_are_few_and_fit(text in "[a-zé,: ]{0,200}", width in 20.0..500.0_f64, most in 1..4_usize) {
            let lines = wrapped(&text, SIZE, width, most);
            prop_assert!((1..=most).contains(&lines.len()));
            prop_assert!(lines.iter().all(|line| text_width(line, SIZE) <= width));
            if !lines.iter().any(|line| line.ends_with('…')) {
                let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
                prop_assert_eq!(words(&lines.join(" ")), words(&text));
            }
        }
    }
}
