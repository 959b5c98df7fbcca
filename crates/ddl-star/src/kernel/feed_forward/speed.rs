//! How fast the kernels are, as a share of what the processor can multiply: a table for a person to read.
#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]
#![expect(clippy::print_stdout, reason = "the table is the result")]

use std::hint::black_box;
use std::time::Instant;

use super::instruction_set::{Dispatch, InstructionSet};
use super::simd::{Kernel, Simd};
use super::{Dropout, FeedForward, Gradients};

/// Multiplications and additions that wait for nothing but their own accumulator.
struct Peak {
    rounds: u32,
}

/// Independent sums: more than the units' latency times their number.
const SUMS: usize = 10;

impl Kernel for Peak {
    type Output = f64;

    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) -> f64 {
        let factor = simd.splat(black_box(0.999));
        let term = simd.splat(black_box(0.001));
        let mut sums = [simd.splat(black_box(1.0)); SUMS];
        for _ in 0..self.rounds {
            for sum in &mut sums {
                *sum = simd.mul_add(*sum, factor, term);
            }
        }
        let mut block = super::Block::ZERO;
        for sum in sums {
            simd.store(simd.add(simd.load(&block, 0), sum), &mut block, 0);
        }
        black_box(block);
        f64::from(self.rounds) * (SUMS * S::WIDTH * 2) as f64
    }
}

/// Seconds of processor time that the threads of the pool took for one of `runs` runs.
fn seconds(pool: &rayon::ThreadPool, runs: usize, mut run: impl FnMut() + Send) -> f64 {
    let spent = || -> f64 { pool.broadcast(|_| own_seconds()).into_iter().sum() };
    let before = spent();
    pool.install(|| (0..runs).for_each(|_| run()));
    (spent() - before) / runs as f64
}

/// Seconds of processor time of this thread: other programs on the machine do not count.
fn own_seconds() -> f64 {
    let line = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    let nanoseconds = line.split(' ').next().expect("a number");
    nanoseconds.parse::<f64>().expect("a number") / 1e9
}

#[test]
#[ignore = "prints speeds, and takes a minute"]
fn table() {
    const WIDTH: usize = 32;
    const HIDDEN: usize = 2048;
    let numbers = |count: usize| -> Vec<f32> {
        let number = |i: usize| ((i * 2_654_435_761) % 4096) as f32 / 4096.0 - 0.5;
        (0..count).map(number).collect()
    };
    let (w, b1, b2) = (numbers(WIDTH * HIDDEN), numbers(HIDDEN), numbers(WIDTH));
    let start = Instant::now();
    let layer = FeedForward::pack(&w, &b1, &w, &b2, WIDTH, HIDDEN);
    println!("pack: {:.0} us", start.elapsed().as_secs_f64() * 1e6);
    println!(
        "set       threads  rows  dropout  forward GFLOP/s  of peak  backward GFLOP/s  of peak"
    );
    for set in InstructionSet::available() {
        let dispatch = Dispatch::new(set).expect("available");
        let layer = layer.clone().with_instructions(set).expect("available");
        if std::env::var("ONLY").is_ok_and(|only| only != format!("{set}")) {
            continue;
        }
        let samples: usize = std::env::var("SAMPLES").map_or(5, |n| n.parse().unwrap());
        let pool_of = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let one = pool_of(1).expect("threads");
        for threads in if std::env::var("ONLY").is_ok() {
            vec![1]
        } else {
            vec![1, 2]
        } {
            let pool = pool_of(threads).expect("threads");
            for rows in [25, 266, 500, 5054] {
                let x = numbers(rows * WIDTH);
                for dropout in [None, Some(Dropout { p: 0.1, seed: 3 })] {
                    let mut y = vec![0.0; rows * WIDTH];
                    let mut gx = y.clone();
                    let mut grads = Gradients::zeros(WIDTH, HIDDEN);
                    let runs = (15_000 / rows).max(1);
                    let [mut forward, mut backward, mut peak] = [f64::INFINITY; 3];
                    for _ in 0..samples {
                        let rounds = 1_000_000;
                        let mut count = 0.0;
                        let time = seconds(&one, 10, || count = dispatch.run(Peak { rounds }));
                        peak = peak.min(time / count);
                        let time = seconds(&pool, runs, || layer.forward(&x, dropout, &mut y));
                        forward = forward.min(time);
                        let time = seconds(&pool, runs, || {
                            layer.backward(&x, &y, dropout, &mut gx, &mut grads);
                        });
                        backward = backward.min(time);
                    }
                    let products = (rows * WIDTH * HIDDEN) as f64;
                    let speeds = [4.0 * products / forward, 8.0 * products / backward];
                    let shares = speeds.map(|speed| 100.0 * speed * peak);
                    println!(
                        "{set:9} {threads:7} {rows:5}  {:7}  {:15.1}  {:5.0} %  {:16.1}  {:5.0} %",
                        if dropout.is_some() { "0.1" } else { "no" },
                        speeds[0] / 1e9,
                        shares[0],
                        speeds[1] / 1e9,
                        shares[1],
                    );
                }
            }
            println!();
        }
    }
}
