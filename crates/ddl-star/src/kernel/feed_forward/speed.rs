//! How fast the kernels are, as a share of what the processor can multiply: a table for a person to read.
#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]
#![expect(clippy::print_stdout, reason = "the table is the result")]

use std::hint::black_box;
use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};

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

/// Seconds that one of `runs` runs takes: processor time of a thread of the pool, and what a clock shows of the fastest.
///
/// Other programs on the machine make the second longer, the first hardly.
fn seconds(pool: &ThreadPool, runs: usize, mut run: impl FnMut() + Send) -> [f64; 2] {
    let spent = || -> f64 { pool.broadcast(|_| own_seconds()).into_iter().sum() };
    let before = spent();
    let fastest = pool.install(|| {
        let clock = (0..runs).map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        });
        clock.fold(f64::INFINITY, f64::min)
    });
    let threads = pool.current_num_threads() * runs;
    [(spent() - before) / threads as f64, fastest]
}

/// Seconds of processor time of this thread.
fn own_seconds() -> f64 {
    let line = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    let nanoseconds = line.split(' ').next().expect("a number");
    nanoseconds.parse::<f64>().expect("a number") / 1e9
}

fn pool_of(threads: usize) -> ThreadPool {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads")
}

fn numbers(count: usize) -> Vec<f32> {
    let number = |i: usize| ((i * 2_654_435_761) % 4096) as f32 / 4096.0 - 0.5;
    (0..count).map(number).collect()
}

const WIDTH: usize = 32;
const HIDDEN: usize = 2048;

/// The best of some samples: seconds of a product and sum at the peak, then of both passes, each by both clocks.
fn measure(
    set: InstructionSet,
    pool: &ThreadPool,
    rows: usize,
    dropout: Option<Dropout>,
) -> [[f64; 2]; 3] {
    let (w, b1, b2) = (numbers(WIDTH * HIDDEN), numbers(HIDDEN), numbers(WIDTH));
    let layer = FeedForward::pack(&w, &b1, &w, &b2, WIDTH, HIDDEN);
    let layer = layer.with_instructions(set).expect("available");
    let dispatch = Dispatch::new(set).expect("available");
    let alone = pool_of(1);
    let x = numbers(rows * WIDTH);
    let [mut y, mut gx] = [vec![0.0; x.len()], vec![0.0; x.len()]];
    let mut grads = Gradients::zeros(WIDTH, HIDDEN);
    let runs = (15_000 / rows).max(1);
    let mut best = [[f64::INFINITY; 2]; 3];
    for _ in 0..5 {
        let mut operations = 0.0;
        let peak = seconds(&alone, 10, || {
            operations = dispatch.run(Peak { rounds: 1_000_000 });
        });
        let forward = seconds(pool, runs, || {
            layer.forward(&x, dropout, &mut y);
        });
        let backward = seconds(pool, runs, || {
            layer.backward(&x, &y, dropout, &mut gx, &mut grads);
        });
        let sample = [peak.map(|peak| peak / operations), forward, backward];
        for (best, sample) in best
            .as_flattened_mut()
            .iter_mut()
            .zip(sample.as_flattened())
        {
            *best = best.min(*sample);
        }
    }
    best
}

#[test]
#[ignore = "prints speeds, and takes a minute"]
fn table() {
    println!("GFLOP/s of each thread by processor time (share of the peak), of all by the clock");
    println!("set       threads  rows  dropout          forward           backward");
    for set in InstructionSet::available() {
        for threads in [1, 2] {
            let pool = pool_of(threads);
            for rows in [25, 266, 500, 5054] {
                for p in [0.0, 0.1] {
                    let dropout = Some(Dropout { p, seed: 3 });
                    let [peak, passes @ ..] = measure(set, &pool, rows, dropout);
                    let [forward, backward] = [0, 1].map(|pass| {
                        // What the formula needs; computing the hidden units again does not count.
                        let operations = [4.0, 8.0][pass] * (rows * WIDTH * HIDDEN) as f64;
                        let [own, clock] = passes[pass].map(|time| operations / time / 1e9);
                        let own = own / threads as f64;
                        let share = 100.0 * own * 1e9 * peak[0];
                        format!("{own:6.1} ({share:3.0} %) {clock:6.1}")
                    });
                    println!("{set:9} {threads:7} {rows:5}  {p:7}  {forward}  {backward}");
                }
            }
        }
    }
}

#[test]
#[ignore = "prints a time"]
fn arranging_the_weights() {
    let (w, b1, b2) = (numbers(WIDTH * HIDDEN), numbers(HIDDEN), numbers(WIDTH));
    let mut layer = FeedForward::pack(&w, &b1, &w, &b2, WIDTH, HIDDEN);
    let [own, _] = seconds(&pool_of(1), 2000, || layer.update(&w, &b1, &w, &b2));
    println!("weights of 32 x 2048 arranged in {:.0} us", own * 1e6);
}
