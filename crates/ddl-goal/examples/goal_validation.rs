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

const RECORDINGS: [&str; 8] = [
    "eth",
    "hotel",
    "zara01",
    "zara02",
    "zara03",
    "students001",
    "students003",
    "uni_examples",
];
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
    first: f64,
    last: f64,
    /// First frame, last frame and positions (m).
    windows: Vec<(f64, f64, Track)>,
}

impl Recording {
    /// Reads four lines: frame, pedestrian, y (m), x (m).
    fn read(folder: &Path, name: &'static str) -> Result<Self, Box<dyn Error>> {
        let text = std::fs::read_to_string(folder.join(format!("{name}.csv")))?;
        let mut lines = Vec::new();
        for line in text.lines() {
            let numbers: Result<Vec<f64>, _> = line.split(',').map(|f| f.trim().parse()).collect();
            lines.push(numbers?);
        }
        let [frames, pedestrians, ys, xs] = lines.as_slice() else {
            return Err(format!("{name}.csv: {} lines, 4 expected", lines.len()).into());
        };
        let mut tracks: BTreeMap<i64, BTreeMap<i64, [f64; 2]>> = BTreeMap::new();
        for ((frame, pedestrian), (y, x)) in frames.iter().zip(pedestrians).zip(ys.iter().zip(xs)) {
            let track = tracks.entry(*pedestrian as i64).or_default();
            track.insert(*frame as i64, [*x, *y]);
        }
        let step = if name == "eth" { 6 } else { 10 };
        let mut windows = Vec::new();
        for track in tracks.values() {
            for &start in track.keys() {
                let positions: Option<Track> = (0..20)
                    .map(|i| track.get(&(start + i * step)).copied())
                    .collect();
                let end = (start + 19 * step) as f64;
                windows.extend(positions.map(|positions| (start as f64, end, positions)));
            }
        }
        Ok(Self {
            name,
            first: frames.iter().copied().fold(f64::INFINITY, f64::min),
            last: frames.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            windows,
        })
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
        let windows = &recording.windows;
        if UNSEEN.contains(&recording.name) {
            unseen.push(windows.iter().map(|w| &w.2).step_by(stride).collect());
        } else if !test.contains(&recording.name) {
            let cut = recording.first + LIBRARY_SHARE * (recording.last - recording.first);
            let early = windows.iter().filter(|w| w.1 <= cut);
            library.extend(early.map(|w| w.2.clone()));
            let late = windows.iter().filter(|w| w.0 > cut);
            tails.push(late.map(|w| &w.2).step_by(stride).collect());
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
fn goal_error(
    estimator: &GoalEstimator,
    recordings: &[Vec<&Track>],
    calibration: &mut Calibration,
) -> Result<f64, Box<dyn Error>> {
    let mut sum = 0.0;
    for walkers in recordings {
        let observed: Vec<&[[f64; 2]]> = walkers.iter().map(|track| &track[..8]).collect();
        let sets = estimator.estimate_batch(&observed)?;
        for (goals, track) in sets.iter().zip(walkers) {
            let nearest = goals.nearest(track[19]);
            calibration.add(goals, nearest);
            let [x, y] = goals.goals()[nearest];
            sum += (x - track[19][0]).hypot(y - track[19][1])
                / (walkers.len() * recordings.len()) as f64;
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
            let unseen = goal_error(&estimator, &split.unseen, &mut calibration)?;
            let tails = goal_error(&estimator, &split.tails, &mut calibration)?;
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
