//! Published results and measured baselines as data, each row with its source and data convention.
//!
//! Values are those printed by the source, in metres, ADE/FDE. Rows of different conventions are not
//! comparable: on ETH the same system errs about 60 % more in the `social-gan` files than in the
//! `star` files, because their frames are farther apart.

use ddl_data::Convention;

mod ablation;
mod measured;
mod star_convention;
mod table_one;
mod tables;

pub use ablation::ABLATION;
pub use measured::MEASURED;
pub use star_convention::STAR_CONVENTION;
pub use table_one::TABLE_ONE;
pub use tables::{ablation_table, measured_table, star_convention_table, table_one};

/// The folds of every table here, in the order of its columns.
pub const FOLDS: [&str; 5] = ["eth", "hotel", "univ", "zara1", "zara2"];

/// An average and a final displacement error as printed, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdeFde {
    /// Average displacement error, metres.
    pub ade: f64,
    /// Final displacement error, metres.
    pub fde: f64,
}

/// One row of a published table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LiteratureRow {
    /// Name of the method.
    pub method: &'static str,
    /// Who published the method, and where.
    pub source: &'static str,
    /// Data convention of the measurement; `None` where it is neither or could not be verified.
    pub convention: Option<Convention>,
    /// What a reader must know before comparing.
    pub remark: &'static str,
    /// One pair a fold, in the order of [`FOLDS`].
    pub folds: [AdeFde; 5],
    /// The mean as printed; it may differ from the mean of the printed folds by rounding.
    pub mean: AdeFde,
}

/// One row of the ablation, Table II of the DDL paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AblationRow {
    /// Name of the variant in this project: `star`, `no-goal-shift`, `no-dynamics` or `full`.
    pub variant: &'static str,
    /// Component A: positions relative to the goal.
    pub goal_shift: bool,
    /// Component B: the stable dynamical system.
    pub dynamics: bool,
    /// One pair a fold, in the order of [`FOLDS`].
    pub folds: [AdeFde; 5],
    /// The mean as printed.
    pub mean: AdeFde,
}

/// A baseline measured with this project's definitions: `star` files, published test windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredRow {
    /// What was measured.
    pub method: &'static str,
    /// What it reads or chooses that a forecaster cannot; empty when nothing.
    pub remark: &'static str,
    /// ADE of each fold, metres; `None` for rows that are errors of goals.
    pub ade: Option<[f64; 5]>,
    /// FDE of each fold, metres.
    pub fde: [f64; 5],
}

const fn folds(values: [(f64, f64); 5]) -> [AdeFde; 5] {
    let mut folds = [AdeFde { ade: 0.0, fde: 0.0 }; 5];
    let mut at = 0;
    while at < 5 {
        folds[at] = pair(values[at]);
        at += 1;
    }
    folds
}

const fn pair((ade, fde): (f64, f64)) -> AdeFde {
    AdeFde { ade, fde }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A typing error in a cell moves the mean of its row: printed means agree to their rounding.
    #[test]
    fn printed_means_are_the_means_of_the_printed_folds() {
        let rows = TABLE_ONE
            .iter()
            .chain(&STAR_CONVENTION)
            .map(|r| (r.method, r.folds, r.mean));
        let ablation = ABLATION.iter().map(|r| (r.variant, r.folds, r.mean));
        for (name, folds, mean) in rows.chain(ablation) {
            let ade = folds.iter().map(|f| f.ade).sum::<f64>() / 5.0;
            let fde = folds.iter().map(|f| f.fde).sum::<f64>() / 5.0;
            assert!(
                (ade - mean.ade).abs() < 0.0101,
                "{name}: ADE {ade} against {}",
                mean.ade
            );
            assert!(
                (fde - mean.fde).abs() < 0.0101,
                "{name}: FDE {fde} against {}",
                mean.fde
            );
            assert!(
                folds.iter().all(|f| f.ade < f.fde),
                "{name}: ADE and FDE swapped?"
            );
        }
    }

    #[test]
    fn the_ablation_begins_with_star_and_ends_with_ddl() {
        assert_eq!(ABLATION[0].folds, TABLE_ONE[3].folds);
        assert_eq!(ABLATION[3].mean, TABLE_ONE[10].mean);
    }
}
