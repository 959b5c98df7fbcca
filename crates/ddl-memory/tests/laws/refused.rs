//! What is refused leaves the memory as it was.

use ddl_data::PedestrianId;
use ddl_memory::{MemoryError, SceneMemory};

#[test]
fn errors_change_nothing() {
    let (id, here) = (PedestrianId(3), [1.0, 2.0]);
    let mut memory = SceneMemory::new(6, 50).unwrap();
    for last in (0..180).step_by(6) {
        memory.observe(last, [(id, here)]).unwrap();
        let before = memory.clone();
        let other = (PedestrianId(1), here);
        for (frame, people, problem) in [
            (last, vec![], "comes after frame"),
            (last - 1, vec![other], "call `interrupt`"),
            (i64::MIN, vec![other], "not below 2^53"),
            (1 << 53, vec![], "not below 2^53"),
            (
                last + 6,
                vec![other, (id, here), (id, here)],
                "pedestrian 3 is in frame",
            ),
            (last + 6, vec![other, (id, [f64::NAN, 0.0])], "not finite"),
            (
                last + 6,
                vec![other, (id, [0.0, f64::INFINITY])],
                "not finite",
            ),
            (
                last + 6,
                vec![other, (id, [0.0, -1.1e7])],
                "use coordinates relative to a nearer origin",
            ),
        ] {
            let error = memory.observe(frame, people).unwrap_err().to_string();
            assert!(error.contains(problem), "{error}");
            assert_eq!(memory, before);
        }
    }
    assert_eq!(memory.stretches(), 11);
    memory.observe((1 << 53) - 1, [(id, [1e7, -1e7])]).unwrap();
}

#[test]
fn a_memory_needs_a_step_and_a_capacity() {
    for step in [0, -1, (1 << 31) + 1, i64::MIN] {
        let error = SceneMemory::new(step, 1);
        assert!(matches!(error, Err(MemoryError::FrameStep { found }) if found == step));
    }
    for capacity in [0, (1 << 18) + 1, usize::MAX] {
        let error = SceneMemory::new(1, capacity);
        assert!(matches!(error, Err(MemoryError::Capacity { found }) if found == capacity));
    }
    let mut memory = SceneMemory::new(1 << 31, 1 << 18).unwrap();
    memory
        .observe(1 - (1 << 53), [(PedestrianId(1), [0.0; 2])])
        .unwrap();
    memory.observe((1 << 53) - 1, []).unwrap();
    assert_eq!(memory.stretches(), 0);
}
