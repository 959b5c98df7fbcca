//! The first screen: what was measured, the best result with its conditions, and the comparison.

use crate::document::{inline, warning};
use crate::page::headline_chart::{ChartShape, MOST_LINES, headline_chart};
use crate::page::standing::{Standing, StandingLine, standing};
use crate::report::Report;
use maud::{Markup, html};
use std::cmp::Ordering;

pub(super) fn headline(report: &Report) -> Markup {
    let Some(standing) = standing(report) else { return html! { p.nothing { "This report holds no results." } } };
    let subject = standing.subject();
    let [ade, fde] = standing.shared.protocol.errors();
    let lines = standing.lines.len();
    let caption = format!(
        "{ade} and {fde} in metres, less is better; the number is {ade}. {} K: hypotheses of each pedestrian, of \
         which the best is scored. {} The tables below hold every number.",
        standing.in_words,
        if lines > MOST_LINES { format!("The first {MOST_LINES} of {lines} are drawn.") } else { String::new() }
    );
    html! {
        @if let Some(line) = subject { (verdict(&standing, line)) }
        @if let Some(words) = standing.shared.protocol.warning() { (warning(words)) }
        figure.comparison {
            (headline_chart(&standing, ChartShape::Wide).inline("wide"))
            (headline_chart(&standing, ChartShape::Narrow).inline("narrow"))
            figcaption { (inline(&caption)) }
        }
        @if let Some(line) = subject { (facts(&standing, line)) }
    }
}

fn verdict(standing: &Standing, subject: &StandingLine) -> Markup {
    let mut measured = standing.folds.iter().zip(&subject.folds);
    let first = measured.find_map(|(fold, pair)| Some((fold, (*pair)?)));
    let (errors, over) = match (subject.mean, standing.folds.as_slice(), first) {
        (Some(mean), [one], _) => (mean, format!("on `{one}`")),
        (Some(mean), folds, _) if standing.all_folds => (mean, format!("plain mean of the {} folds", folds.len())),
        (Some(mean), folds, _) => {
            (mean, format!("plain mean of the {} folds measured: {}", folds.len(), folds.join(", ")))
        }
        (None, _, Some((fold, pair))) => (pair, format!("on `{fold}`, because it lacks other folds of this report")),
        (None, _, None) => return Markup::default(),
    };
    html! {
        div.best {
            p.verdict {
                strong { (subject.label) } " under protocol " code { (standing.shared.protocol) } ": "
                (inline(&over)) ", convention " code { (standing.shared.convention) } ". "
                (rank(standing, subject))
            }
            div.numbers {
                @for (name, value) in standing.shared.protocol.errors().into_iter().zip(errors) {
                    div.number {
                        b data-number=(name) { (format!("{value:.3}")) }
                        span.unit { "m" }
                        span.name { (name) ", best of " (subject.hypotheses) }
                    }
                }
            }
        }
    }
}

/// Text with the rank of the line by its first error as printed, among other forecasters with the same folds and number
/// of hypotheses.
fn rank(standing: &Standing, subject: &StandingLine) -> String {
    let others: Vec<&StandingLine> = standing.others(subject).collect();
    let (Some([own, _]), Some(best)) = (subject.mean, others.first()) else { return String::new() };
    let Some([ade, fde]) = best.mean else { return String::new() };
    let guesses = match subject.hypotheses {
        1 => "one hypothesis".to_owned(),
        several => format!("{several} hypotheses"),
    };
    let label = &best.label;
    let of_all = format!("the {} forecasters measured with {guesses}", others.len() + 1);
    let printed = |error: f64| format!("{error:.3}");
    match own.total_cmp(&ade) {
        _ if printed(own) == printed(ade) => format!("Of {of_all}, it and {label} have the same error."),
        Ordering::Less => format!("It has the least error of {of_all}."),
        _ => format!("Of {of_all}, {label} has the least error ({ade:.3}/{fde:.3} m)."),
    }
}

fn facts(standing: &Standing, subject: &StandingLine) -> Markup {
    let [pedestrians, windows] = subject.scored.map(grouped);
    let measured = standing.folds.iter().zip(&subject.folds);
    let measured = measured.filter_map(|(fold, errors)| errors.is_some().then_some(fold.as_str()));
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
                measured.collect::<Vec<_>>().join(", "),
                standing.shared.test_subset.as_deref().unwrap_or("all test windows")
            ),
        ),
        ("Conditions", subject.settings.clone()),
    ];
    html! {
        dl.facts {
            @for (name, words) in &facts { div { dt { (name) } dd { (inline(words)) } } }
        }
    }
}

fn grouped(count: usize) -> String {
    match count {
        0..1000 => count.to_string(),
        _ => format!("{},{:03}", grouped(count / 1000), count % 1000),
    }
}
