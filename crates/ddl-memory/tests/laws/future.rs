//! Answers never contain unobserved data.

use crate::{Frames, frames, memory_of, queries};
use ddl_data::{PedestrianId, RememberedTrack, WINDOW};
use ddl_memory::SceneMemory;

/// The same frames with other positions from an index on.
fn with_noise_from(frames: &Frames, from: usize) -> Frames {
    let mut noisy = frames.clone();
    for (index, (frame, pedestrians)) in noisy.iter_mut().enumerate().skip(from) {
        for (id, position) in pedestrians {
            let noise = ((*frame * 31 + id.0 * 17) % 23) as f64 - 11.0 + index as f64 * 0.01;
            *position = [position[0] + noise, noise];
        }
    }
    noisy
}

fn answers(memory: &SceneMemory, now: &Frames) -> Vec<Vec<RememberedTrack>> {
    let queries = queries(now).into_iter();
    queries
        .map(|(id, observed)| memory.recall(&observed, Some(id), 12))
        .collect()
}

/// Whether the recall of a memory after the frames before `end` depends on a later frame or contains one. `fed` creates
/// the memory.
fn sees_the_future(fed: impl Fn(&Frames, usize) -> SceneMemory, frames: &Frames, end: usize) -> bool {
    let now = frames[..end].to_vec();
    let recalled = answers(&fed(frames, end), &now);
    let was_seen = |person: PedestrianId, track: &[[f64; 2]; WINDOW]| {
        now.windows(WINDOW).any(|window| {
            let mut pairs = window.iter().zip(track);
            pairs.all(|((_, pedestrians), position)| pedestrians.contains(&(person, *position)))
        })
    };
    let examples = recalled.iter().flatten();
    let mut pedestrians = now.iter().flat_map(|(_, pedestrians)| pedestrians);
    let mut ids: Vec<PedestrianId> = pedestrians.by_ref().map(|(id, _)| *id).collect();
    ids.sort_unstable();
    ids.dedup();
    let mut tracks = examples.map(|example| &example.track);
    let shows = tracks.any(|track| !ids.iter().any(|id| was_seen(*id, track)));
    shows || answers(&fed(&with_noise_from(frames, end), end), &now) != recalled
}

#[test]
fn a_memory_does_not_see_the_future() {
    let (mut noticed, mut examples) = (0, 0);
    for seed in 0..8 {
        let frames = frames(seed, 12, 90, 5);
        let mut grown = memory_of(&frames[..25].to_vec(), 500);
        for end in (30..85).step_by(5) {
            for (frame, pedestrians) in &frames[end - 5..end] {
                grown.observe(*frame, pedestrians.clone()).unwrap();
            }
            let honest = |frames: &Frames, end: usize| memory_of(&frames[..end].to_vec(), 500);
            assert!(!sees_the_future(honest, &frames, end), "seed {seed}, {end}");
            // A memory that is one frame (0.4 s) ahead.
            let ahead = |frames: &Frames, end: usize| memory_of(&frames[..=end].to_vec(), 500);
            noticed += usize::from(sees_the_future(ahead, &frames, end));
            let recalled = answers(&honest(&frames, end), &frames[..end].to_vec());
            assert_eq!(answers(&grown, &frames[..end].to_vec()), recalled);
            examples += recalled.iter().map(Vec::len).sum::<usize>();
        }
    }
    assert!(noticed > 60, "{noticed} of 88 memories that are ahead were detected");
    assert!(examples > 1_000, "only {examples} examples");
}
