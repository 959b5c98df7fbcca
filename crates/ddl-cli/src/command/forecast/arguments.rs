//! The options of `ddl forecast`, and forecasts as text by these options.

use crate::command::forecast::moment::{SceneWindows, StreamState, WindowForecasts, warn_of_violation};
use crate::command::forecast::{json_lines, table};
use crate::command::{Machine, ModelChoice};
use crate::plans::GivenPlanOptions;
use crate::tracks::TrackOptions;
use clap::{Args, ValueEnum};
use ddl::data::{Clock, Window};
use ddl::{Ddl, Forecaster as _};
use std::path::PathBuf;

/// Forecast the next 4.8 s of your own tracks
#[derive(Debug, Args)]
#[command(mut_arg("file", |file| file.required(true)))]
#[command(after_help = "Examples:\n  \
        ddl forecast tracks.csv --output forecasts.csv\n  \
        ddl forecast camera.csv --fps 25 --homography H.txt --last\n  \
        tracker | ddl forecast - --fps 10 --one --format jsonl\n  \
        tracker | ddl forecast - --fps 10 --memory hall.memory\n  \
        trackers | ddl forecast - --fps 10 --latest --format jsonl\n  \
        ddl forecast tracks.csv --joint --plan robot.csv --format jsonl\n  \
        ddl forecast --model runs/eth tracks.csv --last --format jsonl --certificate")]
#[expect(clippy::struct_excessive_bools, reason = "switches of a command")]
pub(crate) struct ForecastCommand {
    #[command(flatten)]
    pub(super) model: ModelChoice,
    #[command(flatten)]
    pub(super) tracks: TrackOptions,
    /// File to write [default: standard output, also as `-`]
    #[arg(long, short)]
    pub(super) output: Option<PathBuf>,
    /// Format: csv (one row per position, to 0.1 mm) or jsonl (one JSON object per pedestrian, with all digits)
    /// [default: jsonl for a file of that extension, else csv]
    #[arg(long, value_enum)]
    pub(super) format: Option<OutputFormat>,
    /// One hypothesis per pedestrian instead of 20: to a central goal that represents the 20
    #[arg(long)]
    pub(super) one: bool,
    /// Joint futures of each scene instead of hypotheses of each pedestrian: people who walk together stay together, and
    /// people do not walk through each other
    ///
    /// Future k of all pedestrians is one future, with one weight. csv has the column `future` instead of `hypothesis`;
    /// jsonl has one object for each moment, with the groups. Regions and weights do not adapt.
    #[arg(long, conflicts_with = "one")]
    pub(super) joint: bool,
    #[command(flatten)]
    pub(super) given: GivenPlanOptions,
    /// With `-`: file of a scene memory, the earlier tracks of this place, which improves forecasts; created if
    /// missing, written every minute and at the end
    ///
    /// Use one file for each camera; for a stream of several scenes an existing folder, which gets a file SCENE.memory
    /// for each. The first 30 pedestrians show whether the memory is of this place; if it is not, the file is left
    /// unchanged and forecasts continue without it. `ddl data FILE` summarises the file.
    #[arg(long, value_name = "FILE")]
    pub(super) memory: Option<PathBuf>,
    /// With `-`: if frames arrive faster than they are forecast, forecast only the latest of each scene, and report how
    /// many were dropped
    ///
    /// Without it every frame is forecast, and the writer of the stream has to wait. Tracks and memory use every frame
    /// in both cases. With a file as input nearly all frames would be dropped.
    #[arg(long)]
    pub(super) latest: bool,
    /// Add to every hypothesis the evidence that it approaches its goal at every step
    ///
    /// A certificate holds when the distance to the goal falls at each of the 12 steps, along a flow that descends
    /// everywhere, and a pedestrian at its goal stays there. It refers to exactly the positions in JSON lines; csv
    /// rounds them to 0.1 mm. csv adds two columns, the distance to the goal at that frame (metres) and the verdict;
    /// jsonl adds the verdict and its evidence for each step. It proves that the forecast is stable, not that it is
    /// accurate. The variants star and no-dynamics have no certificates (with --one, only star).
    #[arg(long)]
    pub(super) certificate: bool,
    /// Regions that contain the pedestrian with these probabilities at each step, such as 0.5,0.9: discs around the
    /// hypotheses
    ///
    /// csv adds a column of radii (metres) for each, empty where a hypothesis has no disc; jsonl adds the discs of each
    /// step. The initial regions were calibrated on other places. From frame to frame they and the weights adapt to the
    /// observations, so that they keep their share in this place too (docs/regions.md). --last uses the initial ones.
    #[arg(long, value_name = "PROBABILITIES", value_delimiter = ',', value_parser = probability)]
    #[arg(conflicts_with = "one")]
    pub(super) region: Vec<f64>,
    #[command(flatten)]
    pub(super) machine: Machine,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum OutputFormat {
    Csv,
    Jsonl,
}

impl ForecastCommand {
    pub(super) fn model(&self) -> anyhow::Result<Ddl> {
        Ok(self.model.load(self.machine.device)?)
    }

