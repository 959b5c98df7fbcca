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
//! made_up                           number of observed positions that were filled in; absent where it is 0
//! ```
//!
//! Positions of moments are whole millimetres, so the encoding is exact: `x / 1000` is the original number.

use ddl_data::{CompletionCounts, HORIZON, OBSERVED, PedestrianName, Position};
use serde::Serialize;

use super::error::{PageError, SnapshotProblem};
use crate::{ForecastSnapshot, SnapshotHypothesis, SnapshotPedestrian, gallery::Highlight};

/// Largest absolute coordinate, m: millimetres stay far below the largest whole number of an `f64`.
const REACH: f64 = ddl_data::COORDINATE_LIMIT;

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct MomentData<'a> {
    fold: &'a str,
    forecaster: &'a str,
    recording: &'a str,
    frame: i64,
    frame_step: i64,
    picks: &'a [Highlight],
    #[serde(rename = "pedestrians")]
    pedestrians: Vec<PedestrianData<'a>>,
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
    made_up: Option<CompletionCounts>,
}

/// The part of the true future that is required.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Truth {
    /// All positions, because errors are shown.
    Whole,
    /// Any number of positions.
    AsSeen,
}

pub(super) fn check(moments: &[ForecastSnapshot], truth: Truth) -> Result<(), PageError> {
    for (index, moment) in moments.iter().enumerate() {
        problem(moment, truth).map_or(Ok(()), |problem| {
            Err(PageError::Moment {
                index,
                recording: moment.recording.clone(),
                frame: moment.frame,
                problem: problem.to_string(),
            })
        })?;
    }
    Ok(())
}

fn problem(moment: &ForecastSnapshot, truth: Truth) -> Option<SnapshotProblem> {
    if moment.pedestrians.is_empty() {
        return Some(SnapshotProblem::Empty("no pedestrian"));
    }
    let people = moment.pedestrians.len();
    let absent = |pick: &Highlight| {
        let pedestrian = *pick.pedestrians.iter().find(|&&one| one >= people)?;
        Some(SnapshotProblem::Highlight {
            show: pick.show,
            pedestrian,
            pedestrians: people,
        })
    };
    let mut numbered = moment.pedestrians.iter().enumerate();
    numbered
        .find_map(|(pedestrian, who)| of_pedestrian(pedestrian, who, truth))
        .or_else(|| moment.picks.iter().find_map(absent))
}

fn of_pedestrian(pedestrian: usize, who: &SnapshotPedestrian, truth: Truth) -> Option<SnapshotProblem> {
    if who.hypotheses.is_empty() {
        return Some(SnapshotProblem::Empty("a pedestrian has no hypothesis"));
    }
    let path = |field, path: &[Position], expected| {
        if path.len() != expected {
            let found = path.len();
            return Some(SnapshotProblem::Length {
                pedestrian,
                field,
                expected,
                found,
            });
        }
        place(pedestrian, field, path)
    };
    path("observed", &who.observed, OBSERVED)
        .or_else(|| {
            let expected = match truth {
                Truth::Whole => HORIZON,
                Truth::AsSeen => who.truth.len().min(HORIZON),
            };
            path("truth", &who.truth, expected)
        })
        .or_else(|| {
            let mut numbered = who.hypotheses.iter().enumerate();
            numbered.find_map(|(hypothesis, of)| {
                let goal = of.goal.as_slice();
                path("hypotheses", &of.positions, HORIZON)
                    .or_else(|| place(pedestrian, "goal", goal))
                    .or_else(|| {
                        (!(0.0..=1.0).contains(&of.weight)).then_some(SnapshotProblem::Weight {
                            pedestrian,
                            hypothesis,
                            weight: of.weight,
                        })
                    })
            })
        })
}

fn place(pedestrian: usize, field: &'static str, path: &[Position]) -> Option<SnapshotProblem> {
    let value = *path
        .as_flattened()
        .iter()
        .find(|value| value.is_nan() || value.abs() > REACH)?;
    Some(SnapshotProblem::Coordinate {
        pedestrian,
        field,
        value,
    })
}

pub(super) fn to_json(moments: &[ForecastSnapshot]) -> Result<String, PageError> {
    let lines: Vec<String> = moments
        .iter()
        .map(|moment| serde_json::to_string(&MomentData::of(moment)))
        .collect::<Result<_, _>>()?;
    Ok(format!("[{}]", lines.join(",\n")))
}

impl<'a> MomentData<'a> {
    fn of(moment: &'a ForecastSnapshot) -> Self {
        Self {
            fold: &moment.fold,
            forecaster: &moment.forecaster,
            recording: &moment.recording,
            frame: moment.frame,
            frame_step: moment.frame_step,
            picks: &moment.picks,
            pedestrians: moment.pedestrians.iter().map(PedestrianData::of).collect(),
        }
    }
}

impl<'a> PedestrianData<'a> {
    fn of(pedestrian: &'a SnapshotPedestrian) -> Self {
        let last = pedestrian.observed[OBSERVED - 1];
        let all = &pedestrian.hypotheses;
        let letters = |of: fn(&SnapshotHypothesis) -> Option<bool>| all.iter().map(of).map(letter).collect();
        Self {
            pedestrian: &pedestrian.pedestrian,
            observed: steps([0.0, 0.0], &pedestrian.observed),
            truth: steps(last, &pedestrian.truth),
            paths: all.iter().map(|h| steps(last, &h.positions)).collect(),
            goals: all
                .iter()
                .map(|h| h.goal.map(|goal| [0, 1].map(|axis| mm(goal[axis]) - mm(last[axis]))))
                .collect(),
            weights: all.iter().map(|h| mm(h.weight)).collect(),
            radii: if all.iter().all(|h| h.radii.len() == HORIZON) {
                let in_mm = |h: &SnapshotHypothesis| h.radii.iter().map(|&radius| mm(radius)).collect();
                all.iter().map(in_mm).collect()
            } else {
                Vec::new()
            },
            familiarity: pedestrian.familiarity.map(mm),
            representative: pedestrian.representative(),
            falls: letters(|h| h.decreasing),
            certified: letters(|h| h.certified),
            made_up: pedestrian.made_up,
        }
    }
}

fn letter(verdict: Option<bool>) -> char {
    verdict.map_or('-', |yes| if yes { 'y' } else { 'n' })
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
