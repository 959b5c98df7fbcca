//! `ddl data`: summaries of recordings and memories.

mod place_memory;

use crate::command::Telling;
use crate::telling::{many, tell};
use crate::units::Units;
use crate::{output, recordings};
use clap::Args;
use ddl::data::{Clock, PlausibilityWarning, Recording, Summary, Window};
use ddl::{BuiltinModel, DeviceChoice, GoalModel, ModelSource, Note, TimedRecording};
use place_memory::{MemoryOfFile, MemoryPicture};
use serde::Serialize;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Summarise recordings and report suspicious values
///
/// Prints the number of pedestrians, the duration and the speeds, and how many pedestrian-windows can be forecast or
/// used for training; a pedestrian counts once in every window. Files that cannot be read are reported on standard
/// error, and the others are still summarised (exit code 1). For the memory of a place, which `ddl forecast - --memory`
/// writes, it prints what was observed there.
#[derive(Debug, Args)]
#[command(mut_arg("progress", |arg| arg.help(crate::command::NO_PROGRESS)))]
#[command(after_help = "Examples:\n  ddl data tracks.csv\n  ddl data recordings --fps 25 --json\n  \
        ddl data hall.memory --svg hall.svg")]
pub(crate) struct Data {
    /// Files of tracks in any format that `ddl forecast` reads, folders of such files, or memories of places
    #[arg(value_name = "TRACKS", required = true)]
    paths: Vec<PathBuf>,
    #[command(flatten)]
    units: Units,
    #[command(flatten)]
    picture: MemoryPicture,
    #[command(flatten)]
    telling: Telling,
}

impl Data {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let files = recordings::files(&self.paths, &self.units)?;
        let (memories, of_tracks): (Vec<PathBuf>, _) =
            files.iter().cloned().partition(|file| place_memory::is_in(file));
        let (memories, not_memories) = place_memory::read_each(memories);
        let (mut read, mut errors) = recordings::read_each(&of_tracks, &self.units);
        for (_, read) in &mut read {
            // The summary prints the frame step.
            read.timed.guessed = None;
        }
        errors.extend(not_memories);
        if errors.is_empty() {
            self.picture.draw(&memories)?;
        }
        recordings::tell_notes(read.iter().map(|(_, read)| read));
        let mut text = String::new();
        let mut of_each = Vec::new();
        let mut total = Total::default();
        for (file, read) in &read {
            let TimedRecording { recording, clock, .. } = &read.timed;
            let summary = recording.summary();
            writeln!(text, "{}\n  format       {}", file.display(), read.format)?;
            write_summary(&mut text, &summary, recording, *clock)?;
            let mut facts = facts(file, &summary, recording, *clock)?;
            facts["format"] = read.format.into();
            of_each.push(facts);
            total.add(&summary);
        }
        let warn_of_models = || warn_of_model(read.iter().map(|(_, read)| &read.timed.recording));
        if self.telling.json {
            let of_memories: Vec<Value> = memories.iter().map(MemoryOfFile::facts).collect();
            output::print_json(&json!({"recordings": of_each, "memories": of_memories, "total": total}))?;
            warn_of_models()?;
            return recordings::all_read(errors, files.len());
        }
        if total.recordings > 1 {
            writeln!(text, "{total}")?;
        }
        for memory in &memories {
            writeln!(text, "{memory}")?;
        }
        output::print(&text)?;
        warn_of_models()?;
        recordings::all_read(errors, files.len())
    }
}

/// Warns of recordings that the default model was trained on, and of motions unlike those.
fn warn_of_model<'r>(recordings: impl Iterator<Item = &'r Recording>) -> anyhow::Result<()> {
    let model = BuiltinModel::default();
    let goals = GoalModel::open(&ModelSource::Builtin(model), DeviceChoice::Cpu)?;
    let (mut all, mut unfamiliar) = (0, 0_u32);
    for recording in recordings {
        let windows = some_windows(recording);
        if let Some(share) = goals.known_share(recording) {
            tell(format_args!(
                "warning: the built-in model {model} was trained on {} ({:.0} % of its paths are known): its forecasts \
                 of it are no test",
                recording.name(),
                100.0 * share
            ));
        }
        for familiarity in windows.iter().flat_map(|window| goals.familiarity(window)) {
            all += 1;
            unfamiliar += u32::from(familiarity < ddl::UNFAMILIAR_THRESHOLD);
        }
    }
    let share = 100.0 * f64::from(unfamiliar) / f64::from(all.max(1));
    if share > MANY_UNFAMILIAR {
        tell(format_args!(
            "warning: {share:.0} % of the motions are unlike the training motions of the built-in model {model} \
         (familiarity below {}): their forecasts are less certain",
            ddl::UNFAMILIAR_THRESHOLD
        ));
    }
    Ok(())
}

/// Windows of about [`SOME`] pedestrians over the whole recording.
fn some_windows(recording: &Recording) -> Vec<Window> {
    let every = 1 + recording.observations().len() / SOME;
    let (mut count, mut windows) = (0, Vec::new());
    let _ = recording.observe_each(recording.live_tracks(), |window| {
        if count % every == 0 {
            windows.push(window);
        }
        count += 1;
    });
    windows
}

/// Pedestrian-windows that are compared with those of the training.
const SOME: usize = 50_000;
/// Least noise that is measured apart (m).
const EXACT: f64 = 0.005;
/// Jitter above this share of the time between two rows is printed.
const EVEN_CLOCK: f64 = 0.01;
/// Share of unfamiliar motions (%) above which to warn: five times that of training recordings.
const MANY_UNFAMILIAR: f64 = 5.0;

