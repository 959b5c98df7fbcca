//! The commands, one in each file, and the options they share.

pub(crate) mod benchmark;
pub(crate) mod completions;
pub(crate) mod data;
pub(crate) mod evaluate;
pub(crate) mod forecast;
pub(crate) mod goals;
pub(crate) mod info;
pub(crate) mod occupancy;
pub(crate) mod pack;
mod recipe;
pub(crate) mod report;
pub(crate) mod risk;
mod test_windows;
pub(crate) mod train;
pub(crate) mod view;
pub(crate) mod windows;

use crate::paths::ModelPath;
use crate::progress::ProgressMode;
use crate::telling::tell;
use crate::units::Units;
use crate::{output, recordings, result_lines};
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::{Convention, Dataset, locate};
use ddl::report::Report;
use ddl::{BuiltinModel, Ddl, DdlError, DeviceChoice, GoalModel, ModelSource, RunConfig};
use std::path::{Path, PathBuf};

/// A model by name, or the default built-in model.
#[derive(Debug, Args)]
pub(crate) struct ModelChoice {
    /// Model: the directory of a run, a packed file (`ddl pack`), or a built-in model: world, or one named after
    /// the scene it was trained without (eth, hotel, univ, zara1 or zara2) [default: world]
    #[arg(long, value_hint = clap::ValueHint::AnyPath)]
    model: Option<ModelPath>,
}

impl ModelChoice {
    fn source(&self) -> ModelSource {
        match &self.model {
            None => ModelSource::Builtin(BuiltinModel::default()),
            Some(name) => ModelSource::named(name),
        }
    }

    pub(crate) fn load(&self, device: DeviceChoice) -> Result<Ddl, DdlError> {
        Ddl::open(&self.source(), device)
    }

    /// Loads only the goals, which exist before the network of a run is trained.
    pub(crate) fn load_goals(&self, device: DeviceChoice) -> Result<GoalModel, DdlError> {
        GoalModel::open(&self.source(), device)
    }
}

/// The device, the threads and the display of progress.
#[derive(Debug, Args)]
pub(crate) struct Machine {
    /// Device: auto, cpu or cuda
    #[arg(long, default_value = "cpu")]
    pub(crate) device: DeviceChoice,
    /// Threads for the network and goal search [default: all cores; 1 for forecast, risk, occupancy and view]
    #[arg(long, value_parser = at_least_one)]
    threads: Option<usize>,
}

impl Machine {
    /// Opens the device and sets the threads. Call it before libtorch is used.
    pub(crate) fn prepare(&self) -> Result<(), DdlError> {
        ddl::prepare(self.device, self.threads)
    }

    /// As [`prepare`](Self::prepare), but with one thread by default, for work that a second thread would not speed up.
    pub(crate) fn prepare_for_little(&self) -> Result<(), DdlError> {
        ddl::prepare(self.device, self.threads.or(Some(1)))
    }
}

/// Help of the option in commands without progress. Every command that reports takes the option.
pub(crate) const NO_PROGRESS: &str = "Has no effect: this command shows no progress, but programs can give all \
    commands the same options";

/// The form of progress and results: options of every command with one of them.
#[derive(Debug, Args)]
pub(crate) struct Telling {
    /// Progress: auto (a bar on a terminal, else a line every 30 s), json (one JSON object per line), or none
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) progress: ProgressMode,
    /// Print results as JSON on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

impl Telling {
    /// Prints results in words: on standard error where standard output has lines of progress.
    pub(crate) fn print(&self, text: &str) -> anyhow::Result<()> {
        if self.progress == ProgressMode::Json {
            tell(format_args!("{}", text.trim_end()));
            return Ok(());
        }
        output::print(text)
    }
}

/// How results and progress are printed.
#[derive(Debug, Args)]
pub(crate) struct Reporting {
    #[command(flatten)]
    pub(crate) telling: Telling,
    /// Commit to name in results [default: the one that the program was built from]
    #[arg(long, env = "DDL_COMMIT", default_value = env!("DDL_BUILT_FROM"), hide = true)]
    pub(crate) commit: String,
}

