//! Scores of the baselines alone.

use crate::error::DdlError;
use crate::windows::test_set::TestSet;
use ddl_data::{Dataset, Window};
use ddl_eval::{Conditions, Protocol, ResultRow, baseline};

/// The folds on which baselines are measured, and how.
#[derive(Debug, Clone)]
pub struct BaselineRequest {
    /// The folds.
    pub folds: Vec<String>,
    /// The protocols.
    pub protocols: Vec<Protocol>,
    /// At least this many pedestrians of each fold, on the seeded part of the windows that
    /// [`evaluate`](crate::evaluate) takes; `None`: all.
    pub test_pedestrians: Option<usize>,
    /// Commit of the program, for the record.
    pub commit: String,
}

/// Measures the baselines on test windows, under every window rule in the tables of the convention.
///
/// # Errors
/// When a fold is missing, or its windows cannot be scored.
pub fn measure_baselines(dataset: &Dataset, request: &BaselineRequest) -> Result<Vec<ResultRow>, DdlError> {
    let mut rows = Vec::new();
    for name in &request.folds {
        let convention = dataset.convention();
        let test = TestSet::new(&dataset.fold(name)?, convention, request.test_pedestrians);
        for (rule, indices) in &test.rules {
            // A small part may hold no window of a rule.
            if indices.is_empty() {
                continue;
            }
            let windows: Vec<Window> = indices.iter().map(|&i| test.windows[i].clone()).collect();
            for &protocol in &request.protocols {
                let conditions = Conditions {
                    device: "cpu".to_owned(),
                    commit: request.commit.clone(),
                    test_subset: test.subset.clone(),
                    ..Conditions::new(convention, *rule, protocol, name, "")
                };
                rows.extend(baseline::measure(&conditions, &windows, baseline::NOISE_SEED)?);
            }
        }
    }
    Ok(rows)
}
