//! Forecasts as JSON lines: one object for each pedestrian, in the format that `ddl evaluate --forecasts` reads.

use crate::command::forecast::moment::Moment;
use ddl::data::{FrameNumber, HORIZON, PedestrianName, SceneName};
use ddl::dynamics::{LyapunovCertificate, Violation};
use serde::Serialize;

#[derive(Serialize)]
struct PedestrianLine<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<&'a SceneName>,
    observed_until: FrameNumber,
    pedestrian: PedestrianName,
    /// Number of positions before its first row.
    unseen: usize,
    /// Time since its last row, s.
    age: f64,
    /// Standard deviation that the observation adds at the end of the forecast, m.
    uncertainty: f64,
    frames: Vec<FrameNumber>,
    /// Familiarity of the observed motion, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    familiarity: Option<f64>,
    /// Scale of Student's t with 3 degrees of freedom around the right hypothesis at each step, metres.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    spread: Vec<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    regions: Vec<Region>,
    hypotheses: Vec<Hypothesis<'a>>,
}

/// A region that contains the pedestrian with this probability: the union of discs at each step, x, y and radius (m).
#[derive(Serialize)]
struct Region {
    probability: f64,
    discs: Vec<Vec<[f64; 3]>>,
}

impl Region {
    fn of(forecast: &ddl::Forecast, i: usize, probability: f64) -> Option<Self> {
        let discs = |t: usize| {
            let region = forecast.region(i, t, probability)?;
            let disc = |disc: &ddl::Disc| [disc.centre[0], disc.centre[1], disc.radius];
            Some(region.iter().map(disc).collect())
        };
        let discs = (0..HORIZON).map(discs).collect::<Option<_>>()?;
        Some(Self { probability, discs })
    }
}

#[derive(Serialize)]
struct Hypothesis<'a> {
    weight: f64,
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

pub(super) fn json_lines(moments: &[Moment<'_>], regions: &[f64]) -> anyhow::Result<String> {
    let mut text = String::new();
    for moment in moments {
        let forecast = moment.forecast;
        for i in 0..moment.window.len() {
            let hypotheses = (0..forecast.hypotheses())
                .map(|k| Hypothesis {
                    weight: forecast.weight(i, k),
                    goal: forecast.goal(i, k),
                    positions: forecast.hypothesis(i, k),
                    certificate: moment.certificate(i, k).map(Certificate::of),
                })
                .collect();
            let quality = moment.window.quality(i);
            let line = PedestrianLine {
                scene: moment.scene,
                observed_until: moment.observed_until(),
                pedestrian: moment.window.name(i),
                unseen: quality.unseen,
                age: quality.age,
                uncertainty: quality.uncertainty(),
                frames: moment.frames(),
                familiarity: forecast.familiarity(i),
                spread: (0..HORIZON).filter_map(|t| forecast.scale(i, t)).collect(),
                regions: regions
                    .iter()
                    .filter_map(|&probability| Region::of(forecast, i, probability))
                    .collect(),
                hypotheses,
            };
            text += &serde_json::to_string(&line)?;
            text.push('\n');
        }
    }
    Ok(text)
}
