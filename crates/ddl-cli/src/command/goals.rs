//! `ddl goals`: goals of pedestrians, and their quality.

use crate::command::{Machine, ModelChoice, Telling, convention_of, dataset};
use crate::output::{table_metres, write_output};
use crate::tracks::{TrackOptions, tell_what_was_estimated};
use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use ddl::data::{FrameNumber, OBSERVED, PedestrianName};
use ddl::goal::GoalSet;
use ddl::{GoalEvaluation, Remembering, Split};
use serde::Serialize;
use std::path::PathBuf;

/// Estimate the goals of the pedestrians in your own tracks
///
/// Writes csv; with --measure it evaluates a model's goals instead.
#[derive(Debug, Args)]
#[command(mut_arg("progress", |arg| arg.help(crate::command::NO_PROGRESS)))]
#[command(after_help = "Examples:\n  ddl goals tracks.csv\n  ddl goals --model runs/eth --measure test")]
pub(crate) struct Goals {
    #[command(flatten)]
    model: ModelChoice,
    #[command(flatten)]
    tracks: TrackOptions,
    /// Compare the goals with the true endpoints in the scene that the model was trained without, or in your own
    /// recordings (--data)
    #[arg(long, value_enum, conflicts_with_all = ["file", "last", "whole"])]
    measure: Option<Measure>,
    /// Memory of the place to use for --measure
    #[arg(long, value_enum, requires = "measure")]
    memory: Option<MemoryOption>,
    /// Recordings to evaluate on: the folder of the model's convention, or your own folder or file [default:
    /// `$DDL_DATASETS`, then `datasets/eth_ucy`]
    #[arg(long, requires = "measure")]
    data: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
    /// File to write [default: standard output]
    #[arg(long, short)]
    output: Option<PathBuf>,
    #[command(flatten)]
    machine: Machine,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Measure {
    /// The scene left out of training
    Test,
    /// The validation part
    Validation,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MemoryOption {
    /// Training recordings of the same place, whether confirmed to help or not
    Place,
    /// The recording before the last observed frame, as in the protocol `online`
    Online,
}

#[derive(Serialize)]
struct GoalRow {
    observed_until: FrameNumber,
    pedestrian: PedestrianName,
    goal: usize,
    weight: f64,
    x: f64,
    y: f64,
    unseen: usize,
    age: f64,
    uncertainty: f64,
}

impl Goals {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        if self.measure.is_none() && (self.telling.json || self.data.is_some()) {
            bail!("--json and --data need --measure test or --measure validation");
        }
        let tracks = &self.tracks;
        let text = match self.measure {
            Some(measure) => self.measure(measure)?,
            None if tracks.are_named() => {
                if tracks.are_live() {
                    bail!(
                        "goals are estimated for a file of tracks; for live tracks, `ddl forecast - --format jsonl` \
                         prints the goals"
                    );
                }
                self.machine.prepare_for_little()?;
                let model = self.model.load_goals(self.machine.device)?;
                let (observed, _) = tracks.observed(model.config())?;
                let goals = model.goals(&observed.windows)?;
                let text = csv(&observed, &goals)?;
                tell_what_was_estimated(&observed);
                text
            }
            None => bail!("give a file of TRACKS to estimate goals for, or --measure test"),
        };
        write_output(self.output.as_deref(), &text)
    }

    fn measure(&self, measure: Measure) -> anyhow::Result<String> {
        self.machine.prepare()?;
        let model = self.model.load_goals(self.machine.device)?;
        let data = self.data.as_deref();
        let convention = convention_of(data, model.config().data.convention);
        let units = self.tracks.units.or_those_of(model.config());
        let dataset = dataset(convention, data, &units)?;
        let on = match measure {
            Measure::Test => Split::Test,
            Measure::Validation => Split::Validation,
        };
        let memory = self.memory.map(|memory| match memory {
            MemoryOption::Place => Remembering::Place,
            MemoryOption::Online => Remembering::Online,
        });
        let evaluation = ddl::evaluate_goals(&model, &dataset, on, memory)?;
        Ok(if self.telling.json {
            serde_json::to_string_pretty(&evaluation)? + "\n"
        } else {
            words(&evaluation)
        })
    }
}

fn csv(observed: &ddl::ObservedTracks, sets: &[Vec<GoalSet>]) -> anyhow::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (window, sets) in observed.windows.iter().zip(sets) {
        let last = observed.clock.number(window.frames()[OBSERVED - 1]);
        for (i, set) in sets.iter().enumerate() {
            let quality = window.quality(i);
            for (goal, (position, weight)) in set.goals().iter().zip(set.weights()).enumerate() {
                let [x, y] = position.map(table_metres);
                writer.serialize(GoalRow {
                    observed_until: last,
                    pedestrian: window.name(i),
                    goal,
                    weight: *weight,
                    x,
                    y,
                    unseen: quality.unseen,
                    age: table_metres(quality.age),
                    uncertainty: table_metres(quality.uncertainty()),
                })?;
            }
        }
    }
    let bytes = writer.into_inner().context("cannot finish the csv")?;
    Ok(String::from_utf8(bytes)?)
}

fn words(evaluation: &GoalEvaluation) -> String {
    let mut lines = vec![
        format!(
            "fold {}, {} goals per pedestrian, {}",
            evaluation.fold, evaluation.clusters, evaluation.goals
        ),
        evaluation.windows.clone(),
        format!(
            "{:14} {:>18}  {:>20}  {:>14}",
            "recording", "pedestrian-windows", "nearest goal off (m)", "likeliest (m)"
        ),
    ];
    let errors_of_all = ("all".to_owned(), evaluation.all);
    let by_recording = evaluation.recordings.iter().map(|(n, e)| (n.clone(), *e));
    for (name, errors) in by_recording.chain([errors_of_all]) {
        lines.push(format!(
            "{name:14} {:>18}  {:>20.3}  {:>14.3}",
            errors.pedestrians, errors.oracle_fde, errors.likeliest_fde
        ));
    }
    if let Some(calibration) = &evaluation.calibration {
        lines.push(format!(
            "probabilities: log loss {:.3} (equal ones {:.3}), calibration error {:.4}",
            calibration.log_loss, calibration.uniform_log_loss, calibration.expected_error
        ));
    }
    lines.push(format!("estimated in {:.2} s\n", evaluation.seconds));
    lines.join("\n")
}
