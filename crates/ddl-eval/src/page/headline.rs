//! The first screen: what was measured, on what, the best result with its conditions, and what it is compared with.

use std::fmt::Write as _;

use super::{
    figure::{Shape, headline_chart},
    standing::{Standing, StandingLine, standing},
};
use crate::{
    Report,
    document::{escape, inline},
};

/// The head of the page, as HTML; a report without rows says so.
pub(super) fn headline(report: &Report) -> String {
    let Some(standing) = standing(report) else {
        return "<p class=\"nothing\">This report holds no results.</p>\n".to_owned();
    };
    let subject = standing.subject();
    let mut html = subject.map_or(String::new(), |line| verdict(&standing, line));
    if let Some(warning) = standing.shared.protocol.warning() {
        let _ = writeln!(
            html,
            "<p class=\"warning\" role=\"note\"><strong>Warning.</strong> {}</p>",
            inline(warning)
        );
    }
    let caption = format!(
        "minADE and minFDE in metres, less is better; the number is minADE. {} K: hypotheses a walker, the best of which is scored. Every number stands in the tables below.",
        conditions_in_words(&standing)
    );
    let _ = write!(
        html,
        "<figure class=\"comparison\">\n{}\n{}\n<figcaption>{}</figcaption>\n</figure>\n",
        headline_chart(&standing, Shape::Wide).inline("wide"),
        headline_chart(&standing, Shape::Narrow).inline("narrow"),
        inline(&caption)
    );
    html.extend(subject.map(|line| facts(&standing, line)));
    html
}

fn conditions_in_words(standing: &Standing) -> String {
    let c = &standing.shared;
    format!(
        "Data convention `{}`, window rule `{}`, protocol `{}`; scored: {}.",
        c.convention,
        c.window_rule,
        c.protocol,
        c.test_subset.as_deref().unwrap_or("all test windows")
    )
}

fn verdict(standing: &Standing, subject: &StandingLine) -> String {
    let Some([ade, fde]) = number_of(subject) else {
        return String::new();
    };
    let over = match standing.folds.as_slice() {
        [one] => format!("on `{one}`"),
        all if standing.all_folds => format!("plain mean of the {} folds", all.len()),
        some => format!(
            "plain mean of the {} folds measured: {}",
            some.len(),
            some.join(", ")
        ),
    };
    let number = |name: &str, value: f64| {
        format!(
            "<div class=\"number\"><b data-number=\"{name}\">{value:.3}</b><span class=\"unit\">m</span>\
             <span class=\"name\">{name}, best of {}</span></div>\n",
            subject.hypotheses
        )
    };
    let lead = format!(
        "<strong>{}</strong> under protocol <code>{}</code>: {}, {}. {}",
        escape(&subject.label),
        standing.shared.protocol,
        inline(&over),
        inline(&format!("convention `{}`", standing.shared.convention)),
        rank(standing, subject),
    );
    format!(
        "<div class=\"best\">\n<p class=\"verdict\">{lead}</p>\n<div class=\"numbers\">\n{}{}</div>\n</div>\n",
        number("minADE", ade),
        number("minFDE", fde)
    )
}

/// minADE and minFDE: the mean over the folds, or of the first fold there is.
fn number_of(line: &StandingLine) -> Option<[f64; 2]> {
    let first = || line.folds.iter().copied().find_map(|pair| pair);
    line.mean.or_else(first)
}

/// Where the line stands among all that are comparable, by minADE.
fn rank(standing: &Standing, subject: &StandingLine) -> String {
    let measured = forecasters(standing.lines.len());
    match standing.lines.first() {
        Some(best) if best.label != subject.label => {
            let numbers = number_of(best).map_or(String::new(), |[ade, fde]| {
                format!(" ({ade:.3}/{fde:.3} m)")
            });
            let label = escape(&best.label);
            format!("Of the {measured} measured, {label} errs least{numbers}.")
        }
        _ if standing.lines.len() > 1 => format!("It errs least of the {measured} measured."),
        _ => String::new(),
    }
}

fn facts(standing: &Standing, best: &StandingLine) -> String {
    let [walkers, windows] = best.scored.map(grouped);
    let facts = [
        (
            "Measured",
            format!(
                "how far 12 forecast positions (4.8 s) lie from the true ones, after 8 observed (3.2 s): {}",
                standing.shared.protocol.description()
            ),
        ),
        (
            "On",
            format!(
                "{walkers} walkers in {windows} test windows of {}; scored: {}",
                standing.folds.join(", "),
                standing
                    .shared
                    .test_subset
                    .as_deref()
                    .unwrap_or("all test windows")
            ),
        ),
        ("Conditions", conditions_of(best)),
    ];
    let mut html = "<dl class=\"facts\">\n".to_owned();
    for (name, words) in facts {
        let _ = writeln!(
            html,
            "<div><dt>{name}</dt><dd>{}</dd></div>",
            inline(&words)
        );
    }
    html + "</dl>\n"
}

/// 14968 as 14,968.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut words = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            words.push(',');
        }
        words.push(digit);
    }
    words
}

fn forecasters(count: usize) -> String {
    match count {
        1 => "one forecaster".to_owned(),
        several => format!("{several} forecasters"),
    }
}

/// Under what conditions a line came about.
fn conditions_of(line: &StandingLine) -> String {
    let c = &line.conditions;
    let seeds: Vec<String> = line.seeds.iter().map(u64::to_string).collect();
    let mut words = vec![match seeds.as_slice() {
        [] => "no seed (nothing random)".to_owned(),
        [one] => format!("seed {one}"),
        several => format!("mean of seeds {}", several.join(", ")),
    }];
    match c.epochs {
        None => words.push("not trained".to_owned()),
        Some(epochs) => {
            words.push(format!("{epochs} epochs"));
            words.extend(c.selection.clone());
            words.extend(c.recipe.clone());
            let subset = c
                .training_subset
                .as_deref()
                .unwrap_or("all training windows");
            words.push(format!("trained on {subset}"));
        }
    }
    let known = |text: &str| {
        if text.is_empty() {
            "unknown".to_owned()
        } else {
            text.to_owned()
        }
    };
    words.push(format!("device {}", known(&c.device)));
    words.push(format!("commit `{}`", known(&c.commit)));
    words.join("; ")
}

#[cfg(test)]
mod tests {
    #[test]
    fn digits_are_grouped() {
        assert_eq!(
            [0, 999, 1000, 1_234_567].map(super::grouped),
            ["0", "999", "1,000", "1,234,567"]
        );
    }
}
