//! The units of tracks: the frame rate, and the homography of pixels.

use crate::output::shell_word;
use crate::small_file;
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::{Clock, ColumnChoice, Format, Homography, Recording, is_vehicle, parse_columns};
use ddl::{Note, RunConfig, TimedRecording, TrackUnits};
use ddl_mcap::{TrackTopic, is_log, read_log};
use std::path::{Path, PathBuf};

/// The units of frame numbers and positions: from options, else from the file, else from the run.
#[derive(Debug, Clone, Args)]
pub(crate) struct Units {
    /// Frame numbers per second, such as 25 or 23.976; times need none [default: that in the file, else that of the
    /// run's training, else the most common difference between two rows of a pedestrian counts as 0.4 s]
    #[arg(long, conflicts_with_all = ["dt", "frame_step"], value_parser = positive, allow_negative_numbers = true)]
    fps: Option<f64>,
    /// Seconds between consecutive frame numbers, such as 0.1
    #[arg(long, conflicts_with = "frame_step", value_name = "SECONDS")]
    #[arg(value_parser = positive, allow_negative_numbers = true)]
    dt: Option<f64>,
    /// Frame numbers in 0.4 s [default: as of --fps]
    #[arg(long, value_parser = clap::value_parser!(i64).range(1..=1 << 31), allow_negative_numbers = true)]
    frame_step: Option<i64>,
    /// Positions are in pixels: file with the homography to metres, three lines of three numbers; `none` for metres
    /// [default: that of the run's training, if any]
    #[arg(long, value_name = "FILE")]
    homography: Option<PathBuf>,
    /// The columns of a table, where their names do not say it: frame (or time), pedestrian, x, y, class, scene
    #[arg(long, value_name = "ROLE=NAME,...", value_parser = columns)]
    columns: Option<ColumnChoice>,
    /// Only rows with this value count: of the column of classes (class=Pedestrian), or of any other
    #[arg(long, value_name = "COLUMN=VALUE", value_parser = kept)]
    keep: Option<String>,
    /// The unit of positions [default: that in the names of the columns, or m]
    #[arg(long, value_parser = ["m", "cm", "mm", "px"])]
    unit: Option<String>,
    /// The topic of MCAP files and rosbag2 recordings to read [default: the one with tracks]
    #[arg(long)]
    topic: Option<String>,
    /// The units of the run's training.
    #[arg(skip)]
    remembered: TrackUnits,
}

#[derive(Debug)]
pub(crate) struct ReadRecording {
    /// The recognised format of the file.
    pub(crate) format: &'static str,
    /// Its topic in a log.
    pub(crate) topic: Option<TrackTopic>,
    /// Its notes are for [`tell_notes`](crate::recordings::tell_notes).
    pub(crate) timed: TimedRecording,
}

fn columns(text: &str) -> anyhow::Result<ColumnChoice> {
    Ok(ColumnChoice::default().with_columns(text).map_err(|error| error.problem)?)
}

fn kept(text: &str) -> anyhow::Result<String> {
    Ok(ColumnChoice::default().keeping(text).map(|_| text.to_owned()).map_err(|error| error.problem)?)
}

