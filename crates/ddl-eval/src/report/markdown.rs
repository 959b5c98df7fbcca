//! The page that a report is printed as.

use std::fmt::Write;

use ddl_data::{Convention, WindowRule};

use super::{
    group::{Group, Line, groups},
    whole_forecast::{WHOLE_FORECAST, WHOLE_FORECAST_LEGEND},
};
use crate::{Conditions, ResultRow, Scores, literature, table::MarkdownTable};

/// What a table shows where there is nothing to show.
const NOTHING: &str = "-";

/// Variants of the ablation other than the whole method.
const ABLATED: [&str; 3] = ["no-goal-shift", "no-dynamics", "star"];

pub(super) fn page(title: &str, rows: &[ResultRow]) -> String {
    let groups = groups(rows);
    let mut page = format!("{}\n\n# {title}\n", first_line(&groups));
    for group in &groups {
        page.push_str(&section(group));
    }
    page.push_str(&published(rows));
    page
}

fn first_line(groups: &[Group<'_>]) -> String {
    let mut conventions: Vec<Convention> = groups.iter().map(|group| group.convention).collect();
    conventions.dedup();
    let all: Vec<String> = conventions
        .iter()
        .map(|convention| format!("`{convention}` ({})", describe_convention(*convention)))
        .collect();
    match all.as_slice() {
        [] => "Data convention: none, this report holds no results.".to_owned(),
        [one] => format!("Data convention: {one}."),
        several => format!(
            "Data conventions: {}. Numbers of different conventions are not comparable and stand in \
             separate tables.",
            several.join("; ")
        ),
    }
}

fn describe_convention(convention: Convention) -> &'static str {
    match convention {
        Convention::Star => "ETH/UCY as in SR-LSTM, STAR and DDL: ETH every 6 frames",
        Convention::SocialGan => "ETH/UCY as in Social-GAN: ETH every 10 frames",
        Convention::Simulated => {
            "simulated crowds, NOT real recordings: comparable with no published number"
        }
    }
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

fn section(group: &Group<'_>) -> String {
    let mut text = format!(
        "\n## Protocol `{}`, window rule `{}`, convention `{}`\n\n",
        group.protocol, group.window_rule, group.convention
    );
    let _ = writeln!(
        text,
        "- Protocol `{}`: {}.",
        group.protocol,
        group.protocol.description()
    );
    let rule = describe_rule(group.window_rule);
    let _ = writeln!(text, "- Window rule `{}`: {rule}.", group.window_rule);
    let subset = group.test_subset.unwrap_or("all test windows");
    let _ = writeln!(text, "- Scored: {subset}.");
    text.push_str(
        "- Cells: minADE/minFDE in metres over the hypotheses of each pedestrian, mean over \
         pedestrians; `mean`: plain mean of the folds, given when all are there; ±: standard \
         deviation over seeds.\n",
    );
    if let Some(warning) = group.protocol.warning() {
        let _ = writeln!(text, "\n> **Warning.** {warning}");
    }
    let _ = write!(text, "\n{}\n{}", headline(group), conditions(group));
    let _ = write!(text, "\n{FURTHER_LEGEND}\n\n{}", further(group, &FURTHER));
    let whole = further(group, &WHOLE_FORECAST);
    let _ = write!(text, "\n{WHOLE_FORECAST_LEGEND}\n\n{whole}");
    text
}

fn headline(group: &Group<'_>) -> MarkdownTable {
    let folds = group.folds();
    let columns = ["forecaster"]
        .into_iter()
        .chain(folds.iter().copied())
        .chain(["mean"]);
    let mut table = MarkdownTable::new(columns);
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

fn pair<T: std::fmt::Display>(ade: Option<T>, fde: Option<T>) -> String {
    match (ade, fde) {
        (Some(ade), Some(fde)) => format!("{ade}/{fde}"),
        _ => NOTHING.to_owned(),
    }
}

/// Under what conditions each line came about; lines alike are named together.
fn conditions(group: &Group<'_>) -> String {
    let mut alike: Vec<(String, Vec<String>)> = Vec::new();
    for (line, label) in group.lines.iter().zip(group.labels()) {
        let settings = settings(line);
        match alike.iter_mut().find(|(known, _)| *known == settings) {
            Some((_, labels)) => labels.push(label),
            None => alike.push((settings, vec![label])),
        }
    }
    alike
        .iter()
        .fold(String::new(), |text, (settings, labels)| {
            text + &format!("- {}: {settings}.\n", labels.join(", "))
        })
}

fn settings(line: &Line<'_>) -> String {
    let c: &Conditions = line.conditions();
    let seeds: Vec<String> = line.seeds().iter().flatten().map(u64::to_string).collect();
    let known = |text: &str| {
        if text.is_empty() {
            "unknown".to_owned()
        } else {
            text.to_owned()
        }
    };
    let mut parts = vec![match seeds.len() {
        0 => "no seed (nothing random)".to_owned(),
        1 => format!("seed {}", seeds[0]),
        _ => format!("seeds {}", seeds.join(", ")),
    }];
    match c.epochs {
        None => parts.push("not trained".to_owned()),
        Some(epochs) => {
            let selection = c
                .selection
                .as_deref()
                .map_or(String::new(), |s| format!(" ({s})"));
            parts.push(format!("{epochs} epochs{selection}"));
            let subset = c
                .training_subset
                .as_deref()
                .unwrap_or("all training windows");
            parts.push(format!("trained on {subset}"));
            parts.extend(c.recipe.clone());
        }
    }
    parts.push(format!("device {}", known(&c.device)));
    parts.push(format!("commit {}", known(&c.commit)));
    parts.join("; ")
}

/// A metric of the tables after the first: its column, its decimals, and where it is found in the scores.
pub(super) type Column = (&'static str, usize, fn(&Scores) -> Option<f64>);

const FURTHER_LEGEND: &str = "Further metrics, mean over the folds named. FDE@minADE: FDE of the \
    hypothesis of least ADE; JADE, JFDE: one hypothesis index for the whole scene; missed: every \
    hypothesis ends more than 0.5 m off; collide: discs of radius 0.2 m overlap between most likely \
    forecasts (in brackets: between true futures); goal FDE: nearest goal from the true end; Phi \
    falls: rollouts that come nearer to their goal at every step; certified: rollouts whose Lyapunov \
    certificate, the model's evidence of it step by step, holds; to goal: distance left at the end; \
    turn: largest angle between a step and the goal direction; reverse: rollouts that turn by more \
    than 90 degrees; K: hypotheses a pedestrian.";

const FURTHER: [Column; 13] = [
    ("FDE@minADE m", 3, |s| Some(s.fde_at_min_ade)),
    ("JADE m", 3, |s| Some(s.joint_ade)),
    ("JFDE m", 3, |s| Some(s.joint_fde)),
    ("missed %", 1, |s| Some(100.0 * s.miss_rate)),
    ("collide %", 1, |s| Some(100.0 * s.collision_rate)),
    ("(true %)", 1, |s| Some(100.0 * s.true_collision_rate)),
    ("goal FDE m", 3, |s| s.goal_fde),
    ("Phi falls %", 1, |s| {
        s.stability.map(|st| 100.0 * st.decreasing)
    }),
    ("certified %", 1, |s| {
        s.stability?.certified.map(|share| 100.0 * share)
    }),
    ("to goal m", 3, |s| s.stability.map(|st| st.end_distance)),
    ("turn deg", 1, |s| s.stability.map(|st| st.largest_turn)),
    ("reverse %", 1, |s| {
        s.stability.map(|st| 100.0 * st.reversing)
    }),
    ("K", 0, |s| Some(s.hypotheses as f64)),
];

fn further(group: &Group<'_>, metrics: &[Column]) -> MarkdownTable {
    let folds = group.folds();
    let columns = ["forecaster", "folds"]
        .into_iter()
        .chain(metrics.iter().map(|(name, ..)| *name));
    let mut table = MarkdownTable::new(columns).text_column("folds");
    for (line, label) in group.lines.iter().zip(group.labels()) {
        let present = line.present(&folds);
        let named = if present.len() == folds.len() {
            "all".to_owned()
        } else {
            present.join(", ")
        };
        let cells = metrics.iter().map(|&(_, decimals, of)| {
            // A metric that a fold lacks is NaN there, and so is its mean.
            let spread = line.over_folds(&present, |s| of(s).unwrap_or(f64::NAN));
            let text = spread.map(|spread| format!("{spread:.decimals$}"));
            text.filter(|text| !text.contains("NaN"))
                .unwrap_or_else(|| NOTHING.to_owned())
        });
        table.row([label, named].into_iter().chain(cells));
    }
    table
}

fn published(rows: &[ResultRow]) -> String {
    let ablated = |row: &ResultRow| {
        row.conditions
            .variant
            .as_deref()
            .is_some_and(|variant| ABLATED.contains(&variant))
    };
    let star = rows
        .iter()
        .any(|row| row.conditions.convention == Convention::Star);
    let other = if star || rows.is_empty() {
        ""
    } else {
        " No result above is in the `star` convention: none is comparable with STAR, DDL or the \
         reference values below."
    };
    let mut text = format!(
        "\n## Published numbers\n\nAs printed by their sources, ADE/FDE in metres, best of 20. None of \
         them was measured here.{other}\n\n### Table I of the DDL paper\n\nThis table mixes data conventions: \
         most rows above DDL were measured by their authors in the `social-gan` convention, whose ETH \
         is harder; STAR and DDL are in `star`. Compare DDL and STAR with `published` results in the \
         `star` convention alone.\n\n{}",
        literature::table_one()
    );
    if rows.iter().any(ablated) {
        let _ = write!(
            text,
            "\n### Table II of the DDL paper (ablation; convention `star`, protocol `published`)\n\n{}",
            literature::ablation_table()
        );
    }
    let _ = write!(
        text,
        "\n### Best published systems in the `star` convention (minADE20/minFDE20)\n\n{}",
        literature::star_convention_table()
    );
    let _ = write!(
        text,
        "\n## Reference values of baselines\n\nMeasured once on all test windows of the `star` \
         convention, window rule `published`; ADE/FDE in metres.\n\n{}",
        literature::measured_table()
    );
    text
}
