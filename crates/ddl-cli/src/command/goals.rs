//! `ddl goals`: the quality of goals.

use crate::command::{Machine, ModelChoice, Telling, convention_of, dataset};
use crate::output::write_output;
use crate::paths::OutputFile;
use crate::units::Units;
use clap::Args;
use ddl::{GoalEvaluation, Remembering, Split};
use std::path::PathBuf;

/// Compare the goals of a model with the true endpoints
///
/// The goals of your own tracks are columns of `ddl forecast`.
#[derive(Debug, Args)]
#[command(mut_arg("progress", |arg| arg.help(crate::command::NO_PROGRESS)))]
#[command(after_help = "Example:\n  ddl goals --model runs/eth --measure test")]
pub(crate) struct Goals {
    #[command(flatten)]
    model: ModelChoice,
    #[command(flatten)]
    units: Units,
    /// Where: test (the scene that the model was trained without, or your own recordings, --data) or validation (the
    /// validation part)
    #[arg(long)]
    measure: Split,
    /// Memory of the place to use: place (training recordings of the same place, whether confirmed to help or not) or
    /// online (the recording before the last observed frame, as in the protocol `online`)
    #[arg(long)]
    memory: Option<Remembering>,
    /// Recordings to evaluate on: the folder of the model's convention, or your own folder or file [default:
    /// `$DDL_DATASETS`, then `datasets/eth_ucy`]
    #[arg(long)]
    data: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
    /// File to write [default: standard output]
    #[arg(long, short, value_hint = clap::ValueHint::AnyPath)]
    output: Option<OutputFile>,
    #[command(flatten)]
    machine: Machine,
}

impl Goals {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        write_output(self.output.as_deref(), &self.measure()?)
    }

    fn measure(&self) -> anyhow::Result<String> {
        self.machine.prepare()?;
        let model = self.model.load_goals(self.machine.device)?;
        let data = self.data.as_deref();
        let convention = convention_of(data, model.config().data.convention);
        let units = self.units.or_those_of(model.config());
        let dataset = dataset(convention, data, &units)?;
        let evaluation = ddl::evaluate_goals(&model, &dataset, self.measure, self.memory)?;
        Ok(if self.telling.json { serde_json::to_string_pretty(&evaluation)? + "\n" } else { words(&evaluation) })
    }
}

fn words(evaluation: &GoalEvaluation) -> String {
    let mut lines = vec![
        format!("fold {}, {} goals per pedestrian, {}", evaluation.fold, evaluation.clusters, evaluation.goals),
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