impl Reporting {
    fn print(&self, report: &Report, rest: &str) -> anyhow::Result<()> {
        if self.telling.json {
            output::print(&(report.to_json()? + "\n"))
        } else {
            self.telling.print(&result_lines::lines(report, rest))
        }
    }
}

/// Where the recordings are, and the units of own recordings.
#[derive(Debug, Args)]
pub(crate) struct RecordingsAt {
    /// Recordings: a folder; of own recordings also a single file of tracks [default: `$DDL_DATASETS`, then
    /// `datasets/eth_ucy`]
    #[arg(long)]
    data: Option<PathBuf>,
    #[command(flatten)]
    units: Units,
}

impl RecordingsAt {
    fn is_named(&self) -> bool {
        self.data.is_some()
    }

    fn as_options(&self) -> String {
        let data = self.data.as_ref();
        let data = data.map_or_else(String::new, |data| format!(" --data {}", output::shell_word(data)));
        data + &self.units.as_options()
    }

    /// The requested convention or, by default, that of the model; own recordings if `--data` names a folder without
    /// the files of the model's convention.
    fn convention(&self, asked: Option<Convention>, of_model: Convention) -> Convention {
        asked.unwrap_or_else(|| convention_of(self.data.as_deref(), of_model))
    }

    fn dataset(&self, convention: Convention) -> anyhow::Result<Dataset> {
        dataset(convention, self.data.as_deref(), &self.units)
    }

    /// The recordings for a model. Own recordings are read with the units of its training unless options differ.
    fn dataset_for(&self, run: &RunConfig, convention: Convention) -> anyhow::Result<Dataset> {
        if convention != Convention::Own {
            return self.dataset(convention);
        }
        dataset(convention, self.data.as_deref(), &self.units.or_those_of(run))
    }
}

/// The convention of a folder (`None`: the default folder): that of the model if one of its files is there, else own
/// recordings.
fn convention_of(data: Option<&Path>, of_model: Convention) -> Convention {
    let Some(data) = data else { return of_model };
    let holds_some = |folder: &Path| of_model.file_names().any(|f| folder.join(f).is_file());
    if holds_some(data) || holds_some(&data.join(of_model.name())) || locate(of_model, Some(data)).is_ok() {
        of_model
    } else {
        Convention::Own
    }
}

fn dataset(convention: Convention, data: Option<&Path>, units: &Units) -> anyhow::Result<Dataset> {
    if convention == Convention::Own {
        let data = data.context("give --data FOLDER, your own recordings, or the model of a fold")?;
        let files = recordings::files(&[data.to_owned()], units)?;
        let read = recordings::read(&files, units)?;
        recordings::tell_notes(&read);
        recordings::tell_ticks(&read);
        recordings::warn_of_implausible(&read);
        return Ok(Dataset::own(read.into_iter().map(|read| read.timed.recording).collect())?);
    }
    if units.are_given() {
        bail!(
            "--fps, --dt, --frame-step, --homography, --columns, --keep and --unit describe your own recordings \
             (--convention own); those of {convention} have fixed units"
        );
    }
    if convention == Convention::Simulated {
        ensure_no_files(data)?;
        return Ok(Dataset::simulated(Dataset::CROWD_SEED));
    }
    Ok(Dataset::load(convention, &folder(convention, data)?)?)
}

fn ensure_no_files(data: Option<&Path>) -> anyhow::Result<()> {
    data.map_or(Ok(()), |data| bail!("--data {} has no effect: the simulated crowd has no files", data.display()))
}

fn folder(convention: Convention, data: Option<&Path>) -> anyhow::Result<PathBuf> {
    locate(convention, data).context("no recordings; `cargo xtask data fetch` gets them, or use --convention simulated")
}

pub(crate) fn at_least_one(text: &str) -> anyhow::Result<usize> {
    match text.parse() {
        Ok(0) => bail!("must be at least 1"),
        Ok(number) => Ok(number),
        Err(error) => bail!("must be a whole number of at least 1: {error}"),
    }
}
