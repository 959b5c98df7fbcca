//! Makes the sample recording of this repository, a part of a simulated crowd:
//!
//! ```text
//! cargo run -p ddl-data --example sample_recording > datasets/sample.csv
//! ```
#![expect(clippy::print_stdout, reason = "what it is for")]

use ddl_data::{DataError, Dataset, PedestrianId};

const SEED: u64 = 1;
/// Steps of 0.4 s that are kept.
const STEPS: std::ops::Range<i64> = 205..259;

fn main() -> Result<(), DataError> {
    let dataset = Dataset::simulated(SEED);
    let crowd = dataset.recording("plaza")?;
    let rows = crowd.observations().iter().filter_map(|seen| {
        let step = seen.frame / crowd.frame_step();
        STEPS.contains(&step).then_some((step - STEPS.start, seen))
    });
    let mut pedestrians: Vec<PedestrianId> = Vec::new();
    println!("frame,pedestrian,x,y");
    for (step, seen) in rows {
        let index = pedestrians.iter().position(|&id| id == seen.pedestrian);
        let number = index.unwrap_or_else(|| {
            pedestrians.push(seen.pedestrian);
            pedestrians.len() - 1
        });
        let [x, y] = seen.position;
        println!("{step},{},{x:.2},{y:.2}", number + 1);
    }
    Ok(())
}
