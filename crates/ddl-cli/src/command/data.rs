//! `ddl data`.

use crate::clock::Clock;
use crate::units::Units;
use crate::{output, recordings};
use clap::Args;
use ddl::data::Summary;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Tell what recordings hold, and what looks wrong with them
///
/// How many people, for how long, how fast; how many moments can be forecast, and how many walkers a model can learn from.
/// Files that cannot be read are named on standard error, and the others told of all the same (exit code 1).
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  ddl data tracks.csv\n  ddl data recordings --fps 25 --json")]
pub(crate) struct Data {
    /// Files of tracks, in any format that `ddl forecast` reads, or folders of such files
    #[arg(value_name = "TRACKS", required = true)]
    paths: Vec<PathBuf>,
    #[command(flatten)]
    units: Units,
    /// As JSON
    #[arg(long)]
    json: bool,
}

impl Data {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let files = recordings::files(&self.paths, &self.units)?;
        let (read, errors) = recordings::read_each(&files, &self.units);
        let summaries = read
            .iter()
            .map(|(file, in_steps)| (file, in_steps.recording.summary(), in_steps.clock));
        if self.json {
            let facts: Result<Vec<Value>, _> = summaries
                .map(|(file, summary, clock)| facts(file, &summary, clock))
                .collect();
            output::print_json(&facts?)?;
            return recordings::all_read(errors, files.len());
        }
        let mut text = String::new();
        for (file, summary, clock) in summaries {
            write_summary(&mut text, &file.display().to_string(), &summary, clock)?;
        }
        output::print(&text)?;
        recordings::all_read(errors, files.len())
    }
}

/// The summary with frames numbered as the tracks number them.
fn facts(file: &Path, summary: &Summary, clock: Clock) -> serde_json::Result<Value> {
    let mut facts = serde_json::to_value(summary)?;
    facts["file"] = file.display().to_string().into();
    let doubts = summary.doubts().into_iter();
    facts["doubts"] = doubts
        .map(|doubt| recordings::words(clock.of_doubt(doubt)))
        .collect();
    for (name, frame) in [
        ("first_frame", summary.first_frame),
        ("last_frame", summary.last_frame),
        ("frame_step", summary.frame_step),
    ] {
        facts[name] = serde_json::to_value(clock.number(frame))?;
    }
    if let Some(hole) = &summary.longest_hole {
        facts["longest_hole"]["after"] = serde_json::to_value(clock.number(hole.after))?;
    }
    if let Some(fastest) = &summary.fastest {
        facts["fastest"]["frame"] = serde_json::to_value(clock.number(fastest.frame))?;
    }
    Ok(facts)
}

fn write_summary(out: &mut String, file: &str, s: &Summary, clock: Clock) -> std::fmt::Result {
    let many = |count: usize, one: &str, more: &str| {
        format!("{count} {}", if count == 1 { one } else { more })
    };
    writeln!(out, "{file}")?;
    writeln!(
        out,
        "  {} in {} ({} to {}, {} a step of 0.4 s: {:.1} s), {}",
        many(s.pedestrians, "person", "people"),
        many(s.frames, "frame", "frames"),
        clock.number(s.first_frame),
        clock.number(s.last_frame),
        clock.number(s.frame_step),
        s.seconds,
        many(s.observations, "position", "positions"),
    )?;
    writeln!(
        out,
        "  x from {:.2} to {:.2} m, y from {:.2} to {:.2} m; {}",
        s.low[0],
        s.high[0],
        s.low[1],
        s.high[1],
        match (s.median_speed, &s.fastest) {
            (Some(median), Some(fastest)) => format!(
                "median speed {median:.2} m/s, the fastest step {:.2} m/s (pedestrian {} at frame {})",
                fastest.speed,
                fastest.pedestrian,
                clock.number(fastest.frame)
            ),
            _ => "no speeds".to_owned(),
        }
    )?;
    writeln!(
        out,
        "  to forecast: {}, {} of them seen at all 8 steps; {} in the tracks{}",
        many(s.to_forecast, "moment of a person", "moments of people"),
        s.seen_whole,
        many(s.holes, "hole", "holes"),
        s.longest_hole.map_or_else(String::new, |hole| format!(
            ", the longest {:.1} s (pedestrian {} after frame {})",
            hole.seconds,
            hole.pedestrian,
            clock.number(hole.after)
        )),
    )?;
    writeln!(
        out,
        "  to train on and to measure with: {} in windows of 20 steps",
        many(s.to_learn_from, "walker", "walkers")
    )?;
    for doubt in s.doubts() {
        writeln!(
            out,
            "  doubtful: {}",
            recordings::words(clock.of_doubt(doubt))
        )?;
    }
    Ok(())
}
