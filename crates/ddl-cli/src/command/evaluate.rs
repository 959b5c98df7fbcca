//! `ddl evaluate`.

mod forecasts;

use super::{Exactness, KeepClear, Machine, Telling, at_least_one, dataset};
use crate::interrupt::Interrupt;
use crate::progress::{Progress, ProgressMode};
use crate::result_lines;
use anyhow::bail;
use clap::Args;
use ddl::eval::Report;
use ddl::{Ddl, EvaluationRequest, EvaluationSplit, Protocol};
use forecasts::OtherProgram;
use std::path::{Path, PathBuf};

/// Measure a trained model on the scene left out of its training, or forecasts of another program, beside the baselines
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
        ddl evaluate --model runs/eth --protocol fair --protocol single\n  \
        ddl evaluate --forecasts mine.jsonl --fold zara1 --out results")]
pub(crate) struct Evaluate {
    /// Directory of the run
    #[arg(long, required_unless_present = "forecasts", conflicts_with_all = ["forecasts", "convention", "fold", "window_rule"])]
    model: Option<PathBuf>,
    #[command(flatten)]
    other: OtherProgram,
    /// Folder of the recordings [default: `$DDL_DATASETS`, then `datasets/eth_ucy`]
    #[arg(long)]
    data: Option<PathBuf>,
    /// published, fair or single; may be repeated
    #[arg(long = "protocol", default_values = ["fair", "single"])]
    protocols: Vec<Protocol>,
    /// Measure on the validation part of the training recordings instead of the test scene
    #[arg(long, conflicts_with = "forecasts")]
    validation: bool,
    /// Measure a seeded part of the test windows with about so many walkers by the widest window rule [default: all]
    #[arg(long, value_parser = at_least_one, conflicts_with = "forecasts")]
    test_walkers: Option<usize>,
    #[command(flatten)]
    clear: KeepClear,
    #[command(flatten)]
    machine: Machine,
    #[command(flatten)]
    exactness: Exactness,
    #[command(flatten)]
    telling: Telling,
}

impl Evaluate {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        match (&self.other.forecasts, &self.model) {
            (Some(file), _) => {
                let (data, commit) = (self.data.as_deref(), &self.telling.commit);
                let report = self.other.evaluate(file, &self.protocols, data, commit)?;
                self.tell(&report, &self.other.written())
            }
            (None, Some(run)) => self.measure(run),
            (None, None) => {
                bail!("give the --model to measure, or the --forecasts of another program")
            }
        }
    }

    fn measure(&self, run: &Path) -> anyhow::Result<()> {
        self.machine.prepare()?;
        let interrupt = Interrupt::catch()?;
        let model =
            Ddl::load(run, self.machine.device)?.in_precision(self.exactness.precision())?;
        let model = self.clear.of(model)?;
        let request = EvaluationRequest {
            protocols: self.protocols.clone(),
            on: if self.validation {
                EvaluationSplit::Validation
            } else {
                EvaluationSplit::Test
            },
            test_walkers: self.test_walkers,
            commit: self.telling.commit.clone(),
        };
        if ddl::is_evaluated(&model, &request) {
            return self.tell(&Report::load(&model.run().report())?, &written(&model));
        }
        let dataset = dataset(model.config().data.convention, self.data.as_deref())?;
        let progress = Progress::new("evaluate", self.telling.progress);
        let evaluation = ddl::evaluate(&model, &dataset, &request, |now| {
            let (done, total) = now.walkers;
            progress.tell(done as u64, total as u64, now.protocol.name());
            interrupt.flow()
        })?;
        drop(progress);
        let title = format!(
            "{} {}",
            model.config().data.fold,
            model.config().star.variant
        );
        let report = Report::new(title, evaluation.rows)?;
        ddl::save_evaluation(&model, &request, &report, &evaluation.moments)?;
        self.tell(&report, &written(&model))
    }

    /// The results for people; programs read `report.json`.
    fn tell(&self, report: &Report, rest: &str) -> anyhow::Result<()> {
        if self.telling.progress != ProgressMode::Json {
            result_lines::print(report, rest)?;
        }
        Ok(())
    }
}

/// Where the rest of a run's results is.
fn written(model: &Ddl) -> String {
    let (report, run) = (model.run().report(), model.run().path());
    format!(
        "all metrics: {}; as a page: ddl report {} --out FOLDER",
        report.display(),
        run.display()
    )
}
