//! Goal error on validation pedestrians of the recordings, fold by fold: `cargo run --release --example
//! goal_validation`.
//!
//! `DDL_DATASETS` names the folder of the recordings. The library holds the first 75 % (by time) of a fold's training
//! recordings. Validation uses the pedestrians of the last 25 % (`tails`), and those of two recordings that are in no
//! library and that no fold tests (`unseen`). An argument n uses only every n-th pedestrian.
#![expect(clippy::print_stdout, reason = "a program that prints a table")]

use std::error::Error;
use std::time::Instant;

use ddl_data::{Recording, WindowRule};
use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams, QuerySpan};

#[path = "../tests/laws/star_files.rs"]
mod star_files;

/// Share of a recording's time that the library may hold.
const LIBRARY_SHARE: f64 = 0.75;

type Positions = Vec<[f64; 2]>;

/// The complete tracks (m) within a part of the recording's time, selected by start and end.
fn within(recording: &Recording, part: impl Fn(f64, f64) -> bool) -> Vec<Positions> {
    let frames = recording.frames();
    let (first, length) = (frames[0], frames[frames.len() - 1] - frames[0]);
    let share = |frame: i64| (frame - first) as f64 / length as f64;
    let windows = recording.windows(WindowRule::Complete);
    let inside = windows.iter().filter(|window| {
        let frames = window.frames();
        part(share(frames[0]), share(frames[19]))
    });
    star_files::tracks_of(inside).into_values().collect()
}

#[derive(Default)]
struct Judged {
    pedestrians: usize,
    seconds: f64,
    log_loss: f64,
}

impl Judged {
    fn mean_error(&mut self, estimator: &GoalEstimator, recordings: &[Vec<Positions>]) -> Result<f64, Box<dyn Error>> {
        let start = Instant::now();
        let mut sum = 0.0;
        for pedestrians in recordings {
            let observed: Vec<&[[f64; 2]]> = pedestrians.iter().map(|track| &track[..8]).collect();
            let sets = estimator.estimate_batch(&observed)?;
            for (goals, track) in sets.iter().zip(pedestrians) {
                // A goal of weight 0 would have an infinite log loss.
                let weight = goals.weights()[goals.nearest(track[19])].max(1e-4);
                self.log_loss -= weight.ln();
                sum += star_files::goal_error(goals, track) / (pedestrians.len() * recordings.len()) as f64;
            }
            self.pedestrians += pedestrians.len();
        }
        self.seconds += start.elapsed().as_secs_f64();
        Ok(sum)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let dataset = star_files::dataset()?;
    let stride: usize = std::env::args().nth(1).map_or(Ok(1), |n| n.parse())?;
    let every = |tracks: Vec<Positions>| tracks.into_iter().step_by(stride.max(1)).collect();
    let query = QuerySpan::Observed;
    let published = GoalEstimatorParams {
        query,
        ..GoalEstimatorParams::published()
    };
    for (name, params) in [
        ("published, without the future", published),
        ("default", GoalEstimatorParams::default()),
    ] {
        println!("{name}\nfold    unseen  tails   mean");
        let (mut total, mut judged) = ([0.0; 2], Judged::default());
        for fold in dataset.folds() {
            let fold = fold.with_validation_recordings(&["uni_examples", "zara03"].map(str::to_owned))?;
            let unseen = fold.validation_recordings().iter();
            let unseen: Vec<Vec<_>> = unseen.map(|r| every(within(r, |_, _| true))).collect();
            let training = || fold.training_recordings().iter();
            let tails: Vec<Vec<_>> = training()
                .map(|r| every(within(r, |start, _| start > LIBRARY_SHARE)))
                .collect();
            let library = training().flat_map(|r| within(r, |_, end| end <= LIBRARY_SHARE));
            let library = ExpertLibrary::new(library.collect(), 0.4)?;
            let estimator = GoalEstimator::new(params.clone(), library)?;
            let unseen = judged.mean_error(&estimator, &unseen)?;
            let tails = judged.mean_error(&estimator, &tails)?;
            println!(
                "{:<7} {unseen:.4}  {tails:.4}  {:.4}",
                fold.name(),
                f64::midpoint(unseen, tails)
            );
            total = [total[0] + unseen / 5.0, total[1] + tails / 5.0];
        }
        let [unseen, tails] = total;
        println!("mean    {unseen:.4}  {tails:.4}  {:.4}", f64::midpoint(unseen, tails));
        println!("{} pedestrians in {:.1} s", judged.pedestrians, judged.seconds);
        let log_loss = judged.log_loss / judged.pedestrians as f64;
        println!("log loss {log_loss:.3}, uniform {:.3}\n", 20_f64.ln());
    }
    Ok(())
}
