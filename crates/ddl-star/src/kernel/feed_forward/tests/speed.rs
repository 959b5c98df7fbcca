//! What bf16 gains, as `docs/performance.md` has it.

use std::time::Instant;

use super::exact::Case;
use crate::kernel::{Dropout, Gradients};

/// The shortest of many times of each of several computations, in turns, in microseconds.
fn shortest<const N: usize>(mut computations: [&mut dyn FnMut(); N]) -> [f64; N] {
    let mut shortest = [f64::INFINITY; N];
    for _ in 0..60 {
        for (shortest, compute) in shortest.iter_mut().zip(&mut computations) {
            let start = Instant::now();
            compute();
            *shortest = shortest.min(1e6 * start.elapsed().as_secs_f64());
        }
    }
    shortest
}

/// `cargo test --release -p ddl-star --lib -- --ignored --nocapture bf16_against_f32`
#[test]
#[ignore = "a measurement, for an optimised build"]
fn bf16_against_f32() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.unwrap().install(|| {
        for rows in [20, 64, 266, 1075] {
            let dropout = Some(Dropout { p: 0.1, seed: 3 });
            let case = Case::new(32, 2048, rows, dropout);
            let rounded = case.clone().in_bf16();
            let layers = [case.layer(), rounded.layer()];
            let [y, gx] = [case.x.clone(), case.x.clone()];
            let mut forwards = layers
                .each_ref()
                .map(|layer| || layer.forward(&case.x, None, &mut y.clone()));
            let [a, b] = &mut forwards;
            let forward = shortest([a, b]);
            let mut backwards = layers.each_ref().map(|layer| {
                || {
                    let mut grads = Gradients::zeros(32, 2048);
                    layer.backward(&case.x, &case.gy, dropout, &mut gx.clone(), &mut grads);
                }
            });
            let [a, b] = &mut backwards;
            let backward = shortest([a, b]);
            for (pass, [f32, bf16]) in [("forward", forward), ("backward", backward)] {
                let gain = f32 / bf16;
                eprintln!("{rows} rows {pass}: f32 {f32:.0} us, bf16 {bf16:.0} us: {gain:.2}");
            }
        }
    });
}
