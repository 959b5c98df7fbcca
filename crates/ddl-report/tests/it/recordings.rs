//! The recordings of the `star` convention.

use ddl_data::{Convention, Dataset, Window, WindowRule, locate};

pub(crate) struct Recordings(Dataset);

impl Recordings {
    /// Without them tests are skipped, but not in CI.
    pub(crate) fn found() -> Option<Self> {
        let star = Convention::Star;
        match locate(star, None).and_then(|folder| Dataset::load(star, &folder)) {
            Ok(dataset) => Some(Self(dataset)),
            Err(why) => {
                let in_ci = std::env::var_os("CI").is_some();
                assert!(!in_ci, "in CI the recordings must be there: {why}");
                eprintln!("skipped, the recordings are not here: {why}");
                None
            }
        }
    }

    /// The test windows of a fold.
    pub(crate) fn windows(&self, fold: &str) -> Vec<Window> {
        let fold = self.0.fold(fold).unwrap();
        fold.test_windows(WindowRule::Published)
    }
}
