//! Speed of the value, the gradient and the search on synthetic walkers.
//!
//! The search reports pairs (query × candidate) a second on one thread: 1 / (pairs/s) is the time of a pair.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use ddl_softdtw::{Cost, SearchIndex, SoftDtw};

type Walk = Vec<[f64; 2]>;

/// Velocities (m/s) of walkers with constant headings and some sway, one in ten of them standing.
fn walkers(count: usize, steps: usize, seed: u64) -> Vec<Walk> {
    let mut state = seed;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..count)
        .map(|_| {
            let speed = if next() < 0.1 {
                0.0
            } else {
                0.4 + 1.2 * next()
            };
            let (sin, cos) = (std::f64::consts::TAU * next()).sin_cos();
            let mut sway = || 0.1 * (speed + 0.1) * (next() - 0.5);
            (0..steps)
                .map(|_| [speed * cos + sway(), speed * sin + sway()])
                .collect()
        })
        .collect()
}

fn pair(criterion: &mut Criterion) {
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean).expect("valid gamma");
    let walks = walkers(2, 8, 1);
    let mut group = criterion.benchmark_group("pair 8x8x2");
    group.bench_function("value", |b| {
        b.iter(|| dtw.value(black_box(&walks[0]), black_box(&walks[1])));
    });
    group.bench_function("value and gradient", |b| {
        b.iter(|| dtw.value_and_gradient(black_box(&walks[0]), black_box(&walks[1])));
    });
    group.finish();
}

fn search(criterion: &mut Criterion) {
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean).expect("valid gamma");
    let mut group = criterion.benchmark_group("search nearest 100");
    group.sample_size(20);
    for steps in [7, 8] {
        for candidates in [1_000, 10_000, 37_000] {
            let index = SearchIndex::build(&dtw, &walkers(candidates, steps, 2)).expect("valid");
            let queries = walkers(16, steps, 3);
            group.throughput(Throughput::Elements((candidates * queries.len()) as u64));
            group.bench_function(
                BenchmarkId::new(format!("{steps} steps"), candidates),
                |b| {
                    b.iter(|| {
                        for query in &queries {
                            black_box(index.nearest(query, 100)).expect("valid");
                        }
                    });
                },
            );
        }
    }
    group.finish();
}

criterion_group!(benches, pair, search);
criterion_main!(benches);
