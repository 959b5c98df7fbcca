//! Goal error on validation walkers of the recordings, fold by fold: `cargo run --release --example goal_validation`.
//!
//! `DDL_DATASETS` names the folder of the recordings (eth.csv, ...). No walker of a fold's test scene is looked at: the
//! library holds the first 75 % (by time) of the fold's training recordings, the validation walkers are those of their
//! last 25 % (`tails`) and of two recordings that no library holds and no fold tests (`unseen`). An argument n takes every
//! n-th validation walker only.
#![expect(clippy::print_stdout, reason = "a program that prints a table")]

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams, GoalSet, QuerySpan};

use crate::star_files::{RECORDINGS, Tracks, Windows};

#[path = "../tests/laws/star_files.rs"]
mod star_files;

const UNSEEN: [&str; 2] = ["uni_examples", "zara03"];
const FOLDS: [(&str, &[&str]); 5] = [
    ("eth", &["eth"]),
    ("hotel", &["hotel"]),
    ("univ", &["students001", "students003"]),
    ("zara1", &["zara01"]),
    ("zara2", &["zara02"]),
];
/// Share of a recording's time that the library may hold.
const LIBRARY_SHARE: f64 = 0.75;
const BINS: usize = 10;

type Track = Vec<[f64; 2]>;

/// The windows of one recording: all 20 steps of one pedestrian from every start.
struct Recording {
    name: &'static str,
    step: i64,
    /// First and last frame.
    span: (i64, i64),
    windows: Windows,
}

impl Recording {
    fn read(folder: &Path, name: &'static str) -> Result<Self, Box<dyn Error>> {
        let tracks = Tracks::read(folder, name)?;
        let frames = || tracks.by_pedestrian.values().flat_map(BTreeMap::keys);
        let span = frames().min().zip(frames().max());
        let (first, last) = span.ok_or_else(|| format!("{name}.csv is empty"))?;
        Ok(Self {
            name,
            step: tracks.step,
            span: (*first, *last),
            windows: tracks.complete_windows(),
        })
    }

    /// The windows that start in a part of the recording's time, by start and end.
    fn within(&self, part: impl Fn(f64, f64) -> bool) -> impl Iterator<Item = &Track> {
        let (first, last) = self.span;
        let share = move |frame: i64| (frame - first) as f64 / (last - first) as f64;
        let windows = self.windows.iter();
        let within = windows
            .filter(move |((start, _), _)| part(share(*start), share(*start + 19 * self.step)));
        within.map(|(_, track)| track)
    }
}

/// What a fold may learn from, and the walkers it is judged by: recording, its windows.
struct Split<'a> {
    library: Vec<Track>,
    unseen: Vec<Vec<&'a Track>>,
    tails: Vec<Vec<&'a Track>>,
}

fn split<'a>(recordings: &'a [Recording], test: &[&str], stride: usize) -> Split<'a> {
    let (mut library, mut unseen, mut tails) = (Vec::new(), Vec::new(), Vec::new());
    for recording in recordings {
        if UNSEEN.contains(&recording.name) {
            unseen.push(recording.windows.values().step_by(stride).collect());
        } else if !test.contains(&recording.name) {
            library.extend(recording.within(|_, end| end <= LIBRARY_SHARE).cloned());
            let late = recording.within(|start, _| start > LIBRARY_SHARE);
            tails.push(late.step_by(stride).collect());
        }
    }
    Split {
        library,
        unseen,
        tails,
    }
}

/// How often goals of a weight were the nearest ones.
#[derive(Default)]
struct Calibration {
    /// Number of goals, sum of weights, number of hits; by weight.
    bins: [[f64; 3]; BINS],
    log_loss: f64,
    walkers: f64,
}

impl Calibration {
    fn add(&mut self, goals: &GoalSet, nearest: usize) {
        for (k, &weight) in goals.weights().iter().enumerate() {
            // Bins of 0.02; few goals weigh more than the last begins with.
            let bin = &mut self.bins[((weight * 50.0) as usize).min(BINS - 1)];
            *bin = [
                bin[0] + 1.0,
                bin[1] + weight,
                bin[2] + f64::from(u8::from(k == nearest)),
            ];
        }
        // A goal of no weight would cost infinitely much.
        self.log_loss -= goals.weights()[nearest].max(1e-4).ln();
        self.walkers += 1.0;
    }

    fn print(&self) {
        println!(
            "log loss {:.3}, uniform {:.3}",
            self.log_loss / self.walkers,
            20_f64.ln()
        );
        for (i, [count, weights, hits]) in self.bins.iter().enumerate() {
            let from = 0.02 * i as f64;
            println!(
                "weight from {from:.2}: {count:>7} goals, mean weight {:.4}, nearest {:.4}",
                weights / count,
                hits / count
            );
        }
    }
}

/// Mean over recordings of the mean distance from the nearest goal to the true end (m).
fn mean_error(
    estimator: &GoalEstimator,
    recordings: &[Vec<&Track>],
    calibration: &mut Calibration,
) -> Result<f64, Box<dyn Error>> {
    let mut sum = 0.0;
    for walkers in recordings {
        let observed: Vec<&[[f64; 2]]> = walkers.iter().map(|track| &track[..8]).collect();
        let sets = estimator.estimate_batch(&observed)?;
        for (goals, track) in sets.iter().zip(walkers) {
            calibration.add(goals, goals.nearest(track[19]));
            sum += star_files::goal_error(goals, track) / (walkers.len() * recordings.len()) as f64;
        }
    }
    Ok(sum)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::var("DDL_DATASETS")
        .map_err(|_| "set DDL_DATASETS to the folder of the recordings (eth.csv, ...)")?;
    let stride: usize = std::env::args().nth(1).map_or(Ok(1), |n| n.parse())?;
    let recordings = RECORDINGS
        .iter()
        .map(|name| Recording::read(Path::new(&folder), name))
        .collect::<Result<Vec<_>, _>>()?;
    let published = GoalEstimatorParams::published().query(QuerySpan::Observed);
    for (name, params) in [
        ("published, without the future", published),
        ("default", GoalEstimatorParams::default()),
    ] {
        println!("{name}\nfold    unseen  tails   mean");
        let (mut total, mut calibration) = ([0.0; 2], Calibration::default());
        let (mut seconds, mut walkers) = (0.0, 0);
        for (fold, test) in FOLDS {
            let split = split(&recordings, test, stride.max(1));
            let library = ExpertLibrary::new(split.library, 0.4)?;
            let estimator = GoalEstimator::new(params.clone().check()?, library)?;
            let start = Instant::now();
            let unseen = mean_error(&estimator, &split.unseen, &mut calibration)?;
            let tails = mean_error(&estimator, &split.tails, &mut calibration)?;
            seconds += start.elapsed().as_secs_f64();
            walkers += split
                .unseen
                .iter()
                .chain(&split.tails)
                .map(Vec::len)
                .sum::<usize>();
            println!(
                "{fold:<7} {unseen:.4}  {tails:.4}  {:.4}",
                f64::midpoint(unseen, tails)
            );
            total = [total[0] + unseen / 5.0, total[1] + tails / 5.0];
        }
        let [unseen, tails] = total;
        println!(
            "mean    {unseen:.4}  {tails:.4}  {:.4}",
            f64::midpoint(unseen, tails)
        );
        println!("{walkers} walkers in {seconds:.1} s");
        calibration.print();
        println!();
    }
    Ok(())
}
