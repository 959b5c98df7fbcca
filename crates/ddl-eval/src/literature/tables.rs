//! The published numbers as tables.

use ddl_data::Convention;

use super::{ABLATION, AdeFde, FOLDS, LiteratureRow, MEASURED, STAR_CONVENTION, TABLE_ONE};
use crate::document::Table;

/// Table I of the DDL paper, with the source and the convention of each row.
#[must_use]
pub fn table_one() -> Table {
    literature_table(&TABLE_ONE)
}

/// The best published systems in the `star` convention.
#[must_use]
pub fn star_convention_table() -> Table {
    literature_table(&STAR_CONVENTION)
}

/// Table II of the DDL paper: what each component adds.
#[must_use]
pub fn ablation_table() -> Table {
    let start = ["variant", "goal shift", "dynamics"];
    let mut table = Table::new(start.into_iter().chain(FOLDS).chain(["mean"]))
        .text_column("goal shift")
        .text_column("dynamics");
    for row in &ABLATION {
        let has = |component| if component { "yes" } else { "no" }.to_owned();
        let start = [
            row.variant.to_owned(),
            has(row.goal_shift),
            has(row.dynamics),
        ];
        table.row(start.into_iter().chain(cells(&row.folds, row.mean)));
    }
    table
}

/// The measured baselines, with the plain mean of their folds.
#[must_use]
pub fn measured_table() -> Table {
    let header = ["baseline"]
        .into_iter()
        .chain(FOLDS)
        .chain(["mean", "remark"]);
    let mut table = Table::new(header).text_column("remark");
    let mean = |values: [f64; 5]| values.iter().sum::<f64>() / 5.0;
    for row in &MEASURED {
        let cell = |ade: Option<f64>, fde: f64| match ade {
            Some(ade) => format!("{ade:.3}/{fde:.3}"),
            None => format!("-/{fde:.3}"),
        };
        let folds = (0..5).map(|f| cell(row.ade.map(|ade| ade[f]), row.fde[f]));
        let mean = cell(row.ade.map(mean), mean(row.fde));
        let end = [mean, row.remark.to_owned()];
        table.row([row.method.to_owned()].into_iter().chain(folds).chain(end));
    }
    table
}

fn literature_table(rows: &[LiteratureRow]) -> Table {
    let header = ["method"]
        .into_iter()
        .chain(FOLDS)
        .chain(["mean", "convention", "source"]);
    let mut table = Table::new(header)
        .text_column("convention")
        .text_column("source");
    for row in rows {
        let convention = row.convention.map_or("other or unknown".to_owned(), name);
        let source = match row.remark {
            "" => row.source.to_owned(),
            remark => format!("{}; {remark}", row.source),
        };
        let start = [row.method.to_owned()].into_iter();
        table.row(
            start
                .chain(cells(&row.folds, row.mean))
                .chain([convention, source]),
        );
    }
    table
}

fn name(convention: Convention) -> String {
    convention.to_string()
}

fn cells(folds: &[AdeFde; 5], mean: AdeFde) -> impl Iterator<Item = String> {
    folds
        .iter()
        .copied()
        .chain([mean])
        .map(|f| format!("{:.2}/{:.2}", f.ade, f.fde))
}