    /// Forecasts of the windows in order of time, as text. The first text starts with the names of the columns, if the
    /// format has any.
    pub(super) fn text(
        &self,
        model: &Ddl,
        windows: SceneWindows<'_>,
        clock: Clock,
        state: &mut StreamState,
    ) -> anyhow::Result<String> {
        let mut forecasts = self.forecasts(model, windows.windows)?;
        if !self.region.is_empty() && !self.joint {
            for (i, forecast) in forecasts.each_mut().into_iter().enumerate() {
                *forecast = state.adapted(windows, i, forecast.clone());
            }
        }
        let moments = windows.moments(&forecasts, clock);
        warn_of_violation(&moments, state);
        state.unfamiliar.add(&moments);
        if self.tracks.are_live() {
            state
                .unfamiliar
                .warn("; this warning appears once, but each forecast has its familiarity");
        }
        let headed = !std::mem::replace(&mut state.headed, true);
        match self.format() {
            OutputFormat::Csv => table::csv(&moments, headed, &self.region, self.joint),
            OutputFormat::Jsonl if self.joint => json_lines::joint_lines(&moments, &self.region),
            OutputFormat::Jsonl => json_lines::json_lines(&moments, &self.region),
        }
    }

    fn format(&self) -> OutputFormat {
        let extension = self.output.as_ref().and_then(|path| path.extension());
        self.format
            .unwrap_or(if extension.is_some_and(|it| it.eq_ignore_ascii_case("jsonl")) {
                OutputFormat::Jsonl
            } else {
                OutputFormat::Csv
            })
    }

    fn forecasts(&self, model: &Ddl, windows: &[Window]) -> anyhow::Result<WindowForecasts> {
        if self.joint {
            return Ok(if self.certificate {
                WindowForecasts::Certified(model.forecast_scenes_certified(windows)?)
            } else {
                WindowForecasts::Plain(model.forecast_scenes(windows, self.given.read()?.as_ref())?)
            });
        }
        Ok(match (self.certificate, self.one) {
            (false, false) => WindowForecasts::Plain(model.forecast_all(windows)?),
            (false, true) => WindowForecasts::Plain(model.forecast_central(windows)?),
            (true, false) => WindowForecasts::Certified(model.forecast_certified(windows)?),
            (true, true) => WindowForecasts::Certified(model.forecast_central_certified(windows)?),
        })
    }
}

fn probability(text: &str) -> Result<f64, String> {
    let [low, high] = ddl::region_table().range();
    let level: f64 = text.trim().parse().map_err(|error| format!("{error}"))?;
    if (low..=high).contains(&level) {
        return Ok(level);
    }
    Err(format!("the probability of a region must be from {low} to {high}"))
}
