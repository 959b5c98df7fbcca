//! The first screen: what was measured, the best result with its conditions, and the comparison.

use std::fmt::Write as _;

use super::{
    headline_chart::{MOST_LINES, Shape, headline_chart},
    standing::{Standing, StandingLine, standing},
};
use crate::{
    Report,
    document::{escape, inline},
};

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
        "minADE and minFDE in metres, less is better; the number is minADE. {} K: hypotheses of each pedestrian, of \
         which the best is scored. {} The tables below hold every number.",
        standing.in_words,
        shown_of(standing.lines.len())
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

fn shown_of(lines: usize) -> String {
    if lines > MOST_LINES {
        format!("The first {MOST_LINES} of {lines} are drawn.")
    } else {
        String::new()
    }
}

fn verdict(standing: &Standing, subject: &StandingLine) -> String {
    let mut measured = standing.folds.iter().zip(&subject.folds);
    let first = measured.find_map(|(fold, pair)| Some((fold, (*pair)?)));
    let ([ade, fde], over) = match (subject.mean, standing.folds.as_slice(), first) {
        (Some(mean), [one], _) => (mean, format!("on `{one}`")),
        (Some(mean), all, _) if standing.all_folds => (mean, format!("plain mean of the {} folds", all.len())),
        (Some(mean), some, _) => (
            mean,
            format!("plain mean of the {} folds measured: {}", some.len(), some.join(", ")),
        ),
        (None, _, Some((fold, pair))) => (
            pair,
            format!("on `{fold}`, because it lacks other folds of this report"),
        ),
        (None, _, None) => return String::new(),
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

/// Text with the rank of the line by minADE, among lines with the same folds and the same number of hypotheses.
fn rank(standing: &Standing, subject: &StandingLine) -> String {
    let ranked: Vec<&StandingLine> = standing.comparable(subject).collect();
    let (Some(best), Some(_)) = (ranked.first(), subject.mean) else {
        return String::new();
    };
    let guesses = match subject.hypotheses {
        1 => "one hypothesis".to_owned(),
        several => format!("{several} hypotheses"),
    };
    let of_all = format!("the {} measured with {guesses}", forecasters(ranked.len()));
    match best.mean {
        Some([ade, fde]) if best.label != subject.label => {
            let label = escape(&best.label);
            format!("Of {of_all}, {label} has the least error ({ade:.3}/{fde:.3} m).")
        }
        _ if ranked.len() > 1 => format!("It has the least error of {of_all}."),
        _ => String::new(),
    }
}

fn facts(standing: &Standing, subject: &StandingLine) -> String {
    let [pedestrians, windows] = subject.scored.map(grouped);
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
                "{pedestrians} pedestrians in {windows} test windows of {}; scored: {}",
                standing.folds.join(", "),
                standing.shared.test_subset.as_deref().unwrap_or("all test windows")
            ),
        ),
        ("Conditions", subject.settings.clone()),
    ];
    let mut html = "<dl class=\"facts\">\n".to_owned();
    for (name, words) in facts {
        let _ = writeln!(html, "<div><dt>{name}</dt><dd>{}</dd></div>", inline(&words));
    }
    html + "</dl>\n"
}

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
