//! Forecasts as JSON lines: one object for each pedestrian, in the format that `ddl evaluate --forecasts` reads; of
//! joint futures one object for each moment.

use crate::tracks::moment::Moment;
use crate::tracks::wanted_regions::WantedRegions;
use ddl_core::{Disc, Forecast, HORIZON, Holding, PedestrianName};
use ddl_data::{FrameNumber, SceneName};
use ddl_dynamics::{LyapunovCertificate, Violation};
use ddl_scene::{Futures, ScenePart};
use serde::Serialize;

/// What is known of a moment.
#[derive(Serialize)]
struct MomentHead<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<&'a SceneName>,
    observed_until: FrameNumber,
}

#[derive(Serialize)]
struct PedestrianLine<'a> {
    #[serde(flatten)]
    moment: MomentHead<'a>,
    #[serde(flatten)]
    pedestrian: ObservedPedestrian,
    frames: Vec<FrameNumber>,
    hypotheses: Vec<Hypothesis<'a>>,
}

#[derive(Serialize)]
struct SceneLine<'a> {
    #[serde(flatten)]
    moment: MomentHead<'a>,
    frames: Vec<FrameNumber>,
    pedestrians: Vec<ObservedPedestrian>,
    /// Names of pedestrians who walk together.
    groups: Vec<Vec<PedestrianName>>,
    /// Names of pedestrians who may influence each other; different parts are independent.
    parts: Vec<Vec<PedestrianName>>,
    futures: Vec<Future<'a>>,
}

/// A joint future; its paths are in the order of the pedestrians.
#[derive(Serialize)]
struct Future<'a> {
    weight: f64,
    paths: Vec<PathLine<'a>>,
}

#[derive(Serialize)]
struct ObservedPedestrian {
    pedestrian: PedestrianName,
    /// Number of positions before its first row.
    unseen: usize,
    /// Time since its last row, s.
    age: f64,
    /// Standard deviation that the observation adds at the end of the forecast, m.
    uncertainty: f64,
    /// Familiarity of the observed motion, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    familiarity: Option<f64>,
    /// Scale of Student's t with 3 degrees of freedom around the right hypothesis at each step, metres.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    spread: Vec<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    regions: Vec<Region>,
}

impl ObservedPedestrian {
    fn of(moment: &Moment<'_>, i: usize, regions: WantedRegions<'_>, held: Option<&Forecast>) -> Self {
        let (forecast, quality) = (moment.answer.forecast(), moment.window.quality(i));
        let regions = regions.levels.iter().filter_map(|&level| Region::of(held?, i, level, regions.holding));
        Self {
            pedestrian: moment.window.name(i),
            unseen: quality.unseen,
            age: quality.age,
            uncertainty: quality.uncertainty(),
            familiarity: forecast.familiarity(i),
            spread: (0..HORIZON).filter_map(|t| forecast.scale(i, t)).collect(),
            regions: regions.collect(),
        }
    }
}

/// A region that contains the pedestrian with this probability: the union of discs at each step, x, y and radius (m).
#[derive(Serialize)]
struct Region {
    probability: f64,
    /// Absent for single steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    holds: Option<&'static str>,
    discs: Vec<Vec<[f64; 3]>>,
}

impl Region {
    fn of(forecast: &Forecast, i: usize, probability: f64, holding: Holding) -> Option<Self> {
        let discs = |t: usize| {
            let region = forecast.region(i, t, probability)?;
            Some(region.iter().map(|disc: &Disc| [disc.centre[0], disc.centre[1], disc.radius]).collect())
        };
        let discs = (0..HORIZON).map(discs).collect::<Option<_>>()?;
        let holds = (holding != Holding::Step).then(|| holding.name());
        Some(Self { probability, holds, discs })
    }
}

#[derive(Serialize)]
struct Hypothesis<'a> {
    weight: f64,
    #[serde(flatten)]
    path: PathLine<'a>,
}

