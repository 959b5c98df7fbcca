//! What a recording is said to hold, and what looks wrong with it.

use ddl_data::{Doubt, Observation, PedestrianId, Recording};

/// Somebody who walks along x at so many metres a frame, for 100 frames.
fn walk(metres_a_frame: f64) -> Vec<Observation> {
    (0..100)
        .map(|t| Observation::new(t, PedestrianId(1), [metres_a_frame * t as f64, 0.0]))
        .collect()
}

fn doubts(seen: Vec<Observation>) -> Vec<Doubt> {
    Recording::new("yard", 1, seen).unwrap().summary().doubts()
}

#[test]
fn speeds_that_nobody_walks_at_are_doubted() {
    // 1.3 m/s in steps of 0.4 s
    assert_eq!(doubts(walk(0.52)), []);
    // the same seen by a camera of 25 frames a second, and in pixels
    assert!(matches!(doubts(walk(0.052))[..], [Doubt::Slow { brisk }] if brisk < 0.14));
    assert!(matches!(doubts(walk(30.0))[..], [Doubt::Fast { median }] if median > 70.0));
    // who stands is not doubted, however slowly the tracker trembles
    assert_eq!(doubts(walk(0.001)), []);
}

#[test]
fn degrees_are_doubted() {
    // a walk through a park in degrees of latitude
    assert!(matches!(
        doubts(walk(5e-6))[..],
        [Doubt::Still { farthest }] if farthest < 1e-3
    ));
}

/// A camera of 25 frames a second whose tracker loses every tenth detection: the places of steps are gone with them.
#[test]
fn detections_that_drop_out_are_told() {
    let seen: Vec<Observation> = (0..1000)
        .flat_map(|t| {
            [1, 2].map(|id| Observation::new(t, PedestrianId(id), [0.05 * t as f64, id as f64]))
        })
        .filter(|seen| (seen.frame + 5 * seen.pedestrian.0) % 10 != 7)
        .collect();
    let summary = Recording::new("film", 10, seen).unwrap().summary();
    assert!((summary.unseen - 0.1).abs() < 0.002, "{}", summary.unseen);
    let [Doubt::Unseen { share }, ..] = summary.doubts()[..] else {
        panic!("{:?}", summary.doubts());
    };
    assert_eq!(share.to_bits(), summary.unseen.to_bits());
    let whole = Recording::new("yard", 1, walk(0.5)).unwrap().summary();
    assert_eq!(whole.unseen.to_bits(), 0.0_f64.to_bits());
}

#[test]
fn a_track_that_jumps_is_named_with_its_frame() {
    let mut seen = walk(0.5);
    for observation in &mut seen[40..] {
        observation.position[1] += 20.0;
    }
    let doubts = doubts(seen);
    let [Doubt::Jump(fastest)] = &doubts[..] else {
        panic!("{doubts:?}");
    };
    assert_eq!(
        (&fastest.pedestrian, fastest.frame),
        (&PedestrianId(1).into(), 40)
    );
    assert!(
        doubts[0]
            .to_string()
            .contains("pedestrian 1 jumps at frame 40")
    );
}

#[test]
fn holes_and_what_can_be_learned_from_are_counted() {
    let mut seen = walk(0.5);
    seen.remove(50);
    let summary = Recording::new("yard", 1, seen).unwrap().summary();
    assert_eq!(
        (summary.holes, summary.pedestrians, summary.frames),
        (1, 1, 99)
    );
    let hole = summary.longest_hole.unwrap();
    assert_eq!(
        (&hole.pedestrian, hole.after),
        (&PedestrianId(1).into(), 49)
    );
    assert!((hole.seconds - 0.8).abs() < 1e-12);
    // 50 and 49 positions in a row: 31 and 30 windows of 20
    assert_eq!(summary.to_learn_from, 61);
    let few = Recording::new("yard", 1, walk(0.5)[..12].to_vec()).unwrap();
    assert_eq!(few.summary().doubts(), [Doubt::NothingToLearnFrom]);
}
