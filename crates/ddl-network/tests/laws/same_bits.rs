//! The forecast of a window has the same bits alone and together with other windows, with any number of threads.

use super::scenes::{Question, WINDOWS, configs, with_threads};
use ddl_core::Window;
use ddl_network::{MotionNetwork, Noise, StepRule, WindowRollout};
use proptest::prelude::*;
use proptest::sample::Index;

fn bits(rollout: &WindowRollout) -> Vec<u64> {
    let factors = rollout.factors.iter().flatten().flatten();
    rollout.positions.as_flattened().iter().chain(factors).map(|number| number.to_bits()).collect()
}

fn questions() -> impl Strategy<Value = Question> {
    let noise = prop_oneof![
        (1..4_usize).prop_map(|goals| (goals, Noise::Expected)),
        (1..4_usize, any::<u64>()).prop_map(|(count, seed)| (1, Noise::Draws { count, seed })),
    ];
    let rule = prop_oneof![Just(StepRule::Euler), Just(StepRule::Bounded)];
    (noise, rule, any::<bool>()).prop_map(|((goals, noise), rule, shared)| Question { goals, noise, rule, shared })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn forecasts_have_the_same_bits_alone_and_among_others(
        config in prop::sample::select(configs()),
        question in questions(),
        chosen in prop::collection::vec(any::<Index>(), 1..10),
        threads in 1..4_usize,
    ) {
        let dynamics = config.variant.dynamics();
        let network = MotionNetwork::new(config, 5).unwrap();
        let windows: Vec<&Window> = chosen.iter().map(|index| index.get(&WINDOWS)).collect();
        let together = with_threads(threads, || question.ask(&network, &windows));
        prop_assert_eq!(together.len(), windows.len());
        for (window, together) in windows.into_iter().zip(&together) {
            let alone = with_threads(1, || question.ask(&network, &[window]));
            prop_assert!(together.positions.as_flattened().iter().all(|x| x.is_finite()));
            prop_assert_eq!(bits(&alone[0]), bits(together));
            prop_assert_eq!(together.factors.is_some(), dynamics);
        }
    }
}
