//! Categories on the real recordings, against numbers computed independently.

use ddl_data::{Convention, Dataset, WindowRule, locate};
use ddl_eval::baseline::ConstantVelocity;
use ddl_eval::{Category, Conditions, Protocol, ResultRow};

/// The recordings of the `star` convention; without them the test is skipped, except in CI.
fn recordings() -> Option<Dataset> {
    let dataset = locate(Convention::Star, None).and_then(|folder| Dataset::load(Convention::Star, &folder));
    match dataset {
        Ok(dataset) => Some(dataset),
        Err(why) => {
            assert!(std::env::var_os("CI").is_none(), "CI needs the recordings: {why}");
            eprintln!("skipped, no recordings: {why}");
            None
        }
    }
}

/// Number of pedestrians of each type, I to IV, and of each sub-kind of III. They were counted with numpy from the
/// definitions in the documentation, with angles by arctan2 and the filter in matrix form.
#[test]
fn pedestrians_are_of_the_types_counted_independently() {
    let Some(dataset) = recordings() else { return };
    let counted = [
        [219, 484, 781, 1027, 230, 60, 356, 235],
        [660, 165, 112, 89, 7, 11, 71, 26],
        [4524, 1890, 15_189, 2651, 2584, 4569, 7127, 4442],
        [132, 431, 861, 900, 144, 138, 537, 135],
        [2767, 432, 1751, 950, 297, 301, 1048, 422],
    ];
    for (fold, expected) in Convention::Star.fold_names().zip(counted) {
        let windows = dataset.fold(fold).unwrap().test_windows(WindowRule::Published);
        let row = ResultRow::measure(
            Conditions::new(Convention::Star, WindowRule::Published, Protocol::Single, fold, "any"),
            &ConstantVelocity::LastStep,
            &windows,
        );
        let categories = row.unwrap().scores.categories;
        let types_and_interactions = Category::all().filter(|category| !matches!(category, Category::Motion(_)));
        let count = |category| {
            let scores_of_category = categories.iter().find(|c| c.category == category);
            scores_of_category.map_or(0, |c| c.pedestrians)
        };
        let actual: Vec<usize> = types_and_interactions.map(count).collect();
        assert_eq!(actual, expected, "{fold}");
    }
}
