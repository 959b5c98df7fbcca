//! Published results and measured baselines as data, each row with its source and data convention.
//! Values are those printed by the source, in metres, ADE/FDE. Rows of different conventions are not comparable: on ETH
//! the same system errs about 60 % more in the `social-gan` files than in the `star` files.

use crate::document::Table;
use ddl_data::Convention;
use serde::Deserialize;
use std::sync::LazyLock;

/// The folds of every table here, in the order of its columns.
pub(crate) const FOLDS: [&str; 5] = ["eth", "hotel", "univ", "zara1", "zara2"];

/// The content of `literature.json`.
pub(crate) static LITERATURE: LazyLock<Literature> =
    LazyLock::new(|| serde_json::from_str(include_str!("literature.json")).expect("the file is part of this crate"));

/// Published numbers of others, and reference values of baselines measured by this project.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Literature {
    /// Table I of the DDL paper, as printed: ADE/FDE, best of 20. It mixes data conventions.
    pub(crate) table_one: Vec<PublishedRow>,
    /// The best published systems measured in the `star` convention: minADE20/minFDE20.
    pub(crate) star_convention: Vec<PublishedRow>,
    /// The best published systems measured in the `social-gan` convention: minADE20/minFDE20.
    pub(crate) social_gan_convention: Vec<PublishedRow>,
    /// One forecast in the `social-gan` convention, windows of at least one pedestrian: ADE/FDE.
    pub(crate) social_gan_single: Vec<PublishedRow>,
    /// Joint errors of 20 forecasts on the scene eth of the `social-gan` convention.
    pub(crate) social_gan_joint_eth: Vec<JointRow>,
    /// Table II of the DDL paper: `star` convention, protocol `published`.
    pub(crate) ablation: Vec<AblationRow>,
    /// Baselines on all test windows of the `star` convention, cut by the published rule. Rows on goals are of the
    /// published estimator (100 experts, 20 centres, gamma = 1).
    pub(crate) measured: Vec<BaselineReference>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PublishedRow {
    pub(crate) method: String,
    /// Who published the method, and where.
    pub(crate) source: String,
    /// Data convention of the measurement; `None` if it is another convention or could not be verified.
    pub(crate) convention: Option<Convention>,
    /// Caution for comparisons.
    pub(crate) remark: Option<String>,
    /// ADE and FDE (m) of each fold, in the order of [`FOLDS`].
    pub(crate) folds: [[f64; 2]; 5],
    /// The mean as printed; it may differ from the mean of the printed folds by rounding.
    pub(crate) mean: [f64; 2],
}

/// Published joint errors of one scene.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointRow {
    pub(crate) method: String,
    /// Who published it, and where.
    pub(crate) source: String,
    /// JADE and JFDE (m), means over windows.
    pub(crate) joint: [f64; 2],
    /// `CR_JADE` and `CR_mean`.
    pub(crate) collisions: [f64; 2],
}

/// One row of the ablation, Table II of the DDL paper.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AblationRow {
    /// Name of the variant in this project: `star`, `no-goal-shift`, `no-dynamics` or `full`.
    pub(crate) variant: String,
    /// Component A: positions relative to the goal.
    pub(crate) goal_shift: bool,
    /// Component B: the stable dynamical system.
    pub(crate) dynamics: bool,
    /// ADE and FDE (m) of each fold, in the order of [`FOLDS`].
    pub(crate) folds: [[f64; 2]; 5],
    /// The mean as printed.
    pub(crate) mean: [f64; 2],
}

/// A baseline measured with this project's definitions: `star` files, published test windows.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BaselineReference {
    /// Name of the baseline.
    pub(crate) method: String,
    /// Use of the true future, if any.
    pub(crate) remark: Option<String>,
    /// ADE of each fold, metres; `None` for rows that are errors of goals.
    pub(crate) ade: Option<[f64; 5]>,
    /// FDE of each fold, metres.
    pub(crate) fde: [f64; 5],
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

/// Joint errors on the scene eth of the `social-gan` convention.
pub(crate) fn social_gan_joint_table() -> Table {
    let mut table = Table::new(["method", "JADE m", "JFDE m", "CR_JADE", "CR_mean", "source"]).text_column("source");
    for row in &LITERATURE.social_gan_joint_eth {
        let numbers = row.joint.into_iter().chain(row.collisions).map(|number| format!("{number:.3}"));
        let start = [row.method.clone()].into_iter();
        table.row(start.chain(numbers).chain([row.source.clone()]));
    }
    table
}

