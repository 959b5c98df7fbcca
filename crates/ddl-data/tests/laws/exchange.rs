//! Exchanges of ids.

use ddl_core::PedestrianId;
use ddl_data::{Clock, MisfitTreatment, Observation};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use crate::observe::{partial, recording};

proptest! {
    /// Whoever pass each other exchange their numbers, or not.
    #[test]
    fn an_exchange_is_told_at_its_row_and_nothing_else_is(
        apart in 0.5..4.0_f64,
        rate in prop::sample::select(vec![2.5_f64, 10.0, 30.0]),
        (speed, other) in (0.8..1.6_f64, -1.6..1.6_f64),
        is_exchanged in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let normal = Normal::new(0.0, 0.02).unwrap();
        let exchange = (6.0 * rate) as i64;
        let mut rows = Vec::new();
        for frame in 0..2 * exchange {
            let time = (frame - exchange) as f64 / rate;
            for (pedestrian, at) in [[speed * time, 0.0], [other * time, apart]].into_iter().enumerate() {
                let number = pedestrian as i64 ^ i64::from(is_exchanged && frame >= exchange);
                let at = at.map(|coordinate| coordinate + normal.sample(&mut random));
                rows.push(Observation::new(frame, PedestrianId(number), at));
            }
        }
        let recording = recording(Clock::with_frame_time(1.0 / rate).unwrap(), rows);
        let observed = partial(&recording);
        let misfits: Vec<_> = observed.misfits.iter().map(|misfit| (misfit.pedestrian, misfit.treatment)).collect();
        let expected = [0, 1].map(|id| (PedestrianId(id), MisfitTreatment::BegunAnew));
        prop_assert_eq!(misfits, if is_exchanged { expected.to_vec() } else { Vec::new() });
    }
}
