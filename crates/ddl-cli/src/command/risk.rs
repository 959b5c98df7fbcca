//! `ddl risk`: how likely somebody comes close to a plan.

use crate::command::forecast::{
    AnsweringCommand, NamedPlan, OutputFormat, PlanFile, StreamOptions, StreamState, answer,
};

use anyhow::Context as _;
use clap::Args;
use ddl::data::{FrameNumber, HORIZON, PedestrianName, SceneName, TIME_STEP};
use ddl::scene::{Clearance, Plan};
use ddl::{Moment, Note, table_metres, table_share};
use serde::Serialize;
use std::path::PathBuf;

/// Compute how likely somebody comes close to a plan
///
/// From the joint futures of every moment. Only pedestrians who are forecast count.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
        ddl risk tracks.csv --plan robot.csv --last\n  \
        ddl risk tracks.csv --plan candidates.csv --within 0.8 --format jsonl\n  \
        tracker | ddl risk - --fps 10 --plan robot.csv")]
pub(crate) struct RiskCommand {
    #[command(flatten)]
    stream: StreamOptions,
    /// Plans: csv of `t,x,y` in seconds after the moment and metres, and where there are `radius` (metres) and `plan`,
    /// the name of one of several candidates
    ///
    /// The file is read again while a stream runs, so that another program can replace it, by renaming a whole file.
    /// Until its first time a plan is at its first position, after its last time at its last position.
    #[arg(long, value_name = "FILE")]
    plan: PathBuf,
    /// Distance from the edge of the plan that counts as close, metres
    #[arg(long, default_value_t = 0.5, allow_negative_numbers = true)]
    within: f64,
    /// The pedestrian of the tracks who follows the plans: it is no risk to itself [default: none of them]
    #[arg(long, value_name = "NAME")]
    ego: Option<String>,
    /// People do not see who follows the plan; otherwise they keep away as from a pedestrian
    #[arg(long)]
    unseen: bool,
    /// Add the expected least distance of people who do not see the plan, not with --ego
    #[arg(long, conflicts_with = "ego")]
    nearest: bool,
    /// Format: csv (one row per moment and plan, with the pedestrian most at risk and the risk until each step) or
    /// jsonl (also of each pedestrian) [default: jsonl for a file of that extension, else csv]
    #[arg(long, value_enum)]
    format: Option<OutputFormat>,
}

#[derive(Serialize)]
struct PlanLine<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<&'a SceneName>,
    observed_until: FrameNumber,
    #[serde(skip_serializing_if = "str::is_empty")]
    plan: &'a str,
    within: f64,
    risk: f64,
    /// Expected least distance from the edge of the plan, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest: Option<f64>,
    /// That somebody is close during each step, and by its end.
    steps: [f64; HORIZON],
    until: [f64; HORIZON],
    pedestrians: Vec<PedestrianRisk>,
}

#[derive(Serialize)]
struct PedestrianRisk {
    pedestrian: PedestrianName,
    risk: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest: Option<f64>,
}

impl RiskCommand {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        // Faults of the plans show before the model is loaded.
        let mut state = StreamState::default();
        state.plans = PlanFile::open(&self.plan, false)?;
        answer(&self, state)
    }

    fn csv(&self, lines: &[PlanLine<'_>], headed: bool) -> anyhow::Result<String> {
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
        if headed {
            let named = lines.first().and_then(|line| line.scene).map(|_| "scene");
            let nearest = self.nearest.then_some("nearest");
            let columns = named.into_iter().chain(["observed_until", "plan", "within", "risk"]);
            let columns = columns.chain(nearest).chain(["pedestrian", "pedestrian_risk"]).map(str::to_owned);
            let until = (1..=HORIZON).map(|t| format!("until_{:.1}", TIME_STEP * t as f64));
            writer.write_record(columns.chain(until))?;
        }
        for line in lines {
            let pedestrians = line.pedestrians.iter();
            let worst = pedestrians.reduce(|worst, other| if other.risk > worst.risk { other } else { worst });
            let worst = worst.map(|worst| (&worst.pedestrian, table_share(worst.risk)));
            let nearest = Vec::from_iter(line.nearest.map(table_metres));
            let (observed_until, risk) = (line.observed_until.rounded(), table_share(line.risk));
            let row = (observed_until, line.plan, line.within, risk, nearest);
            let until = line.until.map(table_share);
            writer.serialize((Vec::from_iter(line.scene), row, worst.unzip(), until))?;
        }
        Ok(String::from_utf8(writer.into_inner().context("cannot finish the csv")?)?)
    }
}

impl AnsweringCommand for RiskCommand {
    fn stream(&self) -> &StreamOptions {
        &self.stream
    }

    fn text(&self, moments: &[Moment<'_>], state: &mut StreamState) -> anyhow::Result<String> {
        let named = state.plans.read();
        let plans: Vec<Plan> = named.iter().map(|named| named.plan.clone()).collect();
        let ego_name = self.ego.as_deref().map(PedestrianName::of_text);
        let mut lines = Vec::new();
        for moment in moments {
            let ego = ego_name.as_ref().and_then(|name| moment.window.named(name));
            let futures = moment.answer.futures()?;
            state.tell_notes_once(Note::of_ego(ego_name.as_ref(), moment.window), moment);
            let names = named.iter().map(|NamedPlan { name, plan }| (name.as_str(), plan));
            state.tell_notes_once(Note::of_plans(names, futures, ego), moment);
            let risks = if self.unseen {
                futures.risks(&plans, self.within, ego)?
            } else {
                futures.risks_if_seen(&plans, self.within, ego)?
            };
            let clearances = self.nearest.then(|| futures.clearances(&plans)).transpose()?;
            for (index, NamedPlan { name, .. }) in named.iter().enumerate() {
                let risk = &risks[index];
                let clearance = clearances.as_ref().map(|clearances| &clearances[index]);
                let of_each = |i: usize| clearance.map(|clearance: &Clearance| clearance.pedestrians[i]);
                let pedestrians = risk.pedestrians.iter().enumerate().filter(|(i, _)| Some(*i) != ego);
                lines.push(PlanLine {
                    scene: moment.scene,
                    observed_until: moment.observed_until(),
                    plan: name,
                    within: self.within,
                    risk: risk.total,
                    nearest: clearance.map(|clearance| clearance.nearest),
                    steps: risk.steps,
                    until: risk.until,
                    pedestrians: pedestrians
                        .map(|(i, &risk)| PedestrianRisk {
                            pedestrian: moment.window.name(i),
                            risk,
                            nearest: of_each(i),
                        })
                        .collect(),
                });
            }
        }
        match self.stream.format(self.format) {
            OutputFormat::Csv => self.csv(&lines, state.is_first_text()),
            OutputFormat::Jsonl => {
                state.is_first_text();
                lines.iter().map(|line| Ok(serde_json::to_string(line)? + "\n")).collect()
            }
        }
    }
}
