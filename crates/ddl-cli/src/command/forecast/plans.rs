//! Plans from files.

use crate::command::forecast::state::StreamState;
use crate::small_file;
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::GivenPlan;
use ddl::data::{OBSERVED, PedestrianName, Window, distance};
use ddl::scene::{Plan, PlanPoint};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A plan that the pedestrians respond to.
#[derive(Debug, Clone, Args)]
pub(crate) struct GivenPlanOptions {
    /// With --joint: csv of the plan of a robot, `t,x,y` in seconds after the moment and metres; the pedestrians
    /// respond to it. It is read again while a stream runs, so that another program can replace it, by renaming
    /// a whole file
    #[arg(long, value_name = "FILE", requires = "joint", conflicts_with = "certificate")]
    plan: Option<PathBuf>,
    /// With --plan: the pedestrian of the tracks who follows the plan [default: none of them]
    #[arg(long, value_name = "NAME", requires = "plan")]
    pub(crate) ego: Option<String>,
}

impl GivenPlanOptions {
    /// The plan; an error if the file has several.
    pub(crate) fn read(&self) -> anyhow::Result<Option<GivenPlan>> {
        let Some(path) = &self.plan else {
            return Ok(None);
        };
        let mut plans = read_plans(path)?;
        let name = path.display();
        match (plans.pop(), plans.len()) {
            (Some(NamedPlan { plan, .. }), 0) => {
                Ok(Some(GivenPlan { plan, ego: self.ego.as_deref().map(PedestrianName::of_text) }))
            }
            (_, others) => bail!("{name} holds {} plans; the pedestrians can respond to one", others + 1),
        }
    }
}

/// Tells once if the pedestrian who is said to follow the plans is not there, or is far from where they start.
pub(crate) fn tell_doubts_of_ego(ego: Option<&str>, plans: &[&Plan], window: &Window, state: &mut StreamState) {
    let Some(name) = ego else { return };
    let Some(i) = window.named(&PedestrianName::of_text(name)) else {
        state.tell_once(
            "no ego",
            format_args!(
                "note: pedestrian {name} of --ego is missing in some moments; in these the plan is taken to be that of \
                 somebody who is not in the tracks (told once)"
            ),
        );
        return;
    };
    let apart = |plan: &&&Plan| distance(plan.at(0.0).position, window.observed(i)[OBSERVED - 1]);
    if let Some(far) = plans.iter().find(|plan| apart(plan) > FAR) {
        state.tell_once(
            "far ego",
            format_args!(
                "warning: a plan starts {:.1} m from pedestrian {name}, who follows it; give times in seconds after \
                 the moment, and the positions of the tracks (told once)",
                apart(&far)
            ),
        );
    }
}

/// A plan that starts farther than this from the pedestrian who follows it is doubtful, metres.
const FAR: f64 = 2.0;

#[derive(Debug)]
pub(crate) struct NamedPlan {
    /// The text of its column `plan`; empty in a file of one plan.
    pub(crate) name: String,
    pub(crate) plan: Plan,
}

#[derive(Deserialize)]
struct PlanRow {
    #[serde(default)]
    plan: String,
    t: f64,
    x: f64,
    y: f64,
    #[serde(default)]
    radius: Option<f64>,
}

/// The plans of a csv file with the columns `t,x,y`, and where there are `radius` and `plan`: rows of one plan stand
/// together and have one name.
pub(crate) fn read_plans(path: &Path) -> anyhow::Result<Vec<NamedPlan>> {
    let name = path.display();
    let text = small_file::read(path)?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let headers = reader.headers().with_context(|| format!("cannot read the plan {name}"))?.clone();
    for column in ["t", "x", "y"] {
        if !headers.iter().any(|header| header == column) {
            bail!(
                "{name}, line 1: no column `{column}`; a plan has the columns t,x,y (seconds after the moment, \
                 metres), and may have radius and plan"
            );
        }
    }
    let known = ["t", "x", "y", "radius", "plan"];
    if let Some(other) = headers.iter().find(|header| !known.contains(header)) {
        bail!("{name}, line 1: unknown column `{other}`; a plan has the columns {}", known.join(", "));
    }
    let mut plans: Vec<(String, Vec<PlanPoint>)> = Vec::new();
    for row in reader.deserialize() {
        let PlanRow { plan, t, x, y, radius } = row.with_context(|| format!("{name}"))?;
        let point = PlanPoint { time: t, position: [x, y], radius: radius.unwrap_or(0.0) };
        let is_new = plans.last().is_none_or(|(last, _)| *last != plan);
        if is_new && plans.iter().any(|(earlier, _)| *earlier == plan) {
            bail!("{name}: the rows of the plan `{plan}` do not stand together; sort the file by plan, then t");
        }
        match plans.last_mut() {
            Some((_, points)) if !is_new => points.push(point),
            _ => plans.push((plan, vec![point])),
        }
    }
    if plans.is_empty() {
        bail!("{name} holds no rows; a plan has at least one row of t,x,y");
    }
    let checked = plans.into_iter().map(|(plan, points)| {
        let of = if plan.is_empty() { String::new() } else { format!(", plan `{plan}`") };
        let checked = Plan::new(points).with_context(|| format!("{name}{of}"))?;
        Ok(NamedPlan { name: plan, plan: checked })
    });
    checked.collect()
}
