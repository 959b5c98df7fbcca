//! Cost of the risks of 1,000 plans among 25 pedestrians with 20 futures, on one thread.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use ddl_core::{Forecast, HORIZON, OBSERVED, Pace, PedestrianId, Position, RegionTable, Spread, Window};
use ddl_scene::{Futures, Plan, PlanPoint};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const PEDESTRIANS: usize = 25;
const FUTURES: usize = 20;
/// Side of the place, metres.
const SIDE: f64 = 20.0;

/// People that walk in all directions: their futures end some metres apart, the spread grows to 0.2 to 0.4 m.
fn crowd(random: &mut ChaCha8Rng) -> Futures {
    let starts: Vec<Position> = (0..PEDESTRIANS)
        .map(|_| [0; 2].map(|_| random.random_range(0.0..SIDE)))
        .collect();
    let ids = (0..PEDESTRIANS as i64).map(PedestrianId).collect();
    let window = Window::new(
        "yard",
        0,
        10,
        ids,
        starts.iter().map(|&at| vec![at; OBSERVED]).collect(),
    );
    let (mut positions, mut scales) = (Vec::new(), Vec::new());
    for [x, y] in starts {
        let heading = random.random_range(0.0..6.3);
        for _ in 0..FUTURES {
            let (angle, speed) = (
                heading + random.random_range(-0.5..0.5_f64),
                random.random_range(0.8..1.5),
            );
            let at = |t: usize| 0.4 * speed * t as f64;
            positions.extend((1..=HORIZON).map(|t| [x + at(t) * angle.cos(), y + at(t) * angle.sin()]));
        }
        let scale = random.random_range(0.2..0.4);
        scales.extend((1..=HORIZON).map(|t| scale * t as f64 / HORIZON as f64));
    }
    let forecast = Forecast::with_equal_weights(PEDESTRIANS, FUTURES, positions).expect("valid");
    let regions = RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5])
        .expect("valid")
        .into();
    let paces = vec![Pace::Walking; PEDESTRIANS];
    let forecast = forecast.with_spread(Spread { scales, paces, regions }).expect("valid");
    Futures::new(&window.expect("valid"), forecast).expect("joint")
}

/// Plans of a robot in the middle, 0.3 m in radius, that goes 5 m in any direction and turns on the way.
fn plans(random: &mut ChaCha8Rng) -> Vec<Plan> {
    let plan = |_| {
        let (angle, turn) = (random.random_range(0.0..6.3_f64), random.random_range(-0.1..0.1));
        let mut position = [SIDE / 2.0; 2];
        let points = (0..=HORIZON).map(|t| {
            let heading = angle + turn * t as f64;
            let point = PlanPoint {
                time: 0.4 * t as f64,
                position,
                radius: 0.3,
            };
            position = [position[0] + 0.4 * heading.cos(), position[1] + 0.4 * heading.sin()];
            point
        });
        Plan::new(points.collect()).expect("valid")
    };
    (0..1000).map(plan).collect()
}

fn risk(criterion: &mut Criterion) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (futures, plans) = (crowd(&mut random), plans(&mut random));
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    let mut bench = |name: &str, plans: &[Plan]| {
        criterion.bench_function(name, |b| {
            b.iter(|| one.install(|| futures.risks(black_box(plans), 0.3)));
        });
    };
    bench("risks of 1000 plans", &plans);
    bench("risk of 1 plan", &plans[..1]);
    criterion.bench_function("clearance of 1 plan", |b| {
        b.iter(|| futures.clearances(black_box(&plans[..1])));
    });
}

criterion_group!(benches, risk);
criterion_main!(benches);
