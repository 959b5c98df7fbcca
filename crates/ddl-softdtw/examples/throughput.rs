//! Time per pair (query × candidate) of the search for the 100 nearest: one query at a time on one thread, and in a
//! batch.
//!
//! ```text
//! cargo run --release --example throughput -- [steps] [queries] [portable|avx2|avx512]
//! ```
//! To count the instructions per pair, run the program with two numbers of queries (`perf stat -e instructions:u`, or
//! `valgrind --tool=callgrind` without AVX-512). Divide the difference of the instructions by the difference of the
//! numbers of pairs.
#![expect(clippy::print_stdout, reason = "what it is for")]

#[path = "../benches/recordings/mod.rs"]
mod recordings;

use std::time::Instant;

use ddl_softdtw::{Cost, InstructionSet, SearchIndex, SoftDtw};
use recordings::Windows;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: usize| match arguments.get(i) {
        Some(text) => text.parse(),
        None => Ok(default),
    };
    let (steps, count) = (number(0, 8)?, number(1, 200)?);
    let sets = match arguments.get(2).map(String::as_str) {
        None => InstructionSet::available(),
        Some("portable") => vec![InstructionSet::Portable],
        Some("avx2") => vec![InstructionSet::Avx2],
        Some("avx512") => vec![InstructionSet::Avx512],
        Some(other) => return Err(format!("{other}: portable, avx2 or avx512").into()),
    };
    let windows = Windows::load(steps);
    let queries = windows.some_queries(count);
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean)?;
    let index = SearchIndex::build(&dtw, &windows.candidates)?;
    let pairs = (queries.len() * index.len()) as f64;
    println!(
        "{} windows of {steps} steps: {} queries x {} candidates",
        windows.source,
        queries.len(),
        index.len()
    );
    for set in sets {
        let index = index.clone().with_instruction_set(set)?;
        let mut times = Vec::new();
        for query in &queries {
            let start = Instant::now();
            index.nearest(query, 100)?;
            times.push(start.elapsed().as_secs_f64());
        }
        times.sort_by(f64::total_cmp);
        let quantile = |tenths: usize| times[times.len() * tenths / 10] / index.len() as f64 * 1e9;
        let start = Instant::now();
        index.nearest_batch(&queries, 100)?;
        println!(
            "{set}: {:.2} ns a pair (fastest query), {:.2} (median), {:.2} (mean), {:.2} (a batch on {} threads)",
            quantile(0),
            quantile(5),
            times.iter().sum::<f64>() / pairs * 1e9,
            start.elapsed().as_secs_f64() / pairs * 1e9,
            rayon::current_num_threads(),
        );
    }
    Ok(())
}
