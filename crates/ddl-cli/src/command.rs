//! The commands, one a file, and the options they share.

pub(crate) mod baselines;
pub(crate) mod benchmark;
pub(crate) mod data;
pub(crate) mod evaluate;
pub(crate) mod forecast;
pub(crate) mod generated;
pub(crate) mod goals;
pub(crate) mod info;
pub(crate) mod pack;
mod recipe;
pub(crate) mod report;
mod test_windows;
pub(crate) mod train;
pub(crate) mod view;
pub(crate) mod windows;

use crate::progress::ProgressMode;
use crate::telling::tell;
use crate::units::Units;
use crate::{output, recordings, result_lines};
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::{Convention, Dataset, locate};
use ddl::report::Report;
use ddl::{
    BuiltinModel, Clearance, Ddl, DdlError, DeviceChoice, GoalModel, ModelSource, Precision,
    RunConfig,
};
use std::path::{Path, PathBuf};

/// Seed of the simulated crowds: one data set for everybody.
const SIMULATION_SEED: u64 = 1;

/// A model by name, the program's own where none is named.
#[derive(Debug, Args)]
pub(crate) struct ModelChoice {
    /// Model: the directory of a run, a packed file (`ddl pack`), or a built-in model by the scene it was trained without:
    /// eth, hotel, univ, zara1 or zara2 [default: hotel, the built-in one that was trained on the most pedestrians]
    #[arg(long)]
    model: Option<PathBuf>,
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

    /// What goals come from alone: a run's may be there before its network is trained.
    pub(crate) fn load_goals(&self, device: DeviceChoice) -> Result<GoalModel, DdlError> {
        GoalModel::open(&self.source(), device)
    }
}

/// Where to compute and how to tell progress.
#[derive(Debug, Args)]
pub(crate) struct Machine {
    /// Device: auto, cpu or cuda
    #[arg(long, default_value = "cpu")]
    pub(crate) device: DeviceChoice,
    /// Threads for the network's kernels and goal search [default: all cores; of forecast, view and goals 1: too little to share]
    #[arg(long, value_parser = at_least_one)]
    threads: Option<usize>,
}

impl Machine {
    /// Opens the device and sets the threads, before anything else touches libtorch.
    pub(crate) fn prepare(&self) -> Result<(), DdlError> {
        ddl::prepare(self.device, self.threads)
    }

    /// The same for a few small tensors: a second thread would only wait.
    pub(crate) fn prepare_for_little(&self) -> Result<(), DdlError> {
        ddl::prepare(self.device, self.threads.or(Some(1)))
    }
}

/// How exactly the network computes.
#[derive(Debug, Args)]
pub(crate) struct Exactness {
    /// Products in the network's feed-forward blocks: f32, or bf16 (8 significant bits, sums in f32), which is faster on
    /// processors with AVX-512 BF16 and slower on others; on the CPU only
    #[arg(long, default_value = "f32")]
    precision: Precision,
}

impl Exactness {
    pub(crate) fn precision(&self) -> Precision {
        if !self.precision.is_native() {
            tell(format_args!(
                "warning: this processor has no {name} instructions; --precision {name} is emulated, slower than f32",
                name = self.precision.name()
            ));
        }
        self.precision
    }
}

/// Whether pedestrians mind each other.
#[derive(Debug, Args)]
pub(crate) struct KeepClear {
    /// Let pedestrians mind each other within so many metres, from centre to centre, such as 0.4
    ///
    /// Each hypothesis is walked again among the others, who go as they would most likely go alone:
    /// near somebody it slows down and slides along. The distance to the goal still falls at every
    /// step. The distance from each other is not guaranteed: both move, and nobody is moved aside.
    #[arg(
        long,
        value_name = "METRES",
        value_parser = clearance,
        allow_negative_numbers = true
    )]
    keep_clear: Option<Clearance>,
}

impl KeepClear {
    pub(crate) fn of(&self, model: Ddl) -> Result<Ddl, DdlError> {
        match self.keep_clear {
            None => Ok(model),
            Some(clearance) => model.keeping_clear(clearance),
        }
    }
}

fn clearance(text: &str) -> Result<Clearance, String> {
    let metres: f64 = text
        .parse()
        .map_err(|error| format!("must be a number ({error})"))?;
    Clearance::new(metres).map_err(|error| error.to_string())
}

