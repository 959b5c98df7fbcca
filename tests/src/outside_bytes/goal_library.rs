//! The expert library and the goal estimator's parameters as JSON.

use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams};

/// Reads bytes as a library, and as parameters for goals from a library of one pedestrian.
pub fn read(bytes: &[u8]) {
    if let Ok(library) = serde_json::from_slice::<ExpertLibrary>(bytes) {
        let text = serde_json::to_string(&library).expect("valid values can be written");
        assert_eq!(serde_json::from_str(&text).ok(), Some(library));
    }
    if let Ok(params) = serde_json::from_slice::<GoalEstimatorParams>(bytes) {
        let text = serde_json::to_string(&params).expect("valid values can be written");
        assert_eq!(serde_json::from_str(&text).ok(), Some(params.clone()));
        let Ok(params) = params.check() else {
            return;
        };
        let track = (0..20).map(|t| [0.5 * f64::from(t), 0.0]).collect();
        let library = ExpertLibrary::new(vec![track], 0.4).expect("a sound library");
        let _ = GoalEstimator::new(params, library);
    }
}
