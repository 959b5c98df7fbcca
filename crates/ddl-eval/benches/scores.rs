//! Time to score a fold as large as univ (24,254 pedestrians with 20 hypotheses each, all metrics and categories), and
//! time of adaptive regions.
#![allow(
    missing_docs,
    reason = "the function that criterion's macro makes has no documentation"
)]

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use ddl_core::{AdaptiveRegions, Forecast, Forecaster, Pace, RegionTable, Spread};
use ddl_data::{HORIZON, PedestrianId, Position, WINDOW, Window};
use ddl_eval::Scores;
use ddl_eval::baseline::{ConstantVelocity, SocialForce};

/// Pedestrians of univ under the published rule.
const PEDESTRIANS: usize = 24_254;
const CROWD: usize = 25;
/// Frames that the regions follow before time restarts.
const FRAMES: usize = 500;
/// Side of the square in which the pedestrians start, m: the density of univ.
const SIDE: f64 = 14.0;

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

/// Pedestrians of up to 1.5 m/s that sway and turn; one in five stands.
fn windows() -> Vec<Window> {
    let mut next = numbers(1);
    let mut track = || -> Vec<Position> {
        let mut here = [SIDE * next(), SIDE * next()];
        let mut heading = std::f64::consts::TAU * next();
        let step = if next() < 0.2 { 0.0 } else { 0.2 + 0.4 * next() };
        let turn = 0.1 * (next() - 0.5);
        (0..WINDOW)
            .map(|_| {
                heading += turn;
                let sway = [0.05 * (next() - 0.5), 0.05 * (next() - 0.5)];
                let (sin, cos) = heading.sin_cos();
                here = [here[0] + step * cos + sway[0], here[1] + step * sin + sway[1]];
                here
            })
            .collect()
    };
    let mut left = PEDESTRIANS;
    let mut windows = Vec::new();
    while left > 0 {
        let n = left.min(CROWD);
        let ids = (0..).take(n).map(PedestrianId).collect();
        let tracks = (0..n).map(|_| track()).collect();
        let frame = 10 * windows.len() as i64;
        windows.push(Window::new("crowd", frame, 10, ids, tracks).expect("finite"));
        left -= n;
    }
    windows
}

fn score(criterion: &mut Criterion) {
    let windows = windows();
    let noisy = ConstantVelocity::AngularNoise { seed: 1 };
    let forecasts: Vec<Forecast> = noisy.forecast_all(&windows).expect("a forecast");
    let mut group = criterion.benchmark_group("24,254 pedestrians");
    group.sample_size(10);
    group.bench_function("every metric of 20 hypotheses", |b| {
        b.iter(|| Scores::evaluate(black_box(&windows), black_box(&forecasts)));
    });
    group.bench_function("social force forecasts", |b| {
        b.iter(|| SocialForce.forecast_all(black_box(&windows)));
    });
    group.finish();
}

/// A frame of 25 pedestrians: the outcomes of the 12 forecasts before it, and its regions.
fn adapt(criterion: &mut Criterion) {
    let windows: Vec<Window> = windows().into_iter().take(FRAMES).collect();
    let scores: Vec<[f64; HORIZON]> = (1..1000).map(|n| [f64::from(n) / 200.0; HORIZON]).collect();
    let levels: Vec<f64> = (1..13).map(|n| f64::from(n) / 13.0).collect();
    let table = Arc::new(RegionTable::of(&[&scores; 3], &levels).expect("999 scores"));
    let noisy = ConstantVelocity::AngularNoise { seed: 1 }.forecast_all(&windows);
    let spread = || Spread {
        scales: vec![0.5; CROWD * HORIZON],
        paces: vec![Pace::Walking; CROWD],
        regions: Arc::clone(&table),
    };
    let forecasts: Vec<Forecast> = noisy
        .expect("a forecast")
        .into_iter()
        .map(|f| f.with_spread(spread()).expect("a spread"))
        .collect();
    let (mut regions, mut index) = (AdaptiveRegions::default(), 0);
    criterion.bench_function("regions of 25 pedestrians follow a frame", |b| {
        let next = || {
            index = (index + 1) % FRAMES;
            (&windows[index], forecasts[index].clone())
        };
        let follow = |(window, forecast)| regions.adapt(window, forecast);
        b.iter_batched(next, follow, BatchSize::SmallInput);
    });
}

criterion_group!(benches, score, adapt);
criterion_main!(benches);
