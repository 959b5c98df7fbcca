//! `ddl forecast`.

use super::Machine;
use crate::tracks::{Tracks, write_output};
use anyhow::Context as _;
use clap::{Args, ValueEnum};
use ddl::data::{HORIZON, Window};
use ddl::{Ddl, Forecaster as _};
use serde::Serialize;
use std::path::PathBuf;

/// Forecast the next 4.8 s of your own tracks
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  ddl forecast --model runs/eth tracks.csv --output forecasts.csv"
)]
pub(crate) struct Forecast {
    /// Directory of a trained run
    #[arg(long)]
    model: PathBuf,
    #[command(flatten)]
    tracks: Tracks,
    /// File to write [default: standard output]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// csv: a row a position; jsonl: a JSON object a pedestrian
    #[arg(long, value_enum, default_value = "csv")]
    format: OutputFormat,
    #[command(flatten)]
    machine: Machine,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OutputFormat {
    Csv,
    Jsonl,
}

/// A forecast position, as a csv row.
#[derive(Serialize)]
struct Row {
    observed_until: i64,
    pedestrian: i64,
    hypothesis: usize,
    weight: f64,
    frame: i64,
    x: f64,
    y: f64,
}

/// All hypotheses of a pedestrian, as a JSON line.
#[derive(Serialize)]
struct Line {
    observed_until: i64,
    pedestrian: i64,
    frames: Vec<i64>,
    hypotheses: Vec<Hypothesis>,
}

#[derive(Serialize)]
struct Hypothesis {
    weight: f64,
    goal: Option<[f64; 2]>,
    positions: Vec<[f64; 2]>,
}

impl Forecast {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        self.machine.prepare_for_little()?;
        let windows = self.tracks.windows()?;
        let model = Ddl::load(&self.model, self.machine.device)?;
        let forecasts = model.forecast_all(&windows)?;
        let pairs = windows.iter().zip(&forecasts);
        let text = match self.format {
            OutputFormat::Csv => csv(pairs)?,
            OutputFormat::Jsonl => json_lines(pairs)?,
        };
        write_output(self.output.as_deref(), &text)
    }
}

fn csv<'a>(pairs: impl Iterator<Item = (&'a Window, &'a ddl::Forecast)>) -> anyhow::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (window, forecast) in pairs {
        let (last, frames) = frames(window);
        for (i, pedestrian) in window.pedestrians().iter().enumerate() {
            for hypothesis in 0..forecast.hypotheses() {
                for (position, &frame) in forecast.hypothesis(i, hypothesis).iter().zip(&frames) {
                    writer.serialize(Row {
                        observed_until: last,
                        pedestrian: pedestrian.0,
                        hypothesis,
                        weight: forecast.weight(i, hypothesis),
                        frame,
                        x: position[0],
                        y: position[1],
                    })?;
                }
            }
        }
    }
    let bytes = writer.into_inner().context("cannot finish the csv")?;
    Ok(String::from_utf8(bytes)?)
}

fn json_lines<'a>(
    pairs: impl Iterator<Item = (&'a Window, &'a ddl::Forecast)>,
) -> anyhow::Result<String> {
    let mut text = String::new();
    for (window, forecast) in pairs {
        let (last, frames) = frames(window);
        for (i, pedestrian) in window.pedestrians().iter().enumerate() {
            let hypotheses = (0..forecast.hypotheses())
                .map(|k| Hypothesis {
                    weight: forecast.weight(i, k),
                    goal: forecast.goal(i, k),
                    positions: forecast.hypothesis(i, k).to_vec(),
                })
                .collect();
            let frames = frames.clone();
            let line = Line {
                observed_until: last,
                pedestrian: pedestrian.0,
                frames,
                hypotheses,
            };
            text += &serde_json::to_string(&line)?;
            text.push('\n');
        }
    }
    Ok(text)
}

/// The last observed frame of a window and the frames that are forecast.
fn frames(window: &Window) -> (i64, Vec<i64>) {
    let last = window.frames()[ddl::data::OBSERVED - 1];
    let step = window.frame_step();
    (
        last,
        (1..=HORIZON as i64).map(|t| last + t * step).collect(),
    )
}
