//! One table of comparable results: how they were measured, the table, what it cannot show.

use ddl_data::WindowRule;

use super::{categories, further, group::Group, recordings, significance, whole_forecast};
use crate::document::{Part, Table};

/// What a table shows where there is nothing to show.
pub(super) const NOTHING: &str = "-";

/// The results of one group, from its heading to its further metrics.
pub(super) fn parts(group: &Group<'_>) -> Vec<Part> {
    let rule = describe_rule(group.window_rule);
    let subset = group.test_subset.unwrap_or("all test windows");
    let mut parts = vec![
        Part::heading(group.title()),
        Part::List(vec![
            format!(
                "Protocol `{}`: {}.",
                group.protocol,
                group.protocol.description()
            ),
            format!("Window rule `{}`: {rule}.", group.window_rule),
            format!("Scored: {subset}."),
            "Cells: minADE/minFDE in metres over the hypotheses of each pedestrian, mean over \
             pedestrians; `mean`: plain mean of the folds, given when all are there; ±: standard \
             deviation over seeds."
                .to_owned(),
            "What the other columns are: see \"How to read the tables\", below.".to_owned(),
        ]),
    ];
    if let Some(warning) = group.protocol.warning() {
        parts.push(Part::Warning(warning.to_owned()));
    }
    parts.push(Part::Table(headline(group).captioned(caption(group))));
    parts.push(Part::List(conditions(group)));
    parts.extend(recordings::parts(group));
    let metrics = |name: &str, columns: &[further::Column]| {
        let caption = format!("{name}. {}", group.conditions_in_words());
        let table = further::table(group, columns).captioned(caption);
        [Part::subheading(name), Part::Table(table)]
    };
    let mut more: Vec<Part> = Vec::new();
    more.extend(metrics("Further metrics", &further::COLUMNS));
    more.extend(metrics("The forecast as a whole", &whole_forecast::COLUMNS));
    more.extend(significance::parts(group));
    more.extend(categories::parts(group));
    parts.push(Part::Details {
        summary: "Further metrics, the forecast as a whole, how sure the means are, by category of walker".to_owned(),
        parts: more,
    });
    parts
}

fn caption(group: &Group<'_>) -> String {
    format!("minADE/minFDE in metres. {}", group.conditions_in_words())
}

fn describe_rule(rule: WindowRule) -> String {
    match rule {
        WindowRule::Published => "the windows of the published STAR and DDL code".to_owned(),
        WindowRule::Complete => "every pedestrian with all 20 frames, every start".to_owned(),
        WindowRule::SocialGan { min_pedestrians } => {
            format!("as Social-GAN cuts them, windows of at least {min_pedestrians} pedestrians")
        }
        other => format!("{other:?}"),
    }
}

fn headline(group: &Group<'_>) -> Table {
    let folds = group.folds();
    let columns = ["forecaster"]
        .into_iter()
        .chain(folds.iter().copied())
        .chain(["mean"]);
    let mut table = Table::new(columns);
    let walkers = folds.iter().map(|fold| {
        let counts: Vec<String> = group.walkers(fold).iter().map(usize::to_string).collect();
        if counts.is_empty() {
            NOTHING.to_owned()
        } else {
            counts.join(" or ")
        }
    });
    table.row(["walkers scored".to_owned()].into_iter().chain(walkers));
    for (line, label) in group.lines.iter().zip(group.labels()) {
        let cells = folds.iter().map(|fold| {
            pair(
                line.on_fold(fold, |s| s.min_ade),
                line.on_fold(fold, |s| s.min_fde),
            )
        });
        let mean = pair(
            line.over_folds(&folds, |s| s.min_ade),
            line.over_folds(&folds, |s| s.min_fde),
        );
        table.row([label].into_iter().chain(cells).chain([mean]));
    }
    table
}

pub(super) fn pair<T: std::fmt::Display>(ade: Option<T>, fde: Option<T>) -> String {
    match (ade, fde) {
        (Some(ade), Some(fde)) => format!("{ade}/{fde}"),
        _ => NOTHING.to_owned(),
    }
}

/// Under what conditions each line came about; lines alike are named together.
fn conditions(group: &Group<'_>) -> Vec<String> {
    let mut alike: Vec<(String, Vec<String>)> = Vec::new();
    for (line, label) in group.lines.iter().zip(group.labels()) {
        let settings = line.settings();
        match alike.iter_mut().find(|(known, _)| *known == settings) {
            Some((_, labels)) => labels.push(label),
            None => alike.push((settings, vec![label])),
        }
    }
    alike
        .iter()
        .map(|(settings, labels)| format!("{}: {settings}.", labels.join(", ")))
        .collect()
}
