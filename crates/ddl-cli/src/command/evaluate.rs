//! `ddl evaluate`.

use super::{Exactness, KeepClear, Machine, Telling, at_least_one, dataset};
use crate::interrupt::Interrupt;
use crate::progress::{Progress, ProgressMode};
use crate::result_lines;
use clap::Args;
use ddl::eval::Report;
use ddl::{Ddl, EvaluationRequest, EvaluationSplit, Protocol};
use std::path::PathBuf;

/// Measure a trained model on the scene left out of its training, beside the baselines
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  ddl evaluate --model runs/eth --protocol fair --protocol single"
)]
pub(crate) struct Evaluate {
    /// Directory of the run
    #[arg(long)]
    model: PathBuf,
    /// Folder of the recordings [default: `$DDL_DATASETS`, then `datasets/eth_ucy`]
    #[arg(long)]
    data: Option<PathBuf>,
    /// published, fair or single; may be repeated
    #[arg(long = "protocol", default_values = ["fair", "single"])]
    protocols: Vec<Protocol>,
    /// Measure on the validation part of the training recordings instead of the test scene
    #[arg(long)]
    validation: bool,
    /// Measure a seeded part of the test windows with at least so many walkers [default: all]
    #[arg(long, value_parser = at_least_one)]
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
        self.machine.prepare()?;
        let interrupt = Interrupt::catch()?;
        let model = Ddl::load(&self.model, self.machine.device)?
            .in_precision(self.exactness.precision())?;
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
            return self.tell(&Report::load(&model.run().report())?);
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
        self.tell(&report)
    }

    /// The results for people; programs read `report.json`.
    fn tell(&self, report: &Report) -> anyhow::Result<()> {
        if self.telling.progress != ProgressMode::Json {
            result_lines::print(report, "the run's report.json")?;
        }
        Ok(())
    }
}
