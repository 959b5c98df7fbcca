//! Cost of the risks of 1,000 plans among 25 pedestrians with 20 futures, on one thread.

use std::f64::consts::TAU;
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

/// From a place in a direction (radians) at a speed (m/s): the next 12 positions.
fn straight([x, y]: Position, angle: f64, speed: f64) -> impl Iterator<Item = Position> {
    let at = move |t: usize| 0.4 * speed * t as f64;
    (1..=HORIZON).map(move |t| [x + at(t) * angle.cos(), y + at(t) * angle.sin()])
}

/// People that walk in all directions. Their futures end some metres apart; the spread grows to 0.3 m.
fn crowd(random: &mut ChaCha8Rng) -> Futures {
    let (mut tracks, mut positions) = (Vec::new(), Vec::new());
    for _ in 0..PEDESTRIANS {
        let (start, heading) = (
            [0; 2].map(|_| random.random_range(0.0..SIDE)),
            random.random_range(0.0..TAU),
        );
        tracks.push(vec![start; OBSERVED]);
        for _ in 0..FUTURES {
            let angle = heading + random.random_range(-0.5..0.5);
            positions.extend(straight(start, angle, random.random_range(0.8..1.5)));
        }
    }
    let ids = (0..PEDESTRIANS as i64).map(PedestrianId).collect();
    let window = Window::new("yard", 0, 10, ids, tracks).expect("valid");
    let scales = (0..PEDESTRIANS * HORIZON)
        .map(|row| 0.025 * (row % HORIZON + 1) as f64)
        .collect();
    let regions = RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5])
        .expect("valid")
        .into();
    let paces = vec![Pace::Walking; PEDESTRIANS];
    let forecast = Forecast::with_equal_weights(PEDESTRIANS, FUTURES, positions).expect("valid");
    let forecast = forecast.with_spread(Spread { scales, paces, regions });
    Futures::new(&window, forecast.expect("valid")).expect("joint")
}

/// A robot of 0.3 m in the middle goes 5 m in any direction.
fn plan(angle: f64) -> Plan {
    let path = straight([SIDE / 2.0; 2], angle, 1.0).zip(1..);
    let row = |(position, t)| PlanPoint {
        time: 0.4 * f64::from(t),
        position,
        radius: 0.3,
    };
    Plan::new(path.map(row).collect()).expect("valid")
}

fn risk(criterion: &mut Criterion) {
    let futures = crowd(&mut ChaCha8Rng::seed_from_u64(1));
    let plans: Vec<Plan> = (0..1000).map(|i| plan(f64::from(i) * TAU / 1000.0)).collect();
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    criterion.bench_function("risks of 1000 plans", |b| {
        b.iter(|| one.install(|| futures.risks(black_box(&plans), 0.3, None)));
    });
    criterion.bench_function("clearance of 1 plan", |b| {
        b.iter(|| futures.clearances(black_box(&plans[..1])));
    });
}

criterion_group!(benches, risk);
criterion_main!(benches);
