//! Forecasts of STAR depend on the other pedestrians, those of the perceptron do not.

use super::scenes::{Question, WINDOWS, distance, recommended};
use ddl_core::{HORIZON, Window};
use ddl_network::{BackboneKind, MotionNetwork, Variant};

/// Largest distance (m) between the forecasts of a pedestrian with others and alone: of the first pedestrian of each
/// window, and of all pedestrians.
fn furthest(backbone: BackboneKind) -> [f64; 2] {
    let network = MotionNetwork::new(recommended(backbone, Variant::Full), 5).unwrap();
    let question = Question::bounded(2);
    let (mut first, mut any) = (0.0_f64, 0.0_f64);
    for window in WINDOWS.iter().take(12).filter(|window| window.len() > 1) {
        let together = &question.ask(&network, &[window])[0];
        let alone: Vec<Window> =
            (0..window.len()).map(|i| window.filter_pedestrians(|other| other == i).unwrap()).collect();
        let alone: Vec<&Window> = alone.iter().collect();
        let alone = question.ask(&network, &alone).into_iter();
        for (i, (alone, together)) in alone.zip(together.positions.chunks(2 * HORIZON)).enumerate() {
            let apart = alone.positions.into_iter().zip(together).map(|(a, &b)| distance(a, b)).fold(0.0, f64::max);
            any = any.max(apart);
            if i == 0 {
                first = first.max(apart);
            }
        }
    }
    [first, any]
}

#[test]
fn star_depends_on_others_and_a_perceptron_does_not() {
    let [first, any] = furthest(BackboneKind::Perceptron);
    assert_eq!(first.to_bits(), 0.0_f64.to_bits(), "{first} m");
    assert!(any < 1e-4, "{any} m");
    let [_, any] = furthest(BackboneKind::Star);
    assert!(any > 1e-3, "{any} m");
}
