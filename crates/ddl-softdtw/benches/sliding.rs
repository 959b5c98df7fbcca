//! Speed of the sliding search, in pairs of windows per second on one thread. It compares all windows of the tracks of
//! one scene with those of the other scenes, and includes the choice of the nearest and their `f64` distances. The
//! tracks are real if `DDL_DATASETS` names their folder, otherwise synthetic; the names of the benchmarks say which.

#[path = "../tests/recorded/mod.rs"]
mod recorded;
#[path = "../tests/walks/mod.rs"]
mod walks;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use ddl_softdtw::{Cost, InstructionSet, SlidingIndex, SoftDtw};

/// Velocities of a complete window of 20 positions.
const COMPLETE: usize = 19;
const QUERIES: usize = 30;

fn sliding(criterion: &mut Criterion) {
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean).expect("valid gamma");
    let synthetic = || [400, 1_800].map(|count| walks::Numbers(count).pedestrians(count as usize, 60));
    let (source, [queries, tracks]) = match recorded::dataset() {
        Some(dataset) => ("real", recorded::split(&dataset, &["eth"])),
        None => ("synthetic", synthetic()),
    };
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let one_thread = one_thread.expect("a thread");
    let mut group = criterion.benchmark_group(format!("sliding, {source} tracks"));
    group.sample_size(20);
    for length in [7, 8] {
        // Only windows that the rest of a complete window follows, in the index and in the queries.
        let tail = COMPLETE - length;
        let index = SlidingIndex::build(&dtw, &tracks, length, tail).expect("valid");
        let queries = queries.iter().filter(|track| track.len() >= COMPLETE);
        let queries: Vec<_> = queries.map(|track| &track[..track.len() - tail]).collect();
        let every = queries.len().div_ceil(QUERIES);
        let queries: Vec<_> = queries.into_iter().step_by(every).collect();
        let windows: usize = queries.iter().map(|query| query.len() + 1 - length).sum();
        for set in InstructionSet::available() {
            let index = index.clone().with_instruction_set(set).expect("available");
            for n in [100, 1] {
                group.throughput(Throughput::Elements((index.len() * windows) as u64));
                let name = BenchmarkId::new(format!("{length} steps, nearest {n}"), set);
                group.bench_function(name, |b| {
                    let search = || {
                        for query in &queries {
                            black_box(index.nearest_windows(query, n)).expect("valid");
                        }
                    };
                    one_thread.install(|| b.iter(search));
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, sliding);
criterion_main!(benches);
