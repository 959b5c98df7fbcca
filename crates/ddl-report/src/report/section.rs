//! The section of one table: its conditions, the table, further tables.

use crate::document::{Part, Table};
use crate::report::cells::{counts, errors};
use crate::report::group::ResultGroup;
use crate::report::{categories, metrics, recordings, significance};
use ddl_data::WindowRule;
use ddl_eval::Protocol;

pub(super) fn parts(group: &ResultGroup<'_>) -> Vec<Part> {
    let rule = describe_rule(group.window_rule);
    let subset = group.test_subset.unwrap_or("all test windows");
    let mut parts = vec![
        Part::heading(group.title()),
        Part::List(vec![
            format!("Protocol `{}`: {}.", group.protocol, group.protocol.description()),
            format!("Window rule `{}`: {rule}.", group.window_rule),
            format!("Scored: {subset}."),
            format!(
                "Cells: {} in metres over the {}, mean over pedestrians; `mean`: plain mean of all folds; ±: standard \
                 deviation over seeds.",
                group.errors(),
                match group.protocol {
                    Protocol::Joint => "futures of each scene",
                    _ => "hypotheses of each pedestrian",
                }
            ),
            "The other columns: see \"How to read the tables\", below.".to_owned(),
        ]),
    ];
    parts.extend(group.warning());
    parts.push(Part::Table(headline(group).captioned(format!(
        "{} in metres. {}",
        group.errors(),
        group.conditions_in_words()
    ))));
    parts.push(Part::List(conditions(group)));
    parts.extend(recordings::parts(group));
    let mut more = metrics::parts(group);
    more.extend(significance::parts(group));
    more.extend(categories::parts(group));
    parts.push(Part::Details {
        summary: "Further metrics, the forecast as a whole, how sure the means are, by category of \
            pedestrian"
            .to_owned(),
        parts: more,
    });
    parts
}

fn describe_rule(rule: WindowRule) -> String {
    match rule {
        WindowRule::Published => "the windows of the published STAR and DDL code".to_owned(),
        WindowRule::Complete => "every pedestrian with all 20 frames, every start".to_owned(),
        WindowRule::Observed => "every moment; pedestrians with all 20 steps, and all others as neighbours".to_owned(),
        WindowRule::SocialGan { min_pedestrians } => {
            format!("as Social-GAN cuts them, windows of at least {min_pedestrians} pedestrians")
        }
        other => format!("{other:?}"),
    }
}

fn headline(group: &ResultGroup<'_>) -> Table {
    let folds = group.folds();
    let mut table = Table::of_folds(&["forecaster"], &folds, &["mean"]);
    let pedestrians = folds.iter().map(|fold| counts(group.pedestrians(fold)));
    table.row(["pedestrians scored".to_owned()].into_iter().chain(pedestrians));
    for (line, label) in group.labelled() {
        table.row([label].into_iter().chain(errors(line, &folds)));
    }
    table
}

/// The conditions of each line; lines with the same conditions are named together.
fn conditions(group: &ResultGroup<'_>) -> Vec<String> {
    let mut alike: Vec<(String, Vec<String>)> = Vec::new();
    for (line, label) in group.labelled() {
        let settings = line.settings();
        match alike.iter_mut().find(|(others, _)| *others == settings) {
            Some((_, labels)) => labels.push(label),
            None => alike.push((settings, vec![label])),
        }
    }
    alike.iter().map(|(settings, labels)| format!("{}: {settings}.", labels.join(", "))).collect()
}
