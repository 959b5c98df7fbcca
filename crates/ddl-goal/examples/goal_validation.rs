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

use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams, QuerySpan};

use crate::star_files::{RECORDINGS, StarTracks};

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

/// The complete windows of one recording: all 20 steps of one pedestrian from every start.
struct ValidationRecording {
    name: &'static str,
    /// First frame, and how many frames later the last one is.
    span: (i64, i64),
    /// First and last frame of a window, and its positions (m).
    windows: Vec<(i64, i64, Positions)>,
}

type Positions = Vec<[f64; 2]>;

impl ValidationRecording {
    fn read(folder: &Path, name: &'static str) -> Result<Self, Box<dyn Error>> {
        let tracks = StarTracks::read(folder, name)?;
        let frames = || tracks.by_pedestrian.values().flat_map(BTreeMap::keys);
        let span = frames().min().zip(frames().max());
        let (&first, &last) = span.ok_or_else(|| format!("{name}.csv is empty"))?;
        let windows = tracks.complete_windows().into_iter();
        let windows = windows.map(|((start, _), track)| (start, start + 19 * tracks.step, track));
        Ok(Self {
            name,
            span: (first, last - first),
            windows: windows.collect(),
        })
    }

    /// The windows that lie in a part of the recording's time, by start and end.
    fn within(&self, part: impl Fn(f64, f64) -> bool) -> impl Iterator<Item = &Positions> {
        let (first, length) = self.span;
        let share = move |frame: i64| (frame - first) as f64 / length as f64;
        let windows = self.windows.iter();
        windows
            .filter(move |(start, end, _)| part(share(*start), share(*end)))
            .map(|(.., track)| track)
    }
}

/// Sums over validation walkers.
#[derive(Default)]
struct Judged {
    walkers: usize,
    seconds: f64,
    log_loss: f64,
}

impl Judged {
    /// Mean over recordings of the mean distance from the nearest goal to the true end (m).
    fn mean_error(
        &mut self,
        estimator: &GoalEstimator,
        recordings: &[Vec<&Positions>],
    ) -> Result<f64, Box<dyn Error>> {
        let start = Instant::now();
        let mut sum = 0.0;
        for walkers in recordings {
            let observed: Vec<&[[f64; 2]]> = walkers.iter().map(|track| &track[..8]).collect();
            let sets = estimator.estimate_batch(&observed)?;
            for (goals, track) in sets.iter().zip(walkers) {
                // A goal of no weight would cost infinitely much.
                let weight = goals.weights()[goals.nearest(track[19])].max(1e-4);
                self.log_loss -= weight.ln();
                sum += star_files::goal_error(goals, track)
                    / (walkers.len() * recordings.len()) as f64;
            }
            self.walkers += walkers.len();
        }
        self.seconds += start.elapsed().as_secs_f64();
        Ok(sum)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::var("DDL_DATASETS")
        .map_err(|_| "set DDL_DATASETS to the folder of the recordings (eth.csv, ...)")?;
    let stride: usize = std::env::args().nth(1).map_or(Ok(1), |n| n.parse())?;
    let recordings = RECORDINGS
        .iter()
        .map(|name| ValidationRecording::read(Path::new(&folder), name))
        .collect::<Result<Vec<_>, _>>()?;
    let published = GoalEstimatorParams::published().query(QuerySpan::Observed);
    for (name, params) in [
        ("published, without the future", published),
        ("default", GoalEstimatorParams::default()),
    ] {
        println!("{name}\nfold    unseen  tails   mean");
        let (mut total, mut judged) = ([0.0; 2], Judged::default());
        for (fold, test) in FOLDS {
            let every =
                |windows: &mut dyn Iterator<Item = _>| windows.step_by(stride.max(1)).collect();
            let (unseen, others): (Vec<_>, Vec<_>) = recordings
                .iter()
                .partition(|recording| UNSEEN.contains(&recording.name));
            let unseen: Vec<Vec<_>> = unseen
                .iter()
                .map(|recording| every(&mut recording.within(|_, _| true)))
                .collect();
            let training = || {
                others
                    .iter()
                    .filter(|recording| !test.contains(&recording.name))
            };
            let tails: Vec<Vec<_>> = training()
                .map(|recording| every(&mut recording.within(|start, _| start > LIBRARY_SHARE)))
                .collect();
            let library =
                training().flat_map(|recording| recording.within(|_, end| end <= LIBRARY_SHARE));
            let library = ExpertLibrary::new(library.cloned().collect(), 0.4)?;
            let estimator = GoalEstimator::new(params.clone().check()?, library)?;
            let unseen = judged.mean_error(&estimator, &unseen)?;
            let tails = judged.mean_error(&estimator, &tails)?;
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
        println!("{} walkers in {:.1} s", judged.walkers, judged.seconds);
        let log_loss = judged.log_loss / judged.walkers as f64;
        println!("log loss {log_loss:.3}, uniform {:.3}\n", 20_f64.ln());
    }
    Ok(())
}
