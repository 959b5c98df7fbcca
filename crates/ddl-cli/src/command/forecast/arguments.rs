//! The options of `ddl forecast`, and forecasts as text by these options.

use crate::command::forecast::moment::{SceneWindows, StreamState};
use crate::command::forecast::stream::{Answer, OutputFormat, StreamOptions, answer};
use crate::command::forecast::table;
use crate::plans::{GivenPlanOptions, tell_doubts_of_ego};
use anyhow::bail;
use clap::Args;
use ddl::{CertifiedForecast, Ddl, Forecaster as _, Moment, joint_lines, json_lines};
use ddl_mcap::ForecastLog;
use std::fs::File;

/// Forecast the next 4.8 s of your own tracks
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
        ddl forecast tracks.csv --output forecasts.csv\n  \
        ddl forecast camera.csv --fps 25 --homography H.txt --last\n  \
        tracker | ddl forecast - --fps 10 --one --format jsonl\n  \
        tracker | ddl forecast - --fps 10 --memory hall.memory\n  \
        trackers | ddl forecast - --fps 10 --latest --format jsonl\n  \
        ddl forecast tracks.csv --joint --plan robot.csv --format jsonl\n  \
        ddl forecast drive.mcap --topic /tracks --output forecasts.mcap\n  \
        ddl forecast --model runs/eth tracks.csv --last --format jsonl --certificate")]
pub(crate) struct ForecastCommand {
    #[command(flatten)]
    stream: StreamOptions,
    /// Format: csv (one row per position, to 0.1 mm) or jsonl (one JSON object per pedestrian, with all digits)
    /// [default: jsonl for a file of that extension, else csv]
    #[arg(long, value_enum)]
    format: Option<OutputFormat>,
    /// One hypothesis per pedestrian instead of 20: to a central goal that represents the 20
    #[arg(long)]
    one: bool,
    /// Joint futures of each scene instead of hypotheses of each pedestrian: people who walk together stay together,
    /// and people seldom walk through each other
    ///
    /// Future k of all pedestrians is one future, with one weight. csv has the column `future` instead of `hypothesis`;
    /// jsonl has one object for each moment, with the groups. Regions and weights do not adapt.
    #[arg(long, conflicts_with = "one")]
    joint: bool,
    #[command(flatten)]
    given: GivenPlanOptions,
    /// Add to every hypothesis the evidence that it approaches its goal at every step
    ///
    /// A certificate holds when the distance to the goal falls at each of the 12 steps, along a flow that descends
    /// everywhere, and a pedestrian at its goal stays there. It refers to exactly the positions in JSON lines; csv
    /// rounds them to 0.1 mm. csv adds two columns, the distance to the goal at that frame (metres) and the verdict;
    /// jsonl adds the verdict and its evidence for each step. It proves that the forecast is stable, not that it is
    /// accurate. The variants star and no-dynamics have no certificates (with --one, only star).
    #[arg(long)]
    certificate: bool,
    /// Regions that contain the pedestrian with these probabilities at each step, such as 0.5,0.9: discs around the
    /// hypotheses
    ///
    /// csv adds a column of radii (metres) for each, empty where a hypothesis has no disc; jsonl adds the discs of each
    /// step. The initial regions were calibrated on other places. From frame to frame they and the weights adapt to the
    /// observations, so that they keep their share in this place too (docs/regions.md). --last uses the initial ones.
    #[arg(long, value_name = "PROBABILITIES", value_delimiter = ',', value_parser = probability)]
    #[arg(conflicts_with = "one")]
    region: Vec<f64>,
}

impl ForecastCommand {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let mut levels = self.region.iter().enumerate();
        if let Some((_, twice)) = levels.find(|(i, level)| self.region[..*i].contains(level)) {
            bail!("--region names {twice} twice; name each probability once");
        }
        answer(&self)
    }
}

impl Answer for ForecastCommand {
    fn stream(&self) -> &StreamOptions {
        &self.stream
    }

    fn forecasts(
        &self,
        model: &Ddl,
        windows: SceneWindows<'_>,
        state: &mut StreamState,
    ) -> anyhow::Result<Vec<CertifiedForecast>> {
        let given = self.given.read()?;
        if let Some(given) = &given {
            for window in windows.windows {
                tell_doubts_of_ego(self.given.ego.as_deref(), &[&given.plan], window, state);
            }
        }
        let some = windows.windows;
        let plain = |forecasts: Vec<ddl::Forecast>| forecasts.into_iter().map(Into::into).collect();
        let mut forecasts: Vec<CertifiedForecast> = match (self.joint, self.certificate, self.one) {
            (true, true, _) => model.forecast_scenes_certified(some)?,
            (true, false, _) => plain(model.forecast_scenes(some, given.as_ref())?),
            (false, false, false) => plain(model.forecast_all(some)?),
            (false, false, true) => plain(model.forecast_central(some)?),
            (false, true, false) => model.forecast_certified(some)?,
            (false, true, true) => model.forecast_central_certified(some)?,
        };
        if !self.region.is_empty() && !self.joint {
            for (i, one) in forecasts.iter_mut().enumerate() {
                one.forecast = state.adapted(windows, i, one.forecast.clone());
            }
        }
        Ok(forecasts)
    }

    fn log(&self, moments: &[Moment<'_>], log: &mut ForecastLog<&mut File>) -> anyhow::Result<()> {
        if self.format.is_some() {
            bail!("--format is of text, and --output names MCAP: leave out one of them");
        }
        if self.certificate || !self.region.is_empty() {
            bail!("MCAP has no place for --certificate and --region: leave them out, or write another file");
        }
        for moment in moments {
            log.add(moment.window, moment.forecast, self.joint, moment.microseconds())?;
        }
        Ok(())
    }

    fn text(&self, moments: &[Moment<'_>], state: &mut StreamState) -> anyhow::Result<String> {
        let headed = state.is_first_text();
        match self.stream.format(self.format) {
            OutputFormat::Csv => table::csv(moments, headed, &self.region, self.joint),
            OutputFormat::Jsonl if self.joint => Ok(joint_lines(moments, &self.region)?),
            OutputFormat::Jsonl => Ok(json_lines(moments, &self.region)?),
        }
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
