//! Refused input leaves the memory unchanged.

use ddl_data::{LiveTracks, PedestrianId};
use ddl_memory::{MemoryError, SceneMemory};

#[test]
fn errors_change_nothing() {
    let (id, here) = (PedestrianId(3), [1.0, 2.0]);
    let mut memory = SceneMemory::new(6, 50).unwrap();
    for last in (0..180).step_by(6) {
        memory.observe(last, [(id, here)]).unwrap();
        let before = memory.clone();
        let other = (PedestrianId(1), here);
        for (frame, pedestrians, problem) in [
            (last, vec![], "comes after frame"),
            (last - 1, vec![other], "end those of the memory"),
            (i64::MIN, vec![other], "not below 2^53"),
            (1 << 53, vec![], "not below 2^53"),
            (
                last + 6,
                vec![other, (id, here), (id, here)],
                "pedestrian 3 is in frame",
            ),
            (last + 6, vec![other, (id, [f64::NAN, 0.0])], "not finite"),
            (last + 6, vec![other, (id, [0.0, f64::INFINITY])], "not finite"),
        ] {
            let error = memory.observe(frame, pedestrians).unwrap_err().to_string();
            assert!(error.contains(problem), "{error}");
            assert_eq!(memory, before);
        }
    }
    assert_eq!(memory.segments(), 11);
    memory.observe((1 << 53) - 1, [(id, [1e7, -1e7])]).unwrap();
}

/// A live forecast must not fail because of the memory.
#[test]
fn input_of_live_tracks_is_accepted() {
    let mut memory = SceneMemory::new(1, 200).unwrap();
    let mut tracks = LiveTracks::new();
    let far = [1.1e7, -1e16, f64::MAX, f64::MIN];
    for frame in 0..100 {
        let x = match frame {
            30 | 60.. => far[frame as usize % 4],
            _ => 0.4 * frame as f64,
        };
        let pedestrians = [(PedestrianId(1), [x, 0.0]), (PedestrianId(2), [0.0, frame as f64])];
        tracks.push(frame, pedestrians).unwrap();
        memory.observe(frame, pedestrians).unwrap();
    }
    // Frames 0 to 29 and 31 to 59 of the first pedestrian.
    assert_eq!(memory.summary().extent, Some([[0.0, 0.0], [23.6, 99.0]]));
    let observed = std::array::from_fn(|t| [0.4 * t as f64, 0.0]);
    assert!(memory.recall(&observed, None, 2)[0].distance < 1e-9);
    assert!(memory.recall(&[[f64::MAX, 0.0]; 8], None, 2).is_empty());
}

#[test]
fn a_memory_needs_a_step_and_a_capacity() {
    assert!(matches!(SceneMemory::new(0, 1), Err(MemoryError::Frame(_))));
    for capacity in [0, (1 << 18) + 1] {
        assert!(matches!(
            SceneMemory::new(1, capacity),
            Err(MemoryError::Capacity { .. })
        ));
    }
    let mut memory = SceneMemory::new(1 << 31, 1 << 18).unwrap();
    memory.observe(1 - (1 << 53), [(PedestrianId(1), [0.0; 2])]).unwrap();
    memory.observe((1 << 53) - 1, []).unwrap();
    assert_eq!(memory.segments(), 0);
}