/// A recording, the name of its format and, of a log, the topic.
type ReadFile = (Recording, &'static str, Option<TrackTopic>);

impl Units {
    /// These units. Units that neither options nor files give are taken from the training of the run, if it used own
    /// recordings.
    pub(crate) fn or_those_of(&self, run: &RunConfig) -> Self {
        Self { remembered: run.units.unwrap_or_default(), ..self.clone() }
    }

    pub(crate) fn told(&self) -> anyhow::Result<Option<TrackUnits>> {
        let units = TrackUnits { homography: self.homography()?, ..self.rate() };
        Ok((units != TrackUnits::default()).then_some(units))
    }

    fn rate(&self) -> TrackUnits {
        TrackUnits { fps: self.fps, dt: self.dt, frame_step: self.frame_step, homography: None }
    }

    pub(crate) fn are_given(&self) -> bool {
        let of_columns = self.columns.is_some() || self.keep.is_some() || self.unit.is_some() || self.topic.is_some();
        self.rate_given().is_some() || self.homography.is_some() || of_columns
    }

    /// What the options say of the columns of text, whose positions a homography maps or not.
    pub(crate) fn choice(&self, is_mapped: bool) -> anyhow::Result<ColumnChoice> {
        if self.topic.is_some() {
            bail!("only MCAP has topics; leave out --topic");
        }
        let columns = self.columns.as_ref().map(ToString::to_string);
        let given = [&columns, &self.keep, &self.unit].map(Option::as_deref);
        Ok(ColumnChoice::given(given, is_mapped)?)
    }

    /// The option that gives the rate, with its value.
    pub(crate) fn rate_given(&self) -> Option<String> {
        self.rate().rate_setting()
    }

    pub(crate) fn as_options(&self) -> String {
        let rate = self.rate_given().map(|rate| format!(" {rate}"));
        let columns = self.columns.as_ref().map(ToString::to_string);
        let others = [
            ("homography", self.homography.as_deref()),
            ("columns", columns.as_deref().map(Path::new)),
            ("keep", self.keep.as_deref().map(Path::new)),
            ("unit", self.unit.as_deref().map(Path::new)),
            ("topic", self.topic.as_deref().map(Path::new)),
        ];
        let others = others.into_iter().filter_map(|(option, value)| Some((option, value?)));
        let others = others.map(|(option, value)| format!(" --{option} {}", shell_word(value)));
        rate.into_iter().chain(others).collect()
    }

    /// Whether this file is the homography, which may be stored in the folder of the recordings.
    pub(crate) fn are_from(&self, file: &Path) -> bool {
        let place = |path: &Path| path.canonicalize().ok();
        let homography = self.homography.as_deref().and_then(place);
        let says = |homography: Homography| {
            let text = small_file::read(file);
            text.is_ok_and(|text| text.parse() == Ok(homography))
        };
        (homography.is_some() && homography == place(file)) || self.remembered.homography.is_some_and(says)
    }

    /// Reads the recording in the file, in metres and ticks of its clock. The format is recognised. The file is read
    /// once, so that it may be a pipe.
    pub(crate) fn read(&self, file: &Path) -> anyhow::Result<ReadRecording> {
        let (rows, format, topic) = self.in_metres(file)?;
        let timed = TimedRecording::new(&rows, &self.rate(), &self.remembered);
        let mut timed = timed.with_context(|| file.display().to_string())?;
        timed.notes.extend(self.note_of_run(rows.stated_clock().is_none()).map(Note::Reader));
        Ok(ReadRecording { format, topic, timed })
    }

    /// A note about units taken from the run; `rate`: whether no file gives its rate.
    pub(crate) fn note_of_run(&self, rate: bool) -> Option<String> {
        let rate = rate && self.rate_given().is_none();
        let rate = self.remembered.rate_setting().filter(|_| rate);
        let positions = self.homography.is_none() && self.remembered.homography.is_some();
        let taken: Vec<String> = rate.into_iter().chain(positions.then(|| "its homography".to_owned())).collect();
        (!taken.is_empty()).then(|| {
            format!(
                "the units are those of the run's training ({}); give --fps, --dt, --frame-step or --homography if \
                 this is wrong",
                taken.join(" and ")
            )
        })
    }

    fn in_metres(&self, file: &Path) -> anyhow::Result<ReadFile> {
        // A homography may be a pipe, which is read once.
        let homography = self.homography()?;
        let (recording, format, topic) = self.as_written(file, homography.is_some())?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let recording = recording.with_name(&*name);
        let recording = match homography {
            None => recording,
            Some(homography) => homography.to_ground(&recording).with_context(|| file.display().to_string())?,
        };
        Ok((recording, format, topic))
    }

    fn as_written(&self, file: &Path, is_mapped: bool) -> anyhow::Result<ReadFile> {
        if is_log(file) {
            let tracks = read_log(file, self.topic.as_deref(), self.classes()?)?;
            return Ok((tracks.recording, "mcap", Some(tracks.topic)));
        }
        if file.as_os_str() == "-" {
            bail!("only `ddl forecast -` reads standard input; give a file of tracks");
        }
        if file.is_dir() {
            bail!("{} is a folder; give one of its files of tracks (`ddl data {0}` summarises each)", file.display());
        }
        let bytes = std::fs::read(file).with_context(|| format!("cannot read {}", file.display()))?;
        let choice = self.choice(is_mapped)?;
        let format = Format::guess(file, &bytes, &choice)?;
        let recording = parse_columns(&bytes, &file.display().to_string(), format, &choice)?;
        Ok((recording, format.name(), None))
    }

    /// Which classes of a log are pedestrians.
    fn classes(&self) -> anyhow::Result<impl Fn(&str) -> bool> {
        if self.columns.is_some() || self.unit.is_some() {
            bail!("MCAP has no columns, and its positions are in metres: leave out --columns and --unit");
        }
        let kept = match self.keep.as_deref().map(|keep| keep.split_once('=')) {
            None => None,
            Some(Some(("class", class))) => Some(class.to_owned()),
            Some(_) => bail!("of MCAP, --keep chooses a class, as in --keep class=person"),
        };
        Ok(move |class: &str| kept.as_ref().map_or(!is_vehicle(class), |kept| class.eq_ignore_ascii_case(kept)))
    }

    pub(crate) fn homography(&self) -> anyhow::Result<Option<Homography>> {
        let path = match &self.homography {
            None => return Ok(self.remembered.homography),
            Some(none) if none.as_os_str() == "none" => return Ok(None),
            Some(path) => path,
        };
        let homography = small_file::read(path)?.parse().with_context(|| path.display().to_string())?;
        Ok(Some(homography))
    }

    /// The clock of live tracks, if options give it.
    pub(crate) fn live_clock(&self) -> anyhow::Result<Option<Clock>> {
        Ok(self.rate().clock()?)
    }

    /// The clock from the run, with its description.
    pub(crate) fn remembered_live_clock(&self) -> anyhow::Result<Option<(Clock, String)>> {
        let rate = self.remembered.rate_setting();
        let of_run = self.remembered.clock()?.zip(rate);
        Ok(of_run.map(|(clock, rate)| (clock, format!("as in the run's training ({rate})"))))
    }
}

fn positive(text: &str) -> anyhow::Result<f64> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => bail!("must be a finite number above 0"),
    }
}
