//! The published estimator on the real recordings, against what its own code returned.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use ddl_goal::{Expert, GoalEstimator, GoalEstimatorParams, QuerySpan};
use serde::Deserialize;

use crate::star_files::{RECORDINGS, StarTracks, StarWindows, goal_error};
use crate::tracks::estimator;

#[derive(Deserialize)]
struct PublishedGoals {
    pedestrians: Vec<PublishedPedestrian>,
}

#[derive(Deserialize)]
struct PublishedPedestrian {
    fold: String,
    recording: String,
    start_frame: i64,
    pedestrian: i64,
    distance_rank: BTreeMap<usize, f64>,
    goal_error_m: f64,
}

/// The folder of the recordings, or `None` (with the reason printed) where they may be absent.
fn folder() -> Option<PathBuf> {
    let found = std::env::var_os("DDL_DATASETS")
        .map(PathBuf::from)
        .and_then(|folder| {
            [folder.join("star"), folder]
                .into_iter()
                .find(|folder| folder.join("eth.csv").is_file())
        });
    if found.is_none() {
        let reason = "DDL_DATASETS does not name a folder with the recordings (eth.csv, ...)";
        assert!(std::env::var_os("CI").is_none(), "{reason}");
        println!("not compared with the published estimator: {reason}");
    }
    found
}

/// Those of the complete windows that the published code tests on: someone must be there at the start and 20 steps later,
/// and the start lies 20 raw frame numbers before the last.
fn published_windows(tracks: &StarTracks) -> StarWindows {
    let each = || tracks.by_pedestrian.values();
    let last = each().filter_map(|track| track.keys().last()).max();
    let last = *last.unwrap();
    let later = |start: i64| start + 20 * tracks.step;
    let starts: BTreeSet<i64> = each()
        .flat_map(|track| {
            let starts = track.keys();
            starts.filter(|&&start| track.contains_key(&later(start)))
        })
        .copied()
        .filter(|start| start + 20 <= last)
        .collect();
    let mut windows = tracks.complete_windows();
    windows.retain(|(start, _), _| starts.contains(start));
    windows
}

fn windows(folder: &Path, recording: &str) -> StarWindows {
    StarTracks::read(folder, recording)
        .unwrap()
        .complete_windows()
}

/// The published estimator with all complete windows of the other recordings as its library.
fn published(folder: &Path, test_recording: &str, experts: usize) -> GoalEstimator {
    let training = RECORDINGS.iter().filter(|&&name| name != test_recording);
    let tracks = training.flat_map(|name| windows(folder, name).into_values());
    let params = GoalEstimatorParams::published().experts(experts).seed(1);
    estimator(params, tracks.collect())
}

/// The published library lacks up to 256 random walkers of the last, incomplete batch and a few windows at the ends of
/// recordings. So a published distance is one of ours, at its own rank or a few ranks further on, never before.
#[test]
fn expert_distances_are_the_published_ones() {
    const FURTHER: usize = 8;
    let Some(folder) = folder() else { return };
    let reference: PublishedGoals =
        serde_json::from_str(include_str!("reference/goals.json")).expect("the fixture is JSON");
    assert_eq!(reference.pedestrians.len(), 100);
    for (fold, recording, tracks) in [("eth", "eth", 36_784), ("zara1", "zara01", 37_042)] {
        let estimator = published(&folder, recording, 100 + FURTHER);
        assert_eq!(estimator.library().len(), tracks);
        let windows = windows(&folder, recording);
        let (mut same_rank, mut compared) = (0, 0);
        let (mut error, mut published_error) = (0.0, 0.0);
        for walker in reference
            .pedestrians
            .iter()
            .filter(|walker| walker.fold == fold)
        {
            assert_eq!(walker.recording, recording);
            let track = &windows[&(walker.start_frame, walker.pedestrian)];
            let goals = estimator.estimate(track).unwrap();
            for (&rank, expected) in &walker.distance_rank {
                // The published distances are formed in f32 from values near 10 m²/s².
                let agrees = |expert: &Expert| (expert.distance - expected).abs() < 3e-6;
                let ranks = &goals.experts()[rank - 1..rank + FURTHER];
                assert!(
                    ranks.iter().any(agrees),
                    "{fold}, frame {}, pedestrian {}, expert {rank}: {expected} is not among {ranks:?}",
                    walker.start_frame,
                    walker.pedestrian
                );
                same_rank += usize::from(agrees(&ranks[0]));
                compared += 1;
            }
            error += goal_error(&goals, track) / 50.0;
            published_error += walker.goal_error_m / 50.0;
        }
        assert_eq!(compared, 200);
        assert!(
            same_rank > 120,
            "{fold}: only {same_rank} of 200 distances have their own rank"
        );
        // k-means draws other random numbers: single goals differ, their mean quality does not.
        assert!(
            (error - published_error).abs() < 0.04,
            "{fold}: {error} m, {published_error} m"
        );
    }
}

#[test]
fn the_mean_goal_error_of_a_test_scene_is_the_published_one() {
    let Some(folder) = folder() else { return };
    let estimator = published(&folder, "eth", 100);
    let windows: Vec<_> = published_windows(&StarTracks::read(&folder, "eth").unwrap())
        .into_values()
        .collect();
    assert_eq!(windows.len(), 2_511);
    let queries: Vec<&[[f64; 2]]> = windows.iter().map(Vec::as_slice).collect();
    let estimated = estimator.estimate_batch(&queries).unwrap();
    let errors = estimated
        .iter()
        .zip(&queries)
        .map(|(goals, track)| goal_error(goals, track));
    let mean = errors.sum::<f64>() / queries.len() as f64;
    assert!((mean - 0.548).abs() < 0.01, "{mean} m");
    println!("mean goal error of {} walkers: {mean:.4} m", queries.len());
}

/// The library and the walkers are of recordings that meet in no street: students, and shoppers elsewhere.
#[test]
fn in_their_own_frame_walkers_of_one_street_tell_about_those_of_another() {
    let Some(folder) = folder() else { return };
    let library: Vec<_> = windows(&folder, "students003").into_values().collect();
    let walkers = windows(&folder, "zara03").into_values().step_by(5);
    let walkers: Vec<_> = walkers.collect();
    let queries: Vec<&[[f64; 2]]> = walkers.iter().map(|track| &track[..8]).collect();
    let mean_error = |params: GoalEstimatorParams| {
        let estimator = estimator(params, library.clone());
        let estimated = estimator.estimate_batch(&queries).unwrap();
        let errors = estimated
            .iter()
            .zip(&walkers)
            .map(|(goals, track)| goal_error(goals, track));
        errors.sum::<f64>() / walkers.len() as f64
    };
    let world = mean_error(GoalEstimatorParams::published().query(QuerySpan::Observed));
    let own = mean_error(GoalEstimatorParams::default());
    println!(
        "{} walkers: {own:.4} m, {world:.4} m in the frame of the world",
        walkers.len()
    );
    assert!(own < 0.85 * world, "{own} m, {world} m");
}
