//! Published results and measured baselines as data, each row with its source and data convention.
//! Values are those printed by the source, in metres, ADE/FDE. Rows of different conventions are not comparable: on ETH
//! the same system errs about 60 % more in the `social-gan` files than in the `star` files.

use std::sync::LazyLock;

use ddl_data::Convention;
use serde::Deserialize;

use crate::document::Table;

/// The folds of every table here, in the order of its columns.
pub const FOLDS: [&str; 5] = ["eth", "hotel", "univ", "zara1", "zara2"];

/// The content of `literature.json`.
pub static LITERATURE: LazyLock<Literature> =
    LazyLock::new(|| serde_json::from_str(include_str!("literature.json")).expect("the file is part of this crate"));

/// Published numbers of others, and reference values of baselines measured by this project.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Literature {
    /// Table I of the DDL paper, as printed: ADE/FDE, best of 20. It mixes data conventions.
    pub table_one: Vec<PublishedRow>,
    /// The best published systems measured in the `star` convention: minADE20/minFDE20.
    pub star_convention: Vec<PublishedRow>,
    /// The best published systems measured in the `social-gan` convention: minADE20/minFDE20.
    pub social_gan_convention: Vec<PublishedRow>,
    /// One forecast in the `social-gan` convention, windows of at least one pedestrian: ADE/FDE.
    pub social_gan_single: Vec<PublishedRow>,
    /// Joint errors of 20 forecasts on the scene eth of the `social-gan` convention.
    pub social_gan_joint_eth: Vec<JointRow>,
    /// Table II of the DDL paper: `star` convention, protocol `published`.
    pub ablation: Vec<AblationRow>,
    /// Baselines on all test windows of the `star` convention, cut by the published rule. Rows on goals are of the
    /// published estimator (100 experts, 20 centres, gamma = 1).
    pub measured: Vec<BaselineReference>,
}

/// One row of a published table.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedRow {
    /// Name of the method.
    pub method: String,
    /// Who published the method, and where.
    pub source: String,
    /// Data convention of the measurement; `None` if it is another convention or could not be verified.
    pub convention: Option<Convention>,
    /// Caution for comparisons.
    pub remark: Option<String>,
    /// ADE and FDE (m) of each fold, in the order of [`FOLDS`].
    pub folds: [[f64; 2]; 5],
    /// The mean as printed; it may differ from the mean of the printed folds by rounding.
    pub mean: [f64; 2],
}

/// Published joint errors of one scene.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointRow {
    /// Name of the method.
    pub method: String,
    /// Who published it, and where.
    pub source: String,
    /// JADE and JFDE (m).
    pub joint: [f64; 2],
}

/// One row of the ablation, Table II of the DDL paper.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AblationRow {
    /// Name of the variant in this project: `star`, `no-goal-shift`, `no-dynamics` or `full`.
    pub variant: String,
    /// Component A: positions relative to the goal.
    pub goal_shift: bool,
    /// Component B: the stable dynamical system.
    pub dynamics: bool,
    /// ADE and FDE (m) of each fold, in the order of [`FOLDS`].
    pub folds: [[f64; 2]; 5],
    /// The mean as printed.
    pub mean: [f64; 2],
}

/// A baseline measured with this project's definitions: `star` files, published test windows.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BaselineReference {
    /// Name of the baseline.
    pub method: String,
    /// Use of the true future, if any.
    pub remark: Option<String>,
    /// ADE of each fold, metres; `None` for rows that are errors of goals.
    pub ade: Option<[f64; 5]>,
    /// FDE of each fold, metres.
    pub fde: [f64; 5],
}

/// Table I of the DDL paper, with the source and the convention of each row.
pub fn table_one() -> Table {
    published_table(&LITERATURE.table_one, 2)
}

/// The published system of a convention with the least ADE + FDE, means of five folds, best of 20.
pub(crate) fn best(convention: Convention) -> Option<&'static PublishedRow> {
    let rows = match convention {
        Convention::Star => &LITERATURE.star_convention,
        Convention::SocialGan => &LITERATURE.social_gan_convention,
        Convention::Simulated | Convention::Own => return None,
    };
    let error = |row: &PublishedRow| row.mean.iter().sum::<f64>();
    rows.iter().min_by(|a, b| error(a).total_cmp(&error(b)))
}

/// The best published systems in the `star` convention.
pub fn star_convention_table() -> Table {
    published_table(&LITERATURE.star_convention, 2)
}

/// The best published systems in the `social-gan` convention.
pub fn social_gan_convention_table() -> Table {
    published_table(&LITERATURE.social_gan_convention, 2)
}

/// One forecast in the `social-gan` convention.
pub fn social_gan_single_table() -> Table {
    published_table(&LITERATURE.social_gan_single, 3)
}

/// Joint errors on the scene eth of the `social-gan` convention.
pub fn social_gan_joint_table() -> Table {
    let mut table = Table::new(["method", "JADE m", "JFDE m", "source"]).text_column("source");
    for row in &LITERATURE.social_gan_joint_eth {
        let [ade, fde] = row.joint.map(|error| format!("{error:.3}"));
        table.row([row.method.clone(), ade, fde, row.source.clone()]);
    }
    table
}

