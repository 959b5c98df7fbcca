//! Metrics besides minADE and minFDE.

use crate::document::{Part, Table};
use crate::report::cells::{self, NOTHING};
use crate::report::group::{ResultGroup, TableLine};
use ddl_eval::{JointScores, Protocol, Scores};

/// A metric of the further tables: name of its column, decimals, value.
type MetricColumn = (&'static str, usize, fn(&Scores) -> Option<f64>);

const FURTHER: [MetricColumn; 11] = [
    ("FDE@minADE m", 3, |s| Some(s.fde_at_min_ade)),
    ("missed %", 1, |s| Some(100.0 * s.miss_rate)),
    ("collide %", 1, |s| Some(100.0 * s.collision_rate)),
    ("(true %)", 1, |s| Some(100.0 * s.true_collision_rate)),
    ("goal FDE m", 3, |s| s.goal_fde),
    ("Phi falls %", 1, |s| s.stability.map(|st| 100.0 * st.decreasing)),
    ("certified %", 1, |s| s.stability?.certified.map(|share| 100.0 * share)),
    ("to goal m", 3, |s| s.stability.map(|st| st.end_distance)),
    ("turn deg", 1, |s| s.stability.map(|st| st.largest_turn)),
    ("reverse %", 1, |s| s.stability.map(|st| 100.0 * st.reversing)),
    ("K", 0, |s| Some(s.hypotheses as f64)),
];

pub(super) const JOINT_LEGEND: &str = "Futures of scenes, mean over the folds named. minADE, minFDE: each pedestrian's \
    own best future; by window: JADE and JFDE as means over windows, not pedestrians; %: pedestrians whose centres \
    come closer than 0.4 m to those of another in the same future, mean of all futures, in that of JADE, and in the \
    true one. CR_mean, CR_JADE and CR of the truth as in Joint Metrics Matter: closer than \
    0.2 m, share of the pedestrians of a window, mean over windows. People who walk together touch: the true share is \
    the aim, not 0.";

const JOINT: [MetricColumn; 10] = [
    ("minADE m", 3, |s| Some(s.min_ade)),
    ("minFDE m", 3, |s| Some(s.min_fde)),
    ("JADE by window m", 3, |s| s.joint.map(|joint| joint.ade_windows)),
    ("JFDE by window m", 3, |s| s.joint.map(|joint| joint.fde_windows)),
    ("of all futures %", 1, |s| percent(s, |joint| joint.collisions.mean)),
    ("of the best %", 1, |s| percent(s, |joint| joint.collisions.best)),
    ("of the true one %", 1, |s| percent(s, |joint| joint.collisions.truth)),
    ("CR_mean", 3, |s| s.joint.map(|joint| joint.close_collisions.mean)),
    ("CR_JADE", 3, |s| s.joint.map(|joint| joint.close_collisions.best)),
    ("CR of the truth", 3, |s| s.joint.map(|joint| joint.close_collisions.truth)),
];

fn percent(scores: &Scores, share: fn(JointScores) -> f64) -> Option<f64> {
    scores.joint.map(|joint| 100.0 * share(joint))
}

/// Metrics of the forecast as a whole: of all hypotheses with their weights, not of the best one.
const WHOLE: [MetricColumn; 13] = [
    ("ADE@minFDE m", 3, |s| s.ade_at_min_fde),
    ("expected ADE m", 3, |s| s.expected_ade),
    ("expected FDE m", 3, |s| s.expected_fde),
    ("likely ADE m", 3, |s| s.most_likely_ade),
    ("likely FDE m", 3, |s| s.most_likely_fde),
    ("missed 1 m %", 1, |s| s.miss_rate_1m.map(|rate| 100.0 * rate)),
    ("missed 2 m %", 1, |s| s.miss_rate_2m.map(|rate| 100.0 * rate)),
    ("runs into %", 1, |s| s.true_neighbour_collision_rate.map(|rate| 100.0 * rate)),
    ("KDE NLL nats", 3, |s| s.kde_nll),
    ("AMD", 3, |s| s.amd),
    ("AMV m²", 3, |s| s.amv),
    ("APD m", 3, |s| s.diversity),
    ("FPD m", 3, |s| s.end_diversity),
];

pub(super) fn parts(group: &ResultGroup<'_>) -> Vec<Part> {
    let joint = (group.protocol == Protocol::Joint).then_some(("Futures of scenes", &JOINT[..]));
    let tables = [("Further metrics", &FURTHER[..]), ("The forecast as a whole", &WHOLE)];
    let part = |(name, columns): (&str, &[MetricColumn])| {
        let caption = format!("{name}. {}", group.conditions_in_words());
        let table = table(group, columns).captioned(caption);
        [Part::subheading(name), Part::Table(table)]
    };
    joint.into_iter().chain(tables).flat_map(part).collect()
}

/// One line for each forecaster, one column for each metric, mean over its folds.
fn table(group: &ResultGroup<'_>, metrics: &[MetricColumn]) -> Table {
    let folds = group.folds();
    let columns = ["forecaster", "folds"].into_iter().chain(metrics.iter().map(|(name, ..)| *name));
    let mut table = Table::new(columns).text_column("folds");
    for (line, label) in group.labelled() {
        let present = line.present(&folds);
        let named = cells::folds(&present, &folds);
        let cells = metrics.iter().map(|&(_, decimals, metric)| {
            let spread = line.over_folds(&present, metric);
            spread.map_or(NOTHING.to_owned(), |spread| format!("{spread:.decimals$}"))
        });
        table.row([label, named].into_iter().chain(cells));
    }
    table
}

/// The mean of the metric with this column name over the folds, without its deviation over the seeds.
pub(super) fn mean(line: &TableLine<'_>, folds: &[&str], name: &str) -> String {
    let mut columns = FURTHER.iter().chain(&WHOLE).chain(&JOINT);
    let column = columns.find(|(column, ..)| *column == name);
    let mean = column.and_then(|&(_, decimals, metric)| {
        let mean = line.over_folds(folds, metric)?.mean;
        Some(format!("{mean:.decimals$}"))
    });
    mean.unwrap_or_else(|| NOTHING.to_owned())
}
