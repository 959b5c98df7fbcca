//! Cost of the risks of 1,000 plans among 25 pedestrians with 20 futures (`RAYON_NUM_THREADS=1` for one thread).

use criterion::{Criterion, criterion_group, criterion_main};
use ddl_core::{Forecast, HORIZON, OBSERVED, Pace, PedestrianId, Position, RegionTable, Spread, Window};
use ddl_scene::{Futures, Plan, PlanPoint};

/// From a place in a direction (radians) at 1.2 m/s: the next 12 positions.
fn straight([x, y]: Position, angle: f64) -> impl Iterator<Item = Position> {
    let [dx, dy] = [0.48 * angle.cos(), 0.48 * angle.sin()];
    (1..=HORIZON).map(move |t| [x + dx * t as f64, y + dy * t as f64])
}

/// 25 people in a square of 20 m, who walk in all directions. Their futures end some metres apart.
fn crowd() -> Futures {
    let starts: Vec<Position> = (0..25).map(|i| [5 * (i % 5), 5 * (i / 5)].map(f64::from)).collect();
    let tracks = starts.iter().map(|&start| vec![start; OBSERVED]).collect();
    let window = Window::new("yard", 0, 10, (0..25).map(PedestrianId).collect(), tracks).expect("valid");
    let path = |row: usize| straight(starts[row / 20], 2.4 * (row / 20) as f64 + 0.05 * (row % 20) as f64);
    let forecast = Forecast::with_equal_weights(25, 20, (0..500).flat_map(path).collect()).expect("valid");
    let scales = (1..=HORIZON).map(|t| 0.025 * t as f64);
    let scales = scales.collect::<Vec<_>>().repeat(25);
    let paces = vec![Pace::Walking; 25];
    let regions = RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5]);
    let regions = regions.expect("valid").into();
    let forecast = forecast.with_spread(Spread { scales, paces, regions });
    Futures::new(&window, forecast.expect("valid")).expect("joint")
}

fn risk(criterion: &mut Criterion) {
    let futures = crowd();
    let row = |(t, position)| PlanPoint {
        time: 0.4 * f64::from(t),
        position,
        radius: 0.3,
    };
    let path = |i: i32| (1..).zip(straight([10.0; 2], 0.00628 * f64::from(i)));
    let plan = |i| Plan::new(path(i).map(row).collect()).expect("valid");
    let plans: Vec<Plan> = (0..1000).map(plan).collect();
    criterion.bench_function("risks of 1000 plans", |b| b.iter(|| futures.risks(&plans, 0.3, None)));
    criterion.bench_function("clearance of 1 plan", |b| b.iter(|| futures.clearances(&plans[..1])));
}

criterion_group!(benches, risk);
criterion_main!(benches);
