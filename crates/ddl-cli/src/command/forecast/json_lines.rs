//! Forecasts as JSON lines: an object a pedestrian, in the format that `ddl evaluate --forecasts` reads.

use super::Moment;
use crate::clock::FrameNumber;
use ddl::dynamics::{LyapunovCertificate, Violation};
use serde::Serialize;

/// All hypotheses of a pedestrian.
#[derive(Serialize)]
struct Line<'a> {
    observed_until: FrameNumber,
    pedestrian: i64,
    /// Positions before the first that was seen, and in holes.
    padded: usize,
    filled: usize,
    frames: Vec<FrameNumber>,
    hypotheses: Vec<Hypothesis<'a>>,
}

#[derive(Serialize)]
struct Hypothesis<'a> {
    weight: f64,
    goal: Option<[f64; 2]>,
    positions: &'a [[f64; 2]],
    #[serde(skip_serializing_if = "Option::is_none")]
    certificate: Option<Certificate<'a>>,
}

/// The verdict of a certificate, its figures in short, and the certificate itself.
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
        let violation = evidence.holds().err();
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

pub(super) fn json_lines(moments: &[Moment<'_>]) -> anyhow::Result<String> {
    let mut text = String::new();
    for moment in moments {
        let forecast = moment.forecast;
        for (i, pedestrian) in moment.window.pedestrians().iter().enumerate() {
            let hypotheses = (0..forecast.hypotheses())
                .map(|k| Hypothesis {
                    weight: forecast.weight(i, k),
                    goal: forecast.goal(i, k),
                    positions: forecast.hypothesis(i, k),
                    certificate: moment.certificate(i, k).map(Certificate::of),
                })
                .collect();
            let made_up = moment.window.made_up(i);
            let line = Line {
                observed_until: moment.observed_until(),
                pedestrian: pedestrian.0,
                padded: made_up.padded,
                filled: made_up.filled,
                frames: moment.frames(),
                hypotheses,
            };
            text += &serde_json::to_string(&line)?;
            text.push('\n');
        }
    }
    Ok(text)
}
