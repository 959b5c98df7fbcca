//! `ddl evaluate`: scores of a model or of another program.

mod forecasts;

use crate::command::{Machine, RecordingsAt, Reporting, at_least_one};
use crate::interrupt::Interrupt;
use crate::paths::{ModelPath, OutputPlace};
use crate::progress::Progress;
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::{Convention, Dataset};
use ddl::eval::external;
use ddl::report::Report;
use ddl::{
    BuiltinModel, Ddl, DdlError, EvaluationRequest, ModelSource, Protocol, Results, RunDirectory, Split, WorkDone,
};
use forecasts::OtherProgram;

/// Evaluate a model or another program's forecasts beside baselines
///
/// A model is evaluated on the scene left out of its training; forecasts of another program on the test windows of a
/// fold.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
        ddl evaluate --fold zara1\n  \
        ddl evaluate --data recordings\n  \
        ddl evaluate --model runs/own --data recordings --validation\n  \
        ddl evaluate --model runs/eth --protocol fair --protocol single\n  \
        ddl evaluate --forecasts mine.jsonl --fold zara1 --out results")]
pub(crate) struct Evaluate {
    /// Model: the directory of a run, a packed file, or a built-in model. It is evaluated on the scene it was trained
    /// without, or on your own recordings (--data FOLDER) [default: the built-in model trained without --fold; on own
    /// recordings world]
    #[arg(long, conflicts_with_all = ["forecasts", "fold", "window_rule"], value_hint = clap::ValueHint::AnyPath)]
    model: Option<ModelPath>,
    #[command(flatten)]
    other: OtherProgram,
    #[command(flatten)]
    recordings: RecordingsAt,
    /// Protocol: published, fair, single, online, online-single or joint; several as in `fair,single`
    #[arg(long = "protocol", value_delimiter = ',', default_values = ["fair", "single"])]
    protocols: Vec<Protocol>,
    /// Evaluate on the validation part of the training recordings instead of the test scene. For own recordings that
    /// the model was not trained on: the part that training would keep, which is the last fifth of each, or every fifth
    /// recording if they are short
    #[arg(long, conflicts_with = "forecasts")]
    validation: bool,
    /// Own recordings that form the validation part, such as `lobby,yard`
    #[arg(long, value_delimiter = ',', requires = "validation")]
    validation_recordings: Vec<String>,
    /// Evaluate a seeded part of the test windows, about this many pedestrians under the widest window rule [default:
    /// all]
    #[arg(long, value_parser = at_least_one, conflicts_with = "forecasts")]
    test_pedestrians: Option<usize>,
    /// Observe everybody only for the last rows, 1 to 8, at steps of 0.4 s [default: for all 8 steps]
    #[arg(long, value_name = "ROWS", value_parser = clap::value_parser!(u8).range(1..=8), conflicts_with = "forecasts")]
    observed_rows: Option<u8>,
    /// Write the futures of the protocol joint into a new folder, as the sample files of Joint Metrics Matter
    /// (docs/your-model.md)
    #[arg(long, value_name = "FOLDER", conflicts_with = "forecasts", value_hint = clap::ValueHint::AnyPath)]
    samples: Option<OutputPlace>,
    #[command(flatten)]
    machine: Machine,
    #[command(flatten)]
    reporting: Reporting,
}

