//! Simulated crowds are realistic: plausible speeds, no pedestrian in a wall.

use ddl_core::{Position, TIME_STEP, distance};

use crate::dataset::Dataset;
use crate::recording::Recording;
use crate::simulate::layout::{SCENES, SceneLayout};
use crate::simulate::obstacle::Segment;
use crate::simulate::vector::{cross, sub};

const SEED: u64 = 1;

struct SimulatedScene {
    scene: &'static str,
    layout: SceneLayout,
    recording: Recording,
}

fn crowds() -> impl Iterator<Item = SimulatedScene> {
    let recordings = Dataset::simulated(SEED).recordings().to_vec();
    SCENES.into_iter().zip(recordings).map(|((scene, layout), recording)| SimulatedScene {
        scene,
        layout: layout(),
        recording,
    })
}

/// Whether the straight line from `a` to `b` (m) crosses the wall.
fn is_blocked(wall: &Segment, a: Position, b: Position) -> bool {
    let (way, along) = (sub(b, a), sub(wall.b, wall.a));
    let side = |p| cross(along, sub(p, wall.a));
    let other = |p| cross(way, sub(p, a));
    side(a) * side(b) < 0.0 && other(wall.a) * other(wall.b) < 0.0
}

/// Successive positions of every pedestrian (m), 0.4 s apart.
fn tracks(crowd: &SimulatedScene) -> Vec<Vec<Position>> {
    let recording = &crowd.recording;
    recording.pedestrians().into_iter().map(|id| recording.track(id).iter().map(|o| o.position).collect()).collect()
}

/// Speed of every pedestrian between successive positions (m/s).
fn speeds(crowd: &SimulatedScene) -> Vec<f64> {
    let steps = |track: &Vec<Position>| track.windows(2).map(|w| distance(w[0], w[1]) / TIME_STEP).collect::<Vec<_>>();
    tracks(crowd).iter().flat_map(steps).collect()
}

fn share(count: usize, total: usize) -> f64 {
    count as f64 / total as f64
}

#[test]
fn a_seed_gives_the_same_bytes_and_another_seed_others() {
    let dataset = Dataset::simulated(SEED);
    assert_eq!(dataset, Dataset::simulated(SEED));
    let names: Vec<&str> = dataset.recordings().iter().map(Recording::name).collect();
    assert_eq!(names, dataset.fold_names());
    for (recording, other) in dataset.recordings().iter().zip(Dataset::simulated(SEED + 1).recordings()) {
        assert_ne!(recording.observations(), other.observations());
    }
}

#[test]
fn speeds_are_plausible() {
    for crowd in crowds() {
        let (scene, speeds) = (crowd.scene, speeds(&crowd));
        let walking: Vec<_> = speeds.iter().copied().filter(|&v| v > 0.4).collect();
        let mean = walking.iter().sum::<f64>() / walking.len() as f64;
        assert!((1.0..1.4).contains(&mean), "{scene}: mean of pedestrians {mean} m/s");
        let fastest = speeds.iter().copied().fold(0.0, f64::max);
        assert!(fastest < 2.7, "{scene}: {fastest} m/s");
        let standing = share(speeds.iter().filter(|&&v| v < 0.2).count(), speeds.len());
        assert!((0.005..0.3).contains(&standing), "{scene}: {standing} of all steps stand still");
    }
}

#[test]
fn no_pedestrian_crosses_an_obstacle_or_is_stuck() {
    for crowd in crowds() {
        let SimulatedScene { scene, layout, .. } = &crowd;
        for track in tracks(&crowd) {
            for pair in track.windows(2) {
                let blocked = layout.walls.iter().any(|wall| is_blocked(wall, pair[0], pair[1]));
                assert!(!blocked, "{scene}: {pair:?}");
            }
            for &place in &track {
                let mut pillars = layout.pillars.iter();
                let inside = pillars.any(|p| distance(p.centre, place) < p.radius);
                assert!(!inside, "{scene}: {place:?}");
            }
            // A pedestrian walks at most 30 m and rests once. One that takes longer than two minutes is stuck.
            let seconds = track.len() as f64 * TIME_STEP;
            assert!(seconds < 120.0, "{scene}: {seconds} s");
        }
    }
}

#[test]
fn bodies_hardly_overlap() {
    for crowd in crowds() {
        let scene = crowd.scene;
        let (mut pairs, mut close) = (0, 0);
        for &frame in crowd.recording.frames() {
            let pedestrians = crowd.recording.at(frame);
            for (i, one) in pedestrians.iter().enumerate() {
                for other in &pedestrians[..i] {
                    let gap = distance(one.position, other.position);
                    assert!(gap > 0.3, "{scene}: two centres {gap} m apart");
                    pairs += 1;
                    close += usize::from(gap < 0.38);
                }
            }
        }
        assert!(share(close, pairs) < 1e-3, "{scene}: {close} of {pairs} pairs overlap");
    }
}
