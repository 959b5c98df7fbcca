//! Forecasts of another program, without libtorch: the Python example on real recordings is the baseline it says.

use ddl_data::{Convention, Dataset, WindowRule};
use ddl_eval::external::{self, Coverage, ExternalFormat};
use ddl_eval::{Conditions, Protocol, baseline};
use ddl_tests::{other_program, recordings};

/// Constant velocity under the published rule, printed by an independent program; and the walkers.
const EXPECTED: [(&str, f64, f64, usize); 2] =
    [("zara1", 0.428, 0.953, 2324), ("hotel", 0.325, 0.615, 1026)];

#[test]
fn the_python_example_has_the_numbers_of_constant_velocity() {
    let Some(data) = recordings::star_folder() else {
        return;
    };
    let dataset = Dataset::load(Convention::Star, &data).unwrap();
    for (fold, ade, fde, walkers) in EXPECTED {
        let folder = tempfile::tempdir().unwrap();
        let windows = dataset.fold(fold).unwrap();
        let windows = windows.test_windows(WindowRule::Published);
        let file = std::fs::File::create(folder.path().join("windows.jsonl")).unwrap();
        external::write_windows(&windows, file).unwrap();
        if !other_program::forecasts_in(folder.path()) {
            return;
        }
        let path = folder.path().join("forecasts.jsonl");
        let format = ExternalFormat::of_file(&path);
        let matched = external::read(&path, format, &windows, Coverage::Whole).unwrap();
        assert_eq!(
            (matched.pedestrians(), matched.test_subset()),
            (walkers, None)
        );
        let conditions = Conditions::new(
            Convention::Star,
            WindowRule::Published,
            Protocol::Single,
            fold,
            "python",
        );
        let rows = external::measure(&conditions, &matched, baseline::NOISE_SEED).unwrap();
        let (mine, baseline) = (&rows[0], &rows[1]);
        assert_eq!(mine.conditions.forecaster, "python");
        assert_eq!(
            baseline.conditions.forecaster,
            "constant velocity (last step)"
        );
        assert_eq!(mine.scores.pedestrians, walkers);
        assert!((mine.scores.min_ade - ade).abs() <= 0.000_501, "{mine:?}");
        assert!((mine.scores.min_fde - fde).abs() <= 0.000_501, "{mine:?}");
        assert!((mine.scores.min_ade - baseline.scores.min_ade).abs() < 1e-9);
        assert!((mine.scores.min_fde - baseline.scores.min_fde).abs() < 1e-9);
        assert!((mine.scores.joint_fde - baseline.scores.joint_fde).abs() < 1e-9);
        assert!((mine.scores.miss_rate - baseline.scores.miss_rate).abs() < 1e-9);
    }
}
