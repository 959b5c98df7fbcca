//! Cost of a full memory of 20,000 segments: a recall, and a frame of 25 pedestrians.

#[path = "../tests/crowd/mod.rs"]
mod crowd;

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use crowd::Crowd;
use ddl_data::{OBSERVED, PedestrianId, Position};
use ddl_memory::SceneMemory;

const PEDESTRIANS: usize = 25;

/// A memory at its capacity, its crowd, the next frame, and queries for the memory.
fn full() -> (SceneMemory, Crowd, i64, Vec<(PedestrianId, [Position; OBSERVED])>) {
    let mut memory = SceneMemory::new(1, SceneMemory::DEFAULT_CAPACITY).expect("in range");
    let mut crowd = Crowd::new(1, PEDESTRIANS);
    let mut last = Vec::new();
    for frame in 0..4_000 {
        let pedestrians = crowd.step();
        memory.observe(frame, pedestrians.clone()).expect("valid");
        last.push(pedestrians);
    }
    let last = &last[last.len() - OBSERVED..];
    let observed = |id| {
        last.iter()
            .map(move |pedestrians| pedestrians.iter().find(|seen| seen.0 == id).map(|seen| seen.1))
    };
    let queries = last[OBSERVED - 1].iter().filter_map(|&(id, _)| {
        let positions: Option<Vec<Position>> = observed(id).collect();
        Some((id, positions?.try_into().ok()?))
    });
    (memory, crowd, 4_000, queries.collect())
}

/// Times every run separately, for percentiles.
fn measure(criterion: &mut Criterion, name: &str, mut run: impl FnMut() -> Duration) {
    let mut times: Vec<Duration> = Vec::new();
    criterion.bench_function(name, |b| {
        b.iter_custom(|iterations| {
            let first = times.len();
            times.extend((0..iterations).map(|_| run()));
            times[first..].iter().sum()
        });
    });
    times.sort_unstable();
    let quantile = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    let [median, most, worst] = [0.5, 0.99, 1.0].map(quantile);
    eprintln!("{name}: median {median:?}, 99th percentile {most:?}, maximum {worst:?}\n");
}

fn recall(criterion: &mut Criterion) {
    let (memory, _, _, queries) = full();
    let summary = memory.summary();
    let (segments, tracks) = (summary.segments, summary.tracks);
    let name = format!("recall of 12 from {segments} segments, {tracks} tracks");
    let mut queries = queries.iter().cycle();
    measure(criterion, &name, || {
        let (id, observed) = queries.next().expect("a query");
        let start = Instant::now();
        black_box(memory.recall(black_box(observed), Some(*id), 12));
        start.elapsed()
    });
}

fn observe(criterion: &mut Criterion) {
    let (mut memory, mut crowd, mut frame, _) = full();
    measure(criterion, "observe 25 pedestrians", || {
        let pedestrians = crowd.step();
        let start = Instant::now();
        memory.observe(frame, pedestrians).expect("valid");
        frame += 1;
        start.elapsed()
    });
}

criterion_group!(benches, recall, observe);
criterion_main!(benches);
