//! The effect of half precision in the feed-forward blocks on forecasts.

use super::scenes::{Question, WINDOWS, distance};
use ddl_data::{Position, Window};
use ddl_network::{ForecastWindows as _, MotionNetwork, Precision, StarConfig, Variant};

#[test]
fn half_precision_changes_forecasts_slightly_and_no_weights() {
    let config = StarConfig {
        feed_forward_width: 96,
        ..StarConfig::published(Variant::Full)
    };
    let mut network = MotionNetwork::new(config, 3).unwrap();
    let weights = network.weights().clone();
    let windows: Vec<&Window> = WINDOWS.iter().take(4).collect();
    let forecasts = |network: &MotionNetwork| -> Vec<Position> {
        let rollouts = Question::bounded(1).ask(network, &windows).into_iter();
        rollouts.flat_map(|rollout| rollout.positions).collect()
    };
    let found = [Precision::F32, Precision::Bf16, Precision::F32].map(|precision| {
        let rounded = MotionNetwork::new(network.config().clone(), 3).unwrap();
        network = rounded.with_precision(precision);
        assert_eq!((network.precision(), network.weights()), (precision, &weights));
        let found = forecasts(&network);
        // `with_weights` keeps the precision.
        let again = MotionNetwork::new(network.config().clone(), 4).unwrap();
        let again = again.with_precision(precision).with_weights(weights.clone());
        assert_eq!(forecasts(&again.unwrap()), found);
        found
    });
    assert_eq!(found[0], found[2]);
    let pairs = found[0].iter().zip(&found[1]);
    let difference = pairs.map(|(&a, &b)| distance(a, b)).fold(0.0, f64::max);
    assert!(difference > 1e-7 && difference < 0.05, "{difference} m");
}
