//! Refused input leaves the memory unchanged.

use ddl_core::PedestrianId;
use ddl_data::LiveTracks;
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
            (last + 6, vec![other, (id, here), (id, here)], "pedestrian 3 is in frame"),
            (last + 6, vec![other, (id, [f64::NAN, 0.0])], "is no position"),
            (last + 6, vec![other, (id, [0.0, f64::INFINITY])], "is no position"),
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
fn what_live_tracks_accept_is_accepted() {
    for x in [1e7, 1.1e7, -1e16, f64::MAX, f64::MIN] {
        let (mut tracks, mut memory) = (LiveTracks::new(), SceneMemory::new(1, 200).unwrap());
        for frame in 0..40 {
            let here = [if frame % 10 < 8 { 0.4 * frame as f64 } else { x }, 0.0];
            let pedestrians = [(PedestrianId(1), here)];
            assert_eq!(tracks.push(frame, pedestrians).is_ok(), memory.observe(frame, pedestrians).is_ok());
        }
        assert!(memory.recall(&[[x; 2]; 8], None, 2).is_empty());
    }
}

#[test]
fn a_memory_needs_a_step_and_a_capacity() {
    assert!(matches!(SceneMemory::new(0, 1), Err(MemoryError::Frame(_))));
    for capacity in [0, (1 << 18) + 1] {
        assert!(matches!(SceneMemory::new(1, capacity), Err(MemoryError::Capacity { .. })));
    }
    let mut memory = SceneMemory::new(1 << 31, 1 << 18).unwrap();
    memory.observe(1 - (1 << 53), [(PedestrianId(1), [0.0; 2])]).unwrap();
    memory.observe((1 << 53) - 1, []).unwrap();
    assert_eq!(memory.segments(), 0);
}