/// What the help of commands that tell no progress says of the option, which every command that reports takes.
pub(crate) const NO_PROGRESS: &str = "Has no effect: this command shows no progress, but programs may give all commands the same options";

/// How progress is told, and whether results are for programs: options of every command that has either.
#[derive(Debug, Args)]
pub(crate) struct Telling {
    /// Progress of what takes long: a bar on a terminal, elsewhere a line every half a minute (auto), a JSON object a line (json), or none
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) progress: ProgressMode,
    /// Results on standard output as JSON, for programs
    #[arg(long)]
    pub(crate) json: bool,
}

/// How results are printed, and progress told.
#[derive(Debug, Args)]
pub(crate) struct Reporting {
    #[command(flatten)]
    pub(crate) telling: Telling,
    /// Commit to be named in results: that of the checkout it was built from
    #[arg(long, env = "DDL_COMMIT", default_value = env!("DDL_BUILT_FROM"), hide = true)]
    pub(crate) commit: String,
}

impl Reporting {
    fn print(&self, report: &Report, rest: &str) -> anyhow::Result<()> {
        if self.telling.json {
            output::print(&(report.to_json()? + "\n"))
        } else if self.telling.progress == ProgressMode::Json {
            // standard output has lines of progress
            Ok(())
        } else {
            output::print(&result_lines::lines(report, rest))
        }
    }
}

/// Where recordings are, and what the numbers of own ones mean.
#[derive(Debug, Args)]
pub(crate) struct RecordingsAt {
    /// Folder of the recordings; of own ones any files of tracks, or one such file [default: `$DDL_DATASETS`, then `datasets/eth_ucy`]
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
        let data = data.map_or_else(String::new, |data| {
            format!(" --data {}", output::shell_word(data))
        });
        data + &self.units.as_options()
    }

    /// The convention of what lies there, where none is asked for: that of the model, or own recordings where a place is named that does not hold
    /// the model's files.
    fn convention(&self, asked: Option<Convention>, of_model: Convention) -> Convention {
        asked.unwrap_or_else(|| convention_of(self.data.as_deref(), of_model))
    }

    fn dataset(&self, convention: Convention) -> anyhow::Result<Dataset> {
        dataset(convention, self.data.as_deref(), &self.units)
    }

    /// The same for a model: own recordings are read as its own ones were, as far as nothing else is said.
    fn dataset_for(&self, run: &RunConfig, convention: Convention) -> anyhow::Result<Dataset> {
        if convention != Convention::Own {
            return self.dataset(convention);
        }
        dataset(
            convention,
            self.data.as_deref(),
            &self.units.or_those_of(run),
        )
    }
}

/// The convention of what lies in a folder, or in the usual one: that of the model where one of its files is there, else own recordings.
fn convention_of(data: Option<&Path>, of_model: Convention) -> Convention {
    let Some(data) = data else { return of_model };
    let holds_some = |folder: &Path| of_model.file_names().any(|f| folder.join(f).is_file());
    if holds_some(data)
        || holds_some(&data.join(of_model.name()))
        || locate(of_model, Some(data)).is_ok()
    {
        of_model
    } else {
        Convention::Own
    }
}

fn dataset(convention: Convention, data: Option<&Path>, units: &Units) -> anyhow::Result<Dataset> {
    if convention == Convention::Own {
        let data = data.context("give the folder of your own recordings: --data FOLDER")?;
        let files = recordings::files(&[data.to_owned()], units)?;
        let read = recordings::read(&files, units)?;
        recordings::tell_notes(&read);
        recordings::warn_of_doubts(&read);
        return Ok(Dataset::own(
            read.into_iter().map(|of| of.recording).collect(),
        )?);
    }
    if units.are_given() {
        bail!(
            "--fps, --dt, --frame-step and --homography say what your own recordings mean (--convention own); those of {convention} are \
             known"
        );
    }
    if convention == Convention::Simulated {
        return Ok(Dataset::simulated(SIMULATION_SEED));
    }
    Ok(Dataset::load(convention, &folder(convention, data)?)?)
}

fn folder(convention: Convention, data: Option<&Path>) -> anyhow::Result<PathBuf> {
    locate(convention, data)
        .context("no recordings; `cargo xtask data fetch` gets them, or use --convention simulated")
}

pub(crate) fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) => Err("must be at least 1".to_owned()),
        Ok(number) => Ok(number),
        Err(error) => Err(format!("must be a whole number, at least 1 ({error})")),
    }
}
