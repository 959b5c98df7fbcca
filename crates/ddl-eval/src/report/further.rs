//! Everything that is measured besides minADE and minFDE.

use super::{group::Group, section::NOTHING};
use crate::{Scores, document::Table};

/// A metric of the tables after the first: its column, its decimals, and where it is found in the scores.
pub(super) type Column = (&'static str, usize, fn(&Scores) -> Option<f64>);

pub(super) const LEGEND: &str = "Further metrics, mean over the folds named. FDE@minADE: FDE of the \
    hypothesis of least ADE; JADE, JFDE: one hypothesis index for the whole scene; missed: every \
    hypothesis ends more than 0.5 m off; collide: discs of radius 0.2 m overlap between the \
    forecasts that protocol `single` would take (in brackets: between true futures); goal FDE: nearest goal from the true end; Phi \
    falls: rollouts that come nearer to their goal at every step; certified: rollouts whose Lyapunov \
    certificate, the model's evidence of it step by step, holds; to goal: distance left at the end; \
    turn: largest angle between a step and the goal direction; reverse: rollouts that turn by more \
    than 90 degrees; K: hypotheses a pedestrian.";

pub(super) const COLUMNS: [Column; 13] = [
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

/// One line a forecaster, one column a metric, mean over the folds that it has.
pub(super) fn table(group: &Group<'_>, metrics: &[Column]) -> Table {
    let folds = group.folds();
    let columns = ["forecaster", "folds"]
        .into_iter()
        .chain(metrics.iter().map(|(name, ..)| *name));
    let mut table = Table::new(columns).text_column("folds");
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
