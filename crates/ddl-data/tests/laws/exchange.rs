//! Exchanges of ids.

use ddl_core::{OBSERVED, PedestrianId, distance};
use ddl_data::{Clock, MisfitTreatment, Observation};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use crate::observe::{partial, recording};

proptest! {
    /// Two or three who pass each other exchange their numbers, or not; one may be new. Their tracks go on.
    #[test]
    fn an_exchange_is_told_at_its_row_and_nothing_else_is(
        apart in 0.4..3.0_f64,
        rate in prop::sample::select(vec![2.5_f64, 5.0, 10.0, 25.0, 30.0]),
        (speed, other) in (0.0..1.6_f64, -1.6..1.6_f64),
        people in 2..4_i64,
        is_new: bool,
        is_exchanged: bool,
        seed: u64,
    ) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let normal = Normal::new(0.0, 0.01).unwrap();
        let exchange = (6.0 * rate) as i64;
        let place = |who: i64, frame: i64| {
            let time = (frame - exchange) as f64 / rate;
            [[speed, other, 0.0][who as usize] * time, apart * who as f64]
        };
        // Whoever has this number.
        let who = |number: i64, frame: i64| (number + i64::from(is_exchanged && frame >= exchange)) % people;
        let mut rows = Vec::new();
        for frame in 0..2 * exchange {
            for number in 0..people {
                let at = place(who(number, frame), frame).map(|coordinate| coordinate + normal.sample(&mut random));
                let is_here = !(is_new && who(number, frame) == 1 && frame < exchange - 3);
                rows.extend(is_here.then(|| Observation::new(frame, PedestrianId(number), at)));
            }
        }
        let observed = partial(&recording(Clock::with_frame_time(1.0 / rate).unwrap(), rows));
        let misfits: Vec<_> = observed.misfits.iter().map(|misfit| (misfit.pedestrian, misfit.treatment)).collect();
        let expected = |id| is_exchanged.then_some((PedestrianId(id), MisfitTreatment::Exchanged));
        prop_assert_eq!(misfits, (0..people).filter_map(expected).collect::<Vec<_>>());
        for window in observed.windows.iter().skip(exchange as usize - 1) {
            prop_assert_eq!(window.len(), people as usize);
            for (i, id) in window.pedestrians().iter().enumerate() {
                let frames = window.frames().iter().zip(window.observed(i)).skip(window.quality(i).unseen);
                let frame = |tick: i64| tick * (0.4 * rate).round() as i64 / window.frame_step();
                let who = who(id.0, frame(window.frames()[OBSERVED - 1]));
                for (&tick, &at) in frames {
                    let off = distance(at, place(who, frame(tick)));
                    prop_assert!(off < 0.2, "{id:?} at {tick}: {off}");
                }
            }
        }
    }
}
