//! Forecasts are equivariant to translations and, in the pedestrian's own frame, to rotations.

use super::scenes::{WINDOWS, configs, distance, goals, recommended};
use ddl_core::{Position, Window};
use ddl_network::{BackboneKind, ForecastWindows as _, MotionNetwork, Noise, StarConfig, StepRule, Variant};
use proptest::prelude::*;
use proptest::sample::Index;

/// Largest distance (m) between the forecast in a moved scene and the moved forecast.
fn off(config: StarConfig, window: &Window, moved: impl Fn(Position) -> Position) -> f64 {
    let network = MotionNetwork::new(config, 5).unwrap();
    let forecast = |world: &dyn Fn(Position) -> Position| {
        let observed = [window.without_future().map_positions(|_, _, p| world(p))];
        let goals = goals(window, 3).into_iter();
        let goals = [goals.map(|goals| goals.into_iter().map(world).collect()).collect()];
        let rule = StepRule::Bounded;
        network.forecast_windows(&observed, &goals, Noise::Expected, rule, None).unwrap().remove(0).positions
    };
    let pairs = forecast(&|p| p).into_iter().zip(forecast(&moved));
    pairs.map(|(here, there)| distance(moved(here), there)).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn forecasts_are_translated_with_the_scene(
        config in prop::sample::select(configs()),
        window in any::<Index>(),
        [x, y] in [-6e6..6e6_f64, -6e6..6e6_f64],
    ) {
        let off = off(config, window.get(&WINDOWS), |p| [p[0] + x, p[1] + y]);
        prop_assert!(off < 1e-4, "{off} m");
    }

    /// A perceptron reads all inputs in the pedestrian's own frame. STAR reads the positions in the scene in the axes
    /// of the world.
    #[test]
    fn forecasts_of_a_perceptron_in_the_own_frame_are_rotated_with_the_scene(
        variant in prop::sample::select(vec![Variant::Full, Variant::NoDynamics]),
        window in any::<Index>(),
        angle in 0.0..std::f64::consts::TAU,
    ) {
        let (sin, cos) = angle.sin_cos();
        let config = recommended(BackboneKind::Perceptron, variant);
        let turn = |[x, y]: Position| [cos * x - sin * y, sin * x + cos * y];
        let off = off(config, window.get(&WINDOWS), turn);
        prop_assert!(off < 1e-4, "{off} m");
    }
}
