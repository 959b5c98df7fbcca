//! The simulated crowds for the tests: test windows of one scene, experts from the others.

use ddl_core::{TIME_STEP, Window};
use ddl_data::{Dataset, WindowRule};
use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams};
use std::sync::OnceLock;

/// The scene left out of training.
pub const FOLD: &str = "corridor";
/// Tracks of the expert library: enough for 100 different experts, few enough for a fast search.
const EXPERTS: usize = 600;

/// The five simulated scenes.
pub fn dataset() -> &'static Dataset {
    static DATASET: OnceLock<Dataset> = OnceLock::new();
    DATASET.get_or_init(|| Dataset::simulated(Dataset::CROWD_SEED))
}

/// Test windows with their futures, of 2 to `most` pedestrians, spread over the whole recording.
pub fn windows(count: usize, most: usize) -> Vec<Window> {
    let mut fitting = dataset().fold(FOLD).expect("the simulated scene exists").test_windows(WindowRule::Complete);
    fitting.retain(|window| (2..=most).contains(&window.len()));
    let available = fitting.len();
    assert!(available >= count, "{count} windows requested, {available} available");
    fitting.into_iter().step_by(available / count).take(count).collect()
}

/// The windows of the training scenes.
pub fn training_windows() -> Vec<Window> {
    dataset().fold(FOLD).expect("the simulated scene exists").training_windows(WindowRule::Complete)
}

/// A goal estimator whose experts walk in the training scenes.
pub fn goal_estimator(params: GoalEstimatorParams) -> GoalEstimator {
    let windows = training_windows();
    let tracks: Vec<_> =
        windows.iter().flat_map(|window| (0..window.len()).map(|i| window.track(i).to_vec())).collect();
    let stride = (tracks.len() / EXPERTS).max(1);
    let some = tracks.into_iter().step_by(stride).collect();
    let library = ExpertLibrary::new(some, TIME_STEP).expect("simulated tracks are complete");
    GoalEstimator::new(params, library).expect("the parameters are valid, and there are more tracks than experts")
}