/// Rows as printed, with this number of decimals.
pub(crate) fn published_table(rows: &[PublishedRow], decimals: usize) -> Table {
    let mut table = Table::of_folds(&["method"], &FOLDS, &["mean", "convention", "source"])
        .text_column("convention")
        .text_column("source");
    for row in rows {
        let convention = row.convention.map(|convention| convention.to_string());
        let convention = convention.unwrap_or_else(|| "other or unknown".to_owned());
        let source = match &row.remark {
            Some(remark) => format!("{}; {remark}", row.source),
            None => row.source.clone(),
        };
        let start = [row.method.clone()].into_iter();
        table.row(start.chain(cells(&row.folds, row.mean, decimals)).chain([convention, source]));
    }
    table
}

/// Table II of the DDL paper: the contribution of each component.
pub(crate) fn ablation_table() -> Table {
    let mut table = Table::of_folds(&["variant", "goal shift", "dynamics"], &FOLDS, &["mean"]);
    for row in &LITERATURE.ablation {
        table.row(row.start().into_iter().chain(cells(&row.folds, row.mean, 2)));
    }
    table
}

impl AblationRow {
    /// The first cells of the row: the variant and its components.
    pub(crate) fn start(&self) -> [String; 3] {
        let [goal_shift, dynamics] = [self.goal_shift, self.dynamics].map(|has| if has { "yes" } else { "no" });
        [&*self.variant, goal_shift, dynamics].map(str::to_owned)
    }
}

/// The measured baselines, with the plain mean of their folds.
pub(crate) fn measured_table() -> Table {
    let mut table = Table::of_folds(&["baseline"], &FOLDS, &["mean", "remark"]).text_column("remark");
    let with_mean = |errors: [f64; 5]| errors.into_iter().chain([errors.iter().sum::<f64>() / 5.0]);
    for row in &LITERATURE.measured {
        let ade: Vec<String> = match row.ade {
            Some(ade) => with_mean(ade).map(|error| format!("{error:.3}")).collect(),
            None => vec!["-".to_owned(); 6],
        };
        let cells = ade.iter().zip(with_mean(row.fde)).map(|(ade, fde)| format!("{ade}/{fde:.3}"));
        let end = [row.remark.clone().unwrap_or_default()];
        table.row([row.method.clone()].into_iter().chain(cells).chain(end));
    }
    table
}

fn cells(folds: &[[f64; 2]; 5], mean: [f64; 2], decimals: usize) -> impl Iterator<Item = String> {
    folds.iter().copied().chain([mean]).map(move |[ade, fde]| format!("{ade:.decimals$}/{fde:.decimals$}"))
}

#[cfg(test)]
mod measured_tests;

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
                let computed = folds.iter().map(|fold| fold[error]).sum::<f64>() / 5.0;
                assert!((computed - printed).abs() < 0.0101, "{name}: {computed}");
            }
            assert!(folds.iter().all(|[ade, fde]| ade < fde), "{name}");
        }
    }

    /// The numbers of rows and the sums of all cells, entered from the papers independently of the file.
    #[test]
    fn the_file_holds_the_rows_of_the_papers() {
        let file = &*LITERATURE;
        let published = |rows: &[PublishedRow]| (rows.len(), rows.iter().flat_map(|row| row.folds).flatten().sum());
        let ablation = file.ablation.iter().flat_map(|row| row.folds).flatten();
        let ade = file.measured.iter().filter_map(|row| row.ade).flatten();
        let fde = file.measured.iter().flat_map(|row| row.fde);
        for ((rows, sum), expected_rows, expected) in [
            (published(&file.table_one), 11, 51.82),
            (published(&file.star_convention), 5, 11.752),
            (published(&file.social_gan_convention), 8, 21.18),
            (published(&file.social_gan_single), 3, 25.831),
            ((file.ablation.len(), ablation.sum::<f64>()), 4, 13.8),
            ((file.measured.len(), ade.sum()), 11, 16.88),
            ((file.measured.len(), fde.sum()), 11, 38.393),
        ] {
            assert_eq!(rows, expected_rows);
            assert!((sum - expected).abs() < 1e-9, "{sum} {expected}");
        }
        let count = |convention| file.table_one.iter().filter(|row| row.convention == convention).count();
        let conventions = [Some(Convention::Star), Some(Convention::SocialGan), None];
        assert_eq!(conventions.map(count), [2, 3, 6]);
    }
}
