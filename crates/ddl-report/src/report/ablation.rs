//! The ablation: the contributions of the goal and of the dynamics, and the paper's Table II.

use crate::document::{Part, Table};
use crate::literature::{AblationRow, LITERATURE, ablation_table};
use crate::report::cells::{errors, or_nothing};
use crate::report::group::{ResultGroup, TableLine};
use ddl_eval::{Conditions, Protocol};

/// One table for each group that has a variant without one of the two components, then the paper's table.
pub(super) fn parts(groups: &[ResultGroup<'_>]) -> Vec<Part> {
    let ablated = |group: &&ResultGroup<'_>| group.protocol != Protocol::Joint && has_ablated_variant(group);
    let ablated: Vec<&ResultGroup<'_>> = groups.iter().filter(ablated).collect();
    if ablated.is_empty() {
        return Vec::new();
    }
    let mut parts = vec![
        Part::heading("Ablation: goal shift and dynamics"),
        Part::Paragraph(
            "Goal shift: positions enter the network relative to the goal; the network has no other input of the goal. \
             Dynamics: the network shapes a flow to the goal instead of emitting positions. Without both it is plain \
             STAR, which has no goals and draws 20 noise samples."
                .to_owned(),
        ),
    ];
    for group in ablated {
        parts.push(Part::subheading(group.title()));
        parts.extend(group.warning());
        parts.push(Part::Paragraph(if alike(group) {
            "The variants have the same folds, seeds, epochs, recipe and commit.".to_owned()
        } else {
            "The variants were NOT made alike: folds, seeds, epochs, recipe or commit differ (see the conditions below \
             the table of this protocol), so the components alone do not explain the differences."
                .to_owned()
        }));
        parts.push(Part::Table(measured(group).captioned(format!(
            "Ablation, minADE/minFDE in metres; FDE@minADE of the mean is what the paper prints as FDE. {}",
            group.conditions_in_words()
        ))));
    }
    parts.extend([
        Part::subheading("Table II of the DDL paper (ablation; convention `star`, protocol `published`)"),
        Part::Paragraph(
            "As printed. Compare with results under `published` in the `star` convention alone.".to_owned(),
        ),
        Part::Table(ablation_table()),
    ]);
    parts
}

fn has_ablated_variant(group: &ResultGroup<'_>) -> bool {
    group.lines.iter().any(|line: &TableLine<'_>| variant(line).is_some_and(|row| row.variant != "full"))
}

fn alike(group: &ResultGroup<'_>) -> bool {
    let made = |line: &TableLine<'_>| {
        let rows = line.rows.iter().map(|row| &row.conditions);
        let mut rows: Vec<_> = rows.map(|row| (row.fold.clone(), row.seed)).collect();
        rows.sort_unstable();
        let conditions = Conditions { variant: None, fold: String::new(), seed: None, ..line.conditions().clone() };
        (rows, conditions)
    };
    let mut lines = group.lines.iter().filter(|line| variant(line).is_some());
    let first = lines.next().map(made);
    lines.all(|line| Some(made(line)) == first)
}

/// The row of Table II that a line corresponds to: an unchanged variant under the integrator of the protocol.
fn variant(line: &TableLine<'_>) -> Option<&'static AblationRow> {
    let conditions = line.conditions();
    let name = conditions.variant.as_deref()?;
    // Lines such as "DDL with plain Euler steps" are not variants.
    let mut rows = LITERATURE.ablation.iter();
    rows.find(|row| conditions.forecaster == "DDL" && row.variant == name)
}

fn measured(group: &ResultGroup<'_>) -> Table {
    let folds = group.folds();
    let start = ["variant", "goal shift", "dynamics", "seeds"];
    let mut table = Table::of_folds(&start, &folds, &["mean", "mean FDE@minADE"]);
    for row in &LITERATURE.ablation {
        let is_of_row = |line: &&TableLine<'_>| variant(line).is_some_and(|other| other.variant == row.variant);
        for line in group.lines.iter().filter(is_of_row) {
            let seeds: Vec<String> = line.seeds().iter().flatten().map(u64::to_string).collect();
            let start = row.start().into_iter().chain([seeds.join(", ")]);
            let fde = or_nothing(line.over_folds(&folds, |s| Some(s.fde_at_min_ade)));
            table.row(start.chain(errors(line, &folds)).chain([fde]));
        }
    }
    table
}