impl Evaluate {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        match (&self.other.forecasts, &self.model) {
            (Some(file), _) => {
                let (data, commit) = (&self.recordings, &self.reporting.commit);
                let report = self.other.evaluate(file, &self.protocols, data, commit)?;
                self.reporting.print(&report, &self.other.written())
            }
            (None, Some(name)) => self.measure(&ModelSource::named(name)),
            (None, None) => self.measure(&ModelSource::Builtin(self.builtin_model()?)),
        }
    }

    /// The built-in model if none is named: that of the fold, or the default model for own recordings.
    fn builtin_model(&self) -> anyhow::Result<BuiltinModel> {
        let windows = &self.other.windows;
        if windows.convention(&self.recordings, Convention::Star) == Convention::Own {
            return Ok(BuiltinModel::default());
        }
        if windows.fold.is_some() {
            return self.other.builtin_model(&self.recordings);
        }
        bail!(
            "nothing to evaluate: give a model (--model), a fold for a built-in model (--fold eth, hotel, univ, zara1 \
             or zara2), your own recordings (--data FOLDER), or another program's forecasts (--forecasts)"
        )
    }

    fn measure(&self, source: &ModelSource) -> anyhow::Result<()> {
        if self.samples.is_some() && !self.protocols.contains(&Protocol::Joint) {
            bail!("--samples writes the futures of the protocol joint: add --protocol joint");
        }
        // Refused before the evaluation and not after it.
        let is_full = |folder: &&OutputPlace| folder.read_dir().is_ok_and(|mut files| files.next().is_some());
        if let Some(folder) = self.samples.as_ref().filter(is_full) {
            bail!("{} is not empty; give a new folder for --samples", folder.display());
        }
        self.machine.prepare()?;
        let interrupt = Interrupt::catch()?;
        let model = Ddl::open(source, self.machine.device)?;
        let mut request = EvaluationRequest::new(self.protocols.clone());
        if self.validation {
            request.on = Split::Validation;
        }
        request.validation_recordings.clone_from(&self.validation_recordings);
        request.test_pedestrians = self.test_pedestrians;
        request.observed_rows = self.observed_rows.map(usize::from);
        request.commit.clone_from(&self.reporting.commit);
        let trained_on = model.config().data.convention;
        let windows = &self.other.windows;
        let convention = windows.convention(&self.recordings, trained_on);
        if convention == Convention::Own {
            windows.ensure_no_rule_for_own()?;
        }
        let title = match convention {
            Convention::Own => format!("own recordings, {}", model.config().star.variant),
            _ => format!("{} {}", model.config().data.fold, model.config().star.variant),
        };
        // Results on recordings of another convention are not saved in the run.
        let own_run = model.source().run().filter(|_| convention == trained_on);
        let mut dataset = self.recordings.dataset_for(model.config(), convention)?;
        if let (Convention::Own, Some(name)) = (convention, &windows.fold) {
            dataset = Dataset::own(vec![dataset.recording(name)?.clone()])?;
        }
        if let (Some(run), None) = (own_run, &self.samples)
            && ddl::is_evaluated(&model, &dataset, &request)
        {
            self.save_elsewhere(|| Results::of(&title, &[run.path()]))?;
            return self.reporting.print(&Report::load(&run.report())?, &self.written(own_run));
        }
        let progress = Progress::new("evaluate", self.reporting.telling.progress);
        let evaluation = ddl::evaluate(&model, &dataset, &request, |now| {
            let WorkDone { done, total } = now.pedestrians;
            progress.tell(done, total, now.protocol.name());
            interrupt.flow()
        })?;
        drop(progress);
        if let Some(folder) = &self.samples {
            let (windows, forecasts): (Vec<_>, Vec<_>) = evaluation.scenes.into_iter().unzip();
            external::write_samples(&windows, &forecasts, folder)?;
        }
        let report = Report::new(&title, evaluation.rows)?;
        if let Some(run) = own_run {
            ddl::save_evaluation(&model, &dataset, &request, &report, &evaluation.moments)?;
            self.save_elsewhere(|| Results::of(&title, &[run.path()]))?;
        } else {
            self.save_elsewhere(|| Ok(Results::new(report.clone(), evaluation.moments)))?;
        }
        self.reporting.print(&report, &self.written(own_run))
    }

    fn save_elsewhere(&self, results: impl FnOnce() -> Result<Results, DdlError>) -> anyhow::Result<()> {
        if let Some(folder) = &self.other.out {
            results()?.save(folder).with_context(|| format!("cannot write to {}", folder.display()))?;
        }
        Ok(())
    }

    fn written(&self, own_run: Option<&RunDirectory>) -> String {
        match (own_run, &self.other.out) {
            (Some(run), None) => {
                let (report, run) = (run.report(), run.path());
                format!("all metrics: {}; for a page: ddl report {} --out FOLDER", report.display(), run.display())
            }
            _ => self.other.written(),
        }
    }
}
