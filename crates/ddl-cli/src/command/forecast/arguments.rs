//! The options of `ddl forecast`, and forecasts as text by these options.

use crate::command::forecast::answer::answer;
use crate::command::forecast::plans::GivenPlanOptions;
use crate::command::forecast::state::StreamState;
use crate::command::forecast::stream::{AnsweringCommand, OutputFormat, StreamOptions};
use anyhow::bail;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use ddl::{Holding, Moment, Request, WantedRegions, csv_table, json_lines};
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
    /// What each region holds with its probability: the pedestrian at one step, on its whole path of 4.8 s, or all
    /// pedestrians of the moment on their whole paths
    ///
    /// csv names the columns `path_radius_0.9` and `scene_radius_0.9`, jsonl adds `holds` to the region.
    #[arg(long, value_name = "WHAT", default_value = "step", value_parser = holding(), requires = "region")]
    region_holds: Holding,
}

impl ForecastCommand {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let mut levels = self.region.iter().enumerate();
        if let Some((_, twice)) = levels.find(|(i, level)| self.region[..*i].contains(level)) {
            bail!("--region names {twice} twice; name each probability once");
        }
        let mut state = StreamState::default();
        self.given.open(&mut state)?;
        answer(&self, state)
    }
}

impl AnsweringCommand for ForecastCommand {
    fn stream(&self) -> &StreamOptions {
        &self.stream
    }

    fn request(&self, state: &mut StreamState) -> anyhow::Result<Request> {
        let mut request = match (self.given.now(state), self.joint, self.one) {
            (Some(plan), ..) => Request::given(plan),
            (None, true, _) => Request::joint(),
            (None, false, true) => Request::one(),
            (None, false, false) => Request::default(),
        };
        (request.certificates, request.adaptive_regions) = (self.certificate, !self.region.is_empty());
        Ok(request)
    }

    fn log(&self, moments: &[Moment<'_>], log: &mut ForecastLog<&mut File>) -> anyhow::Result<()> {
        if self.format.is_some() {
            bail!("--format is of text, and --output names MCAP: leave out one of them");
        }
        if self.certificate || !self.region.is_empty() {
            bail!("MCAP has no place for --certificate and --region: leave them out, or write another file");
        }
        for moment in moments {
            let (forecast, is_joint) = (moment.answer.forecast(), moment.answer.is_joint());
            log.add(moment.window, forecast, is_joint, moment.microseconds())?;
        }
        Ok(())
    }

    fn text(&self, moments: &[Moment<'_>], state: &mut StreamState) -> anyhow::Result<String> {
        let headed = state.is_first_text();
        let regions = WantedRegions { levels: &self.region, holding: self.region_holds };
        match self.stream.format(self.format) {
            OutputFormat::Csv => Ok(csv_table(moments, headed, regions)?),
            OutputFormat::Jsonl => Ok(json_lines(moments, regions)?),
        }
    }
}

fn probability(text: &str) -> anyhow::Result<f64> {
    let [low, high] = ddl::region_table().range();
    let level: f64 = text.trim().parse()?;
    if (low..=high).contains(&level) {
        return Ok(level);
    }
    bail!("the probability of a region must be from {low} to {high}")
}

fn holding() -> impl TypedValueParser<Value = Holding> {
    PossibleValuesParser::new(Holding::ALL.map(Holding::name)).map(|name| Holding::named(&name).unwrap_or_default())
}