fn published_table(rows: &[PublishedRow], digits: usize) -> Table {
    let mut table = table_of_folds(&["method"], &["mean", "convention", "source"])
        .text_column("convention")
        .text_column("source");
    for row in rows {
        let convention = row.convention.map(|convention| convention.to_string());
        let convention = convention.unwrap_or_else(|| "other or unknown".to_owned());
        let source = [Some(&row.source), row.remark.as_ref()].into_iter().flatten();
        let source: Vec<&str> = source.map(String::as_str).collect();
        let start = [row.method.clone()].into_iter();
        let end = [convention, source.join("; ")];
        table.row(start.chain(cells(&row.folds, row.mean, digits)).chain(end));
    }
    table
}

/// Table II of the DDL paper: the contribution of each component.
pub fn ablation_table() -> Table {
    let mut table = table_of_folds(&["variant", "goal shift", "dynamics"], &["mean"])
        .text_column("goal shift")
        .text_column("dynamics");
    for row in &LITERATURE.ablation {
        let start = [row.variant.clone()].into_iter().chain(row.components());
        table.row(start.chain(cells(&row.folds, row.mean, 2)));
    }
    table
}

impl AblationRow {
    pub(crate) fn components(&self) -> [String; 2] {
        [self.goal_shift, self.dynamics].map(|has| if has { "yes" } else { "no" }.to_owned())
    }
}

/// The measured baselines, with the plain mean of their folds.
pub fn measured_table() -> Table {
    let mut table = table_of_folds(&["baseline"], &["mean", "remark"]).text_column("remark");
    let mean = |values: [f64; 5]| values.iter().sum::<f64>() / 5.0;
    for row in &LITERATURE.measured {
        let cell = |ade: Option<f64>, fde: f64| match ade {
            Some(ade) => format!("{ade:.3}/{fde:.3}"),
            None => format!("-/{fde:.3}"),
        };
        let folds = (0..5).map(|f| cell(row.ade.map(|ade| ade[f]), row.fde[f]));
        let mean = cell(row.ade.map(mean), mean(row.fde));
        let end = [mean, row.remark.clone().unwrap_or_default()];
        table.row([row.method.clone()].into_iter().chain(folds).chain(end));
    }
    table
}

fn table_of_folds(start: &[&str], end: &[&str]) -> Table {
    Table::new([start, &FOLDS, end].concat())
}

fn cells(folds: &[[f64; 2]; 5], mean: [f64; 2], digits: usize) -> impl Iterator<Item = String> {
    let all = folds.iter().copied().chain([mean]);
    all.map(move |[ade, fde]| format!("{ade:.digits$}/{fde:.digits$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_means_are_the_means_of_the_printed_folds() {
        let published = LITERATURE
            .table_one
            .iter()
            .chain(&LITERATURE.star_convention)
            .chain(&LITERATURE.social_gan_convention)
            .chain(&LITERATURE.social_gan_single);
        let rows = published.map(|row| (&row.method, row.folds, row.mean));
        let ablation = LITERATURE.ablation.iter();
        for (name, folds, mean) in rows.chain(ablation.map(|row| (&row.variant, row.folds, row.mean))) {
            for (error, printed) in mean.into_iter().enumerate() {
                let found = folds.iter().map(|fold| fold[error]).sum::<f64>() / 5.0;
                assert!((found - printed).abs() < 0.0101, "{name}: {found}");
            }
            assert!(folds.iter().all(|[ade, fde]| ade < fde), "{name}");
        }
    }

    /// The numbers of rows and the sums of all cells, entered from the papers independently of the file.
    #[test]
    fn the_file_holds_the_rows_of_the_papers() {
        let all = &*LITERATURE;
        let published = |rows: &[PublishedRow]| -> f64 { rows.iter().flat_map(|row| row.folds).flatten().sum() };
        let ablation = all.ablation.iter().flat_map(|row| row.folds).flatten();
        let ade = all.measured.iter().filter_map(|row| row.ade).flatten();
        let fde = all.measured.iter().flat_map(|row| row.fde);
        for (rows, expected_rows, sum, expected) in [
            (all.table_one.len(), 11, published(&all.table_one), 51.82),
            (all.star_convention.len(), 5, published(&all.star_convention), 11.752),
            (
                all.social_gan_convention.len(),
                8,
                published(&all.social_gan_convention),
                21.18,
            ),
            (
                all.social_gan_single.len(),
                3,
                published(&all.social_gan_single),
                25.831,
            ),
            (all.ablation.len(), 4, ablation.sum(), 13.8),
            (all.measured.len(), 12, ade.sum(), 25.374),
            (all.measured.len(), 12, fde.sum(), 59.57),
        ] {
            assert_eq!(rows, expected_rows);
            assert!((sum - expected).abs() < 1e-9, "{sum} {expected}");
        }
        let of = |convention| {
            let rows = all.table_one.iter();
            rows.filter(|row| row.convention == convention).count()
        };
        let conventions = [Some(Convention::Star), Some(Convention::SocialGan), None];
        assert_eq!(conventions.map(of), [2, 3, 6]);
    }
}