#[derive(Serialize)]
struct PathLine<'a> {
    goal: Option<[f64; 2]>,
    positions: &'a [[f64; 2]],
    #[serde(skip_serializing_if = "Option::is_none")]
    certificate: Option<Certificate<'a>>,
}

#[derive(Serialize)]
struct Certificate<'a> {
    holds: bool,
    violation: Option<Violation>,
    min_eigenvalue: Option<f64>,
    min_step_margin: Option<f64>,
    largest_angle: f64,
    #[serde(flatten)]
    evidence: &'a LyapunovCertificate<f64>,
}

impl<'a> Certificate<'a> {
    fn of(evidence: &'a LyapunovCertificate<f64>) -> Self {
        let violation = evidence.verify().err();
        Self {
            holds: violation.is_none(),
            violation,
            min_eigenvalue: evidence.min_eigenvalue(),
            min_step_margin: evidence.min_step_margin(),
            largest_angle: evidence.largest_angle(),
            evidence,
        }
    }
}

impl<'a> PathLine<'a> {
    fn of(moment: &Moment<'a>, i: usize, k: usize) -> Self {
        Self {
            goal: moment.answer.forecast().goal(i, k),
            positions: moment.answer.forecast().hypothesis(i, k),
            certificate: moment.answer.certificate(i, k).map(Certificate::of),
        }
    }
}

impl<'a> MomentHead<'a> {
    fn of(moment: &Moment<'a>) -> Self {
        Self { scene: moment.scene, observed_until: moment.observed_until() }
    }
}

/// One object for each pedestrian and moment, of joint futures one for each moment, with regions of these
/// probabilities; fields as in `docs/program.md`.
///
/// # Errors
/// A number that JSON does not have.
pub fn json_lines(moments: &[Moment<'_>], regions: WantedRegions<'_>) -> Result<String, serde_json::Error> {
    let mut text = String::new();
    for moment in moments {
        if moment.answer.is_joint() {
            add_line(&scene_line(moment, regions), &mut text)?;
            continue;
        }
        let forecast = moment.answer.forecast();
        let held = regions.of(forecast);
        for i in 0..moment.window.len() {
            let hypotheses = (0..forecast.hypotheses())
                .map(|k| Hypothesis { weight: forecast.weight(i, k), path: PathLine::of(moment, i, k) });
            let line = PedestrianLine {
                moment: MomentHead::of(moment),
                pedestrian: ObservedPedestrian::of(moment, i, regions, held.as_deref()),
                frames: moment.frames(),
                hypotheses: hypotheses.collect(),
            };
            add_line(&line, &mut text)?;
        }
    }
    Ok(text)
}

fn scene_line<'a>(moment: &Moment<'a>, regions: WantedRegions<'_>) -> SceneLine<'a> {
    let (pedestrians, forecast) = (0..moment.window.len(), moment.answer.forecast());
    let futures = (0..forecast.hypotheses()).map(|k| Future {
        weight: forecast.weight(0, k),
        paths: pedestrians.clone().map(|i| PathLine::of(moment, i, k)).collect(),
    });
    let held = regions.of(forecast);
    let futures_of_scene = moment.answer.futures().ok();
    let parts = futures_of_scene.map_or(&[][..], Futures::parts).iter().map(ScenePart::pedestrians);
    let names = |members: &[usize]| members.iter().map(|&i| moment.window.name(i)).collect();
    SceneLine {
        moment: MomentHead::of(moment),
        frames: moment.frames(),
        futures: futures.collect(),
        groups: futures_of_scene.map_or(&[][..], Futures::groups).iter().map(|group| names(group)).collect(),
        parts: parts.map(names).collect(),
        pedestrians: pedestrians.map(|i| ObservedPedestrian::of(moment, i, regions, held.as_deref())).collect(),
    }
}

fn add_line(line: &impl Serialize, text: &mut String) -> Result<(), serde_json::Error> {
    *text += &serde_json::to_string(line)?;
    text.push('\n');
    Ok(())
}
