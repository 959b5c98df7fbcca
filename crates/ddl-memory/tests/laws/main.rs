//! Properties of a scene memory for arbitrary crowds.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "../crowd/mod.rs"]
mod crowd;

mod capacity;
mod file;
mod recall;
mod refused;

use crowd::{Crowd, Pedestrians};
use ddl_core::{OBSERVED, PedestrianId, Position};
use ddl_memory::SceneMemory;
use proptest::prelude::*;

/// Frames with the pedestrians and positions in them.
type Frames = Vec<(i64, Pedestrians)>;

/// A crowd in which some pedestrians are missed occasionally, and ids are used again.
fn frames(seed: u64, pedestrians: usize, steps: usize, frame_step: i64) -> Frames {
    let mut crowd = Crowd::new(seed, pedestrians);
    let mut frame = |step: usize| {
        let mut seen = crowd.step();
        for (id, _) in &mut seen {
            id.0 %= 3 * pedestrians as i64;
        }
        seen.retain(|_| crowd.random() > 0.02);
        (step as i64 * frame_step, seen)
    };
    (0..steps).map(&mut frame).collect()
}

fn crowds() -> impl Strategy<Value = Frames> {
    let sizes = (any::<u64>(), 1..12_usize, 1..120_usize, 1..12_i64);
    sizes.prop_map(|(seed, pedestrians, steps, step)| frames(seed, pedestrians, steps, step))
}

fn step_of(frames: &Frames) -> i64 {
    frames.get(1).map_or(1, |(frame, _)| *frame)
}

fn memory_of(frames: &Frames, capacity: usize) -> SceneMemory {
    let mut memory = SceneMemory::new(step_of(frames), capacity).unwrap();
    for (frame, pedestrians) in frames {
        memory.observe(*frame, pedestrians.clone()).unwrap();
    }
    memory
}

/// The last 8 positions of the pedestrians in the last frame, as queries.
fn queries(frames: &Frames) -> Vec<(PedestrianId, [Position; OBSERVED])> {
    let last = &frames[frames.len().saturating_sub(OBSERVED)..];
    let place = |pedestrians: &Pedestrians, id| pedestrians.iter().find(|seen| seen.0 == id).map(|seen| seen.1);
    let query = |&(id, _): &(PedestrianId, Position)| {
        let observed: Option<Vec<Position>> = last.iter().map(|(_, seen)| place(seen, id)).collect();
        Some((id, observed?.try_into().ok()?))
    };
    last.last().map_or(Vec::new(), |(_, pedestrians)| pedestrians.iter().filter_map(query).collect())
}
