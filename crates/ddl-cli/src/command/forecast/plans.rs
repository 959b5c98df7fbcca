//! Plans from files.

use crate::command::forecast::state::StreamState;
use crate::small_file;
use crate::telling::{tell, words};
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::GivenPlan;
use ddl::data::PedestrianName;
use ddl::scene::{Plan, PlanPoint};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::rc::Rc;

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
    ego: Option<String>,
}

impl GivenPlanOptions {
    /// Reads the plan for the first time.
    pub(super) fn open(&self, state: &mut StreamState) -> anyhow::Result<()> {
        if let Some(path) = &self.plan {
            state.plans = PlanFile::open(path, true)?;
        }
        Ok(())
    }

    /// The plan as the file has it now.
    pub(super) fn now(&self, state: &mut StreamState) -> Option<GivenPlan> {
        let NamedPlan { plan, .. } = state.plans.read().first()?.clone();
        Some(GivenPlan { plan, ego: self.ego.as_deref().map(PedestrianName::of_text) })
    }
}

/// A file of plans that another program may replace at any time; no plans without a file.
#[derive(Debug, Default)]
pub(crate) struct PlanFile {
    path: PathBuf,
    holds_one: bool,
    /// The last text that could be read, and its plans.
    text: String,
    plans: Rc<[NamedPlan]>,
    /// Whether their last line had an end. Then one without is not whole.
    is_ended: bool,
    has_changed: bool,
    /// Why the file cannot be read now, as was told; empty if it can.
    fault: String,
}

impl PlanFile {
    pub(crate) fn open(path: &Path, holds_one: bool) -> anyhow::Result<Self> {
        let mut opened = Self { path: path.to_owned(), holds_one, ..Self::default() };
        opened.read_now()?;
        Ok(opened)
    }

    /// The plans as the file has them now. Of a file that is missing or half written, those before, which is told until
    /// it can be read again.
    pub(crate) fn read(&mut self) -> Rc<[NamedPlan]> {
        if !self.plans.is_empty() {
            let fault = self.read_now().err().map(|error| words(&error)).unwrap_or_default();
            if !fault.is_empty() && self.fault.is_empty() {
                tell(format_args!("warning: {fault}; the plan before goes on counting until the file can be read"));
            }
            self.fault = fault;
        }
        Rc::clone(&self.plans)
    }

    /// Whether the plans are others than at the last call.
    pub(super) fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.has_changed)
    }

    fn read_now(&mut self) -> anyhow::Result<()> {
        let (path, text) = (&self.path, small_file::read(&self.path)?);
        let is_ended = text.ends_with('\n');
        if self.is_ended && !is_ended {
            bail!("{}: the last line has no end, so the file is not whole", path.display());
        }
        let plans = plans_of(path, &text)?;
        if self.holds_one && plans.len() > 1 {
            bail!("{} holds {} plans; the pedestrians can respond to one", path.display(), plans.len());
        }
        self.has_changed |= self.text != text;
        (self.plans, self.is_ended, self.text) = (plans.into(), is_ended, text);
        Ok(())
    }
}

#[derive(Debug, Clone)]
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
fn plans_of(path: &Path, text: &str) -> anyhow::Result<Vec<NamedPlan>> {
    let name = path.display();
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