#[derive(Debug, Default, Serialize)]
struct Total {
    recordings: usize,
    pedestrians: usize,
    to_forecast: usize,
    windows: usize,
    to_learn_from: usize,
    seconds: f64,
}

impl Total {
    fn add(&mut self, summary: &Summary) {
        self.recordings += 1;
        self.pedestrians += summary.pedestrians;
        self.to_forecast += summary.to_forecast;
        self.windows += summary.windows;
        self.to_learn_from += summary.to_learn_from;
        self.seconds += summary.seconds;
    }
}

impl std::fmt::Display for Total {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "total: {} recordings, {}, {} in {} of 20 steps, {:.2} hours",
            self.recordings,
            many(self.pedestrians, "pedestrian"),
            many(self.to_learn_from, "pedestrian-window"),
            many(self.windows, "window"),
            self.seconds / 3600.0
        )
    }
}

fn facts(file: &Path, summary: &Summary, recording: &Recording, clock: Clock) -> serde_json::Result<Value> {
    let mut facts = serde_json::to_value(summary)?;
    facts["file"] = file.display().to_string().into();
    facts["doubts"] = doubts(summary, recording, clock).into();
    facts["frame_step"] = serde_json::to_value(clock.step_number())?;
    for (name, frame) in [("first_frame", summary.first_frame), ("last_frame", summary.last_frame)] {
        facts[name] = serde_json::to_value(clock.number(frame))?;
    }
    if let Some(gap) = &summary.longest_hole {
        facts["longest_hole"]["after"] = serde_json::to_value(clock.number(gap.after))?;
    }
    if let Some(fastest) = &summary.fastest {
        facts["fastest"]["frame"] = serde_json::to_value(clock.number(fastest.frame))?;
    }
    Ok(facts)
}

fn doubts(summary: &Summary, recording: &Recording, clock: Clock) -> Vec<String> {
    let warnings = summary.warnings();
    let is_fast = |warning: &&PlausibilityWarning| matches!(warning, PlausibilityWarning::Fast { .. });
    let fast = warnings.iter().find(is_fast);
    let misfits = ddl::misfits_of(recording, clock, &summary.misfits, fast);
    let warnings = warnings.into_iter().map(|warning| Note::Implausible(ddl::in_frames(clock, warning)));
    warnings.chain(misfits).map(|note| note.to_string()).collect()
}

/// The rate of the rows of a pedestrian, its jitter, and the noise.
fn rows_in_words(s: &Summary) -> String {
    let Some(rate) = s.rows_a_second else {
        return "no pedestrian has two".to_owned();
    };
    let jitter = (s.jitter * rate > EVEN_CLOCK).then(|| format!(", ± {:.0} ms", 1e3 * s.jitter));
    let clocks = (!s.common_frames).then_some(", each pedestrian on its own clock");
    let noise = (s.noise > EXACT).then(|| format!("{:.0} cm", 100.0 * s.noise));
    format!(
        "{rate:.3} a second{}{}, noise {}",
        jitter.unwrap_or_default(),
        clocks.unwrap_or_default(),
        noise.as_deref().unwrap_or("below 1 cm")
    )
}

/// A quantity in each line, so that no line is wider than a terminal.
fn write_summary(out: &mut String, s: &Summary, recording: &Recording, clock: Clock) -> std::fmt::Result {
    let speed = match (s.median_speed, &s.fastest) {
        (Some(median), Some(fastest)) => format!(
            "median {median:.2} m/s, fastest step {:.2} m/s (pedestrian {}, {})",
            fastest.speed,
            fastest.pedestrian,
            clock.words(fastest.frame)
        ),
        _ => "unknown: no successive positions".to_owned(),
    };
    let gaps = s.longest_hole.as_ref().map_or_else(String::new, |gap| {
        format!(", the longest {:.1} s (pedestrian {}, after {})", gap.seconds, gap.pedestrian, clock.words(gap.after))
    });
    let span = if clock.counts_times() {
        format!("{} to {}", clock.words(s.first_frame), clock.words(s.last_frame))
    } else {
        let [first, last] = [s.first_frame, s.last_frame].map(|frame| clock.number(frame));
        format!("frames {first} to {last} ({} per step of 0.4 s)", clock.step_number())
    };
    let rows = rows_in_words(s);
    writeln!(
        out,
        "\x20 observed     {}, {}\n\
         \x20 time         {:.1} s, {span}\n\
         \x20 area         x {:.2} to {:.2} m, y {:.2} to {:.2} m\n\
         \x20 speed        {speed}\n\
         \x20 rows         {rows}\n\
         \x20 gaps         {}{gaps}\n\
         \x20 to forecast  {} of 8 steps, {} of them observed at all 8\n\
         \x20 to train     {} of 20 steps, in {}",
        many(s.pedestrians, "pedestrian"),
        many(s.observations, "position"),
        s.seconds,
        s.low[0],
        s.high[0],
        s.low[1],
        s.high[1],
        s.holes,
        many(s.to_forecast, "pedestrian-window"),
        s.seen_whole,
        many(s.to_learn_from, "pedestrian-window"),
        many(s.windows, "window"),
    )?;
    for doubt in doubts(s, recording, clock) {
        writeln!(out, "  doubtful     {doubt}")?;
    }
    Ok(())
}
