//! Regions and weights that follow a place, learned by a second program too: `reference/adaptive.py`.

use std::sync::Arc;

use ddl_core::{
    AdaptiveRegions, Forecast, HORIZON, ObservationQuality, Pace, PedestrianId, Position, RegionTable, Spread, Window,
};

const STEP: i64 = 3;
const LEVELS: [f64; 3] = [0.25, 0.5, 0.8125];

/// A sequence of numbers in 0..1, the same in both programs.
struct Draws(u64);

impl Draws {
    fn draw(&mut self) -> f64 {
        self.0 = (self.0 * 1_103_515_245 + 12_345) % (1 << 31);
        self.0 as f64 / f64::from(1_u32 << 31)
    }
}

fn table() -> Arc<RegionTable> {
    let scores = Pace::ALL.map(|pace| -> Vec<[f64; HORIZON]> {
        let score = |n: i32| f64::from(n) / (40.0 + 10.0 * f64::from(pace as u8));
        (1..100).map(|n| std::array::from_fn(|t| score(n) * (1.0 + 0.05 * t as f64))).collect()
    });
    let table = RegionTable::of(&scores.each_ref().map(Vec::as_slice), &LEVELS).unwrap();
    let mut json = serde_json::to_value(table).unwrap();
    // Of whole paths and scenes, which do not change those of steps.
    json["wholes"] = serde_json::json!({"paths": [[0.4, 0.8, 1.7], [0.5, 0.9, 1.6], [0.4, 0.7, 1.9]],
        "scenes": [[0.2, 0.4], [0.5, 0.5], [1.1, 0.3]]});
    Arc::new(serde_json::from_value(json).unwrap())
}

/// The pedestrians at a frame: most of fourteen, one of whom is another one from time to time.
fn moment(at: i64, frame: i64, draws: &mut Draws, regions: &Arc<RegionTable>) -> (Window, Forecast) {
    let (mut ids, mut tracks, mut qualities) = (Vec::new(), Vec::new(), Vec::new());
    let (mut paths, mut weights, mut scales, mut paces) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for i in 0..14 {
        let u: [f64; 8] = std::array::from_fn(|_| draws.draw());
        if u[0] < 0.1 {
            continue;
        }
        let (n, pace) = (f64::from(i), if i >= 4 { 2 } else { i as usize % 2 });
        let way = [0.05 + 0.02 * n, 0.2 - 0.03 * n];
        let place = |frame: i64| -> Position {
            let f = frame as f64;
            [3.0 * n + way[0] * f + 0.2 * f.sin(), way[1] * f + 0.3 * (0.7 * f + n).cos()]
        };
        let (before, last) = (place(frame - STEP), place(frame));
        for off in [[0.01 * u[1], 0.02 * u[2]], [-0.1 - 0.05 * u[3], 0.07], [0.08, 0.1 * u[4]]] {
            let steps = (1..=HORIZON).map(|t| STEP as f64 * t as f64);
            paths.extend(steps.map(|f| [0, 1].map(|axis| last[axis] + (way[axis] + off[axis]) * f)));
        }
        let slow = if at % 5 == 0 { [0.0, 0.3, 0.7] } else { [0.45, 0.55, 0.0] };
        weights.extend([[0.7, 0.2, 0.1], slow, [0.15, 0.25, 0.6]][pace]);
        let size = [9.0, 0.4, if at < 120 { 0.0004 } else { 1.2 }][pace];
        scales.extend((0..HORIZON).map(|t| size * (1.0 + 0.1 * t as f64)));
        let rows = (at - 5).rem_euclid(40);
        let is_young = i == 5 && rows < 6 && at > 40;
        qualities.push(ObservationQuality {
            age: if u[5] < 0.1 { 0.1 } else { 0.0 },
            unseen: if is_young { 6 - rows as usize } else { 0 },
            ..ObservationQuality::default()
        });
        paces.push(Pace::ALL[pace]);
        ids.push(PedestrianId(i64::from(i)));
        tracks.push([vec![before; 7], vec![last]].concat());
    }
    let forecast = Forecast::new(ids.len(), 3, paths, weights, None).unwrap();
    let regions = Arc::clone(regions);
    let forecast = forecast.with_spread(Spread { scales, paces, regions }).unwrap();
    let window = Window::new("yard", frame - 7 * STEP, STEP, ids, tracks).unwrap();
    (window.with_qualities(qualities), forecast)
}

/// The same pedestrians in the opposite order, with other ids.
fn turned(window: &Window, forecast: &Forecast) -> (Window, Forecast) {
    let order: Vec<usize> = (0..window.len()).rev().collect();
    let (ids, start) = (order.iter().map(|&i| PedestrianId(99 - window.pedestrians()[i].0)), window.start_frame());
    let tracks = order.iter().map(|&i| window.observed(i).to_vec()).collect();
    let turned = Window::new("yard", start, STEP, ids.collect(), tracks).unwrap();
    let qualities = order.iter().map(|&i| window.quality(i)).collect();
    (turned.with_qualities(qualities), forecast.of_pedestrians(&order))
}

/// The sum of numbers, the first once, the second twice and so on.
fn sum(numbers: impl Iterator<Item = f64>) -> f64 {
    (1..).zip(numbers).map(|(n, number)| f64::from(n) * number).sum()
}

/// The steps have three frames; frames are left out, come between the steps, and begin again.
#[test]
fn a_place_is_learned_as_by_another_program() {
    let expected: Vec<[f64; 6]> = serde_json::from_str(include_str!("reference/adaptive.json")).unwrap();
    let (mut draws, mut frame, regions) = (Draws(7), 100, table());
    let [mut adaptive, mut other] = [AdaptiveRegions::default(), AdaptiveRegions::default()];
    for (at, expected) in (0..).zip(expected) {
        let later = [1, 2, 3, 3, 3, 3, 4, 5][(8.0 * draws.draw()) as usize];
        frame += if at == 180 { 0 } else { later };
        frame += i64::from(at == 60) * 80 - i64::from(at == 130) * 400;
        let (window, forecast) = moment(at, frame, &mut draws, &regions);
        let (turned, backwards) = turned(&window, &forecast);
        let adapted = adaptive.adapt(&window, forecast);
        let order: Vec<usize> = (0..window.len()).rev().collect();
        assert_eq!(other.adapt(&turned, backwards), adapted.of_pedestrians(&order), "the order does not matter");
        let hypotheses = || (0..window.len()).flat_map(|i| (0..3).map(move |k| (i, k)));
        let weights = sum(hypotheses().map(|(i, k)| adapted.weight(i, k)));
        let steps = hypotheses().flat_map(|(i, k)| (0..HORIZON).map(move |t| (i, k, t)));
        let radii = sum(steps.map(|(i, k, t)| adapted.region_radius(i, k, t, 0.6).unwrap_or(0.0)));
        let table = adaptive.table().unwrap();
        let [standing, slow, walking] = Pace::ALL.map(|pace| {
            let cells = LEVELS.iter().flat_map(|&level| (0..HORIZON).map(move |t| (level, t)));
            sum(cells.map(|(level, t)| table.quantile(pace, level, t).unwrap()))
        });
        let found = [frame as f64, weights, radii, standing, slow, walking];
        let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-10 * b.abs();
        assert!(found.iter().zip(&expected).all(is_near), "{at}: {found:?} {expected:?}");
    }
}
