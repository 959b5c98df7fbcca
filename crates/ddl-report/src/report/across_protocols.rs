//! The same forecaster under every protocol: the effect of choosing with the truth.
//! This is the only table with several protocols. It states that their numbers are not comparable.

use crate::document::{Part, Table};
use crate::report::cells::{NOTHING, errors};
use crate::report::group::{ResultGroup, TableLine};
use ddl_eval::Protocol;

const NOTE: &str = "Every line has the same windows and folds. Under `published` the goal of each pedestrian is \
    chosen with the true end, among the goals of the published estimator, whose query reads one future frame. Then \
    the best of 20 noise samples on it is kept, of the epoch that is best on test pedestrians; steps are plain Euler \
    steps. Its lines of the last epoch then do without that frame, and then without noise too; their goals are still \
    those nearest the true ends. Under `fair`, the line with the published goals, all 20 kept, has the same estimator \
    without the future frame, and only the best of its 20 hypotheses is chosen. The other lines under `fair` have the \
    forecaster's own goals, and under `single` one representative goal. The conditions below the tables above name \
    the training of each line.";

/// The lines of forecasters with goals, by protocol, together with `published` on the same windows.
pub(super) fn parts(groups: &[ResultGroup<'_>]) -> Vec<Part> {
    let mut parts = Vec::new();
    for oracle in groups.iter().filter(|g| g.protocol == Protocol::Published) {
        let mut comparable: Vec<&ResultGroup<'_>> = groups
            .iter()
            .filter(|g| g.same_windows(oracle) && !g.protocol.gives_recording_memory() && g.protocol != Protocol::Joint)
            .collect();
        // `published` first.
        comparable.sort_by_key(|g| g.protocol != Protocol::Published);
        if comparable.len() < 2 {
            continue;
        }
        parts.extend([
            Part::heading(format!(
                "One forecaster under several protocols, window rule `{}`, convention `{}`",
                oracle.window_rule, oracle.convention
            )),
            Part::Paragraph(NOTE.to_owned()),
        ]);
        parts.extend(oracle.warning());
        parts.push(Part::Table(table(&comparable).captioned(format!(
            "minADE/minFDE in metres by protocol. NOT comparable with one another: see the warning. Data convention \
             `{}`, window rule `{}`; scored: {}.",
            oracle.convention,
            oracle.window_rule,
            oracle.test_subset.unwrap_or("all test windows")
        ))));
    }
    parts
}

fn table(groups: &[&ResultGroup<'_>]) -> Table {
    let folds = groups[0].folds();
    let mut table = Table::of_folds(&["forecaster", "protocol", "candidates"], &folds, &["mean"]);
    for group in groups {
        for (line, label) in group.labelled() {
            if !heads_for_goals(line) {
                continue;
            }
            let candidates = match group.protocol {
                Protocol::Published => {
                    let goals = line.rows[0].scores.goal_fde.map(|_| "20 goals".to_owned());
                    let samples = match line.rows[0].scores.hypotheses {
                        1 => None,
                        count => Some(format!("{count} samples")),
                    };
                    let chosen_from: Vec<String> = goals.into_iter().chain(samples).collect();
                    chosen_from.join(" x ")
                }
                _ => line.rows[0].scores.hypotheses.to_string(),
            };
            let start = [label, group.protocol.to_string(), candidates];
            table.row(start.into_iter().chain(errors(line, &folds)));
        }
    }
    if table.rows.is_empty() {
        table.row([NOTHING]);
    }
    table
}

fn heads_for_goals(line: &TableLine<'_>) -> bool {
    line.conditions().epochs.is_some()
        || line.rows[0].scores.goal_fde.is_some() && !line.conditions().forecaster.contains("the TRUE end")
        || line.conditions().forecaster.contains("nearest the TRUE end")
}
