//! Speed of the value, the gradient and the search (pairs per second).

#[path = "../tests/walks/mod.rs"]
mod walks;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use ddl_softdtw::SearchIndex;
use std::hint::black_box;
use walks::{RandomNumbers, dtw_of};

fn pair<const D: usize>(criterion: &mut Criterion, x: &[[f64; D]], y: &[[f64; D]]) {
    let dtw = dtw_of(1.0);
    let name = format!("pair {}x{}x{D}", x.len(), y.len());
    let mut group = criterion.benchmark_group(name);
    group.bench_function("value", |b| {
        b.iter(|| dtw.value(black_box(x), black_box(y)));
    });
    group.bench_function("value and gradient", |b| {
        b.iter(|| dtw.value_and_gradient(black_box(x), black_box(y)));
    });
    group.finish();
}

fn pairs(criterion: &mut Criterion) {
    let mut numbers = RandomNumbers::seeded(1);
    pair::<2>(criterion, &numbers.pedestrian(8), &numbers.pedestrian(8));
    pair::<2>(criterion, &numbers.pedestrian(64), &numbers.pedestrian(64));
    pair::<8>(criterion, &numbers.pedestrian(256), &numbers.pedestrian(256));
}

fn search(criterion: &mut Criterion) {
    let mut numbers = RandomNumbers::seeded(2);
    let mut pedestrians = |count| (0..count).map(|_| numbers.pedestrian::<2>(8)).collect::<Vec<_>>();
    let (sequences, queries) = (pedestrians(4096), pedestrians(24));
    let mut group = criterion.benchmark_group("search 8x8x2");
    group.sample_size(20);
    let pairs = (sequences.len() * queries.len()) as u64;
    group.throughput(Throughput::Elements(pairs));
    let index = SearchIndex::build(&dtw_of(1.0), &sequences).expect("valid");
    group.bench_function("100 nearest", |b| {
        b.iter(|| {
            for x in &queries {
                black_box(index.nearest(x, 100)).expect("valid");
            }
        });
    });
    group.finish();
}

criterion_group!(benches, pairs, search);
criterion_main!(benches);
