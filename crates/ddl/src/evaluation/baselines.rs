use crate::error::DdlError;
use crate::evaluation::test_set::TestSet;
use ddl_data::{Dataset, Window};
use ddl_eval::{Conditions, Protocol, ResultRow, baseline};

/// Measures the baselines on the test windows of these folds, under every window rule in the tables of the convention.
///
/// With `test_pedestrians`, on the seeded part of the windows that [`evaluate`](crate::evaluate) takes: at least this
/// many pedestrians for each fold.
///
/// # Errors
/// When a fold is missing, or its windows cannot be scored.
pub fn measure_baselines(
    dataset: &Dataset,
    folds: &[String],
    protocols: &[Protocol],
    test_pedestrians: Option<usize>,
    commit: &str,
) -> Result<Vec<ResultRow>, DdlError> {
    let mut rows = Vec::new();
    for name in folds {
        let convention = dataset.convention();
        let test = TestSet::new(&dataset.fold(name)?, convention, test_pedestrians);
        for (rule, indices) in &test.rules {
            // A small part may hold no window of a rule.
            if indices.is_empty() {
                continue;
            }
            let windows: Vec<Window> = indices.iter().map(|&i| test.windows[i].clone()).collect();
            for &protocol in protocols {
                let conditions = Conditions {
                    device: "cpu".to_owned(),
                    commit: commit.to_owned(),
                    test_subset: test.subset.clone(),
                    ..Conditions::new(convention, *rule, protocol, name, "")
                };
                rows.extend(baseline::measure(&conditions, &windows, baseline::NOISE_SEED)?);
            }
        }
    }
    Ok(rows)
}
