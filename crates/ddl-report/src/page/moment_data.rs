//! Moments as compact JSON: whole millimetres, differences along a path.
//!
//! ```text
//! observed  [x0, y0, dx, dy, ...]   the first position, then steps             mm
//! truth     [dx, dy, ...]           steps from the last observed position      mm; at most 12
//! paths     [[dx, dy, ...], ...]    the same for each hypothesis               mm
//! goals     [[dx, dy] or null, ...] from the last observed position            mm
//! weights   [...]                   thousandths
//! radii     [[...], ...]            of the discs of the 90 % region, by step, mm; absent without regions
//! familiarity                       thousandths; absent where unknown
//! representative                    index of the representative hypothesis
//! falls, certified                  one letter for each hypothesis: y, n, - (unknown)
//! quality                           how well it was observed; absent where nothing was estimated
//! ```
//!
//! `when`, `joint` and `groups` of a moment are absent where the snapshot has none.
//!
//! Positions of moments are whole millimetres, so the encoding is exact: `x / 1000` is the original number.

use crate::error::ReportError;
use crate::snapshot::{ForecastSnapshot, SnapshotHypothesis, SnapshotPedestrian};
use ddl_core::{HORIZON, OBSERVED, ObservationQuality, PedestrianName, Position};
use serde::Serialize;

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct MomentData<'a> {
    fold: &'a str,
    forecaster: &'a str,
    recording: &'a str,
    frame: i64,
    #[serde(skip_serializing_if = "Option::is_none")]
    when: Option<&'a str>,
    frame_step: i64,
    pedestrians: Vec<PedestrianData<'a>>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    joint: bool,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    groups: &'a [Vec<usize>],
}

#[derive(Serialize)]
struct PedestrianData<'a> {
    pedestrian: &'a PedestrianName,
    observed: Vec<i64>,
    truth: Vec<i64>,
    paths: Vec<Vec<i64>>,
    goals: Vec<Option<[i64; 2]>>,
    weights: Vec<i64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    radii: Vec<Vec<i64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    familiarity: Option<i64>,
    representative: usize,
    falls: String,
    certified: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    quality: Option<ObservationQuality>,
}

pub(super) fn to_json(moments: &[ForecastSnapshot]) -> Result<String, ReportError> {
    let lines = moments.iter().map(|moment| {
        serde_json::to_string(&MomentData {
            fold: &moment.fold,
            forecaster: &moment.forecaster,
            recording: &moment.recording,
            frame: moment.frame,
            when: moment.when.as_deref(),
            frame_step: moment.frame_step,
            pedestrians: moment.pedestrians.iter().map(PedestrianData::of).collect(),
            joint: moment.joint,
            groups: &moment.groups,
        })
    });
    let lines: Vec<String> = lines.collect::<Result<_, _>>()?;
    Ok(format!("[{}]", lines.join(",\n")))
}

impl<'a> PedestrianData<'a> {
    fn of(pedestrian: &'a SnapshotPedestrian) -> Self {
        let last = pedestrian.observed[OBSERVED - 1];
        let hypotheses = &pedestrian.hypotheses;
        let letter = |verdict: Option<bool>| verdict.map_or('-', |yes| if yes { 'y' } else { 'n' });
        let letters =
            |verdict: fn(&SnapshotHypothesis) -> Option<bool>| hypotheses.iter().map(verdict).map(letter).collect();
        Self {
            pedestrian: &pedestrian.pedestrian,
            observed: steps([0.0, 0.0], &pedestrian.observed),
            truth: steps(last, &pedestrian.truth),
            paths: hypotheses.iter().map(|h| steps(last, &h.positions)).collect(),
            goals: hypotheses
                .iter()
                .map(|h| h.goal.map(|goal| [0, 1].map(|axis| mm(goal[axis]) - mm(last[axis]))))
                .collect(),
            weights: hypotheses.iter().map(|h| mm(h.weight)).collect(),
            radii: if hypotheses.iter().all(|h| h.radii.len() == HORIZON) {
                let in_mm = |h: &SnapshotHypothesis| h.radii.iter().map(|&radius| mm(radius)).collect();
                hypotheses.iter().map(in_mm).collect()
            } else {
                Vec::new()
            },
            familiarity: pedestrian.familiarity.map(mm),
            representative: pedestrian.representative(),
            falls: letters(|h| h.decreasing),
            certified: letters(|h| h.certified),
            quality: pedestrian.quality,
        }
    }
}

fn steps(from: Position, path: &[Position]) -> Vec<i64> {
    let mut here = from.map(mm);
    let mut steps = Vec::with_capacity(2 * path.len());
    for next in path.iter().map(|p| p.map(mm)) {
        steps.extend([next[0] - here[0], next[1] - here[1]]);
        here = next;
    }
    steps
}

/// Thousandths: of a metre, or of a weight.
fn mm(value: f64) -> i64 {
    (value * 1e3).round() as i64
}
