//! Speed of the goal estimate of one walker, on synthetic walkers.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams, QuerySpan};

/// Numbers in [0, 1).
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Tracks of walkers with a heading each and some sway; one in ten stands.
fn tracks(count: usize, seed: u64) -> Vec<Vec<[f64; 2]>> {
    let mut next = numbers(seed);
    (0..count)
        .map(|_| {
            let speed = if next() < 0.1 {
                0.0
            } else {
                0.4 + 1.2 * next()
            };
            let (sin, cos) = (std::f64::consts::TAU * next()).sin_cos();
            let mut position = [0.0, 0.0];
            let mut sway = || 0.1 * (speed + 0.1) * (next() - 0.5);
            (0..20)
                .map(|_| {
                    position[0] += 0.4 * (speed * cos + sway());
                    position[1] += 0.4 * (speed * sin + sway());
                    position
                })
                .collect()
        })
        .collect()
}

fn estimate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("goals of one walker");
    group.sample_size(20);
    let published = GoalEstimatorParams::published().query(QuerySpan::Observed);
    let default = GoalEstimatorParams::default;
    for (frame, library, params) in [
        ("heading", 1_000, default()),
        ("heading", 10_000, default()),
        ("heading", 37_000, default()),
        ("world", 37_000, published),
    ] {
        let params = params.check().expect("valid");
        let library_of = ExpertLibrary::new(tracks(library, 2), 0.4).expect("valid");
        let estimator = GoalEstimator::new(params, library_of).expect("enough tracks");
        let queries = tracks(16, 3);
        let mut next = queries.iter().cycle();
        group.bench_function(BenchmarkId::new(frame, library), |b| {
            b.iter(|| {
                next.next()
                    .map(|track| estimator.estimate(black_box(track)))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, estimate);
criterion_main!(benches);
