//! Whether moments are whole: they may come from a file.

use ddl_core::{COORDINATE_LIMIT, HORIZON, OBSERVED, Position};

use crate::error::ReportError;
use crate::snapshot::{ForecastSnapshot, SnapshotPedestrian};

/// Checks moments whose true futures have at least `truth` positions: [`HORIZON`] where errors are shown.
pub(super) fn check(moments: &[ForecastSnapshot], truth: usize) -> Result<(), ReportError> {
    for (index, moment) in moments.iter().enumerate() {
        check_moment(moment, truth).map_err(|problem| ReportError::Moment {
            index,
            recording: moment.recording.clone(),
            frame: moment.frame,
            problem,
        })?;
    }
    Ok(())
}

fn check_moment(moment: &ForecastSnapshot, truth: usize) -> Result<(), String> {
    let count = moment.pedestrians.len();
    if count == 0 {
        return Err("no pedestrian".to_owned());
    }
    for (index, pedestrian) in moment.pedestrians.iter().enumerate() {
        check_pedestrian(index, pedestrian, truth)?;
    }
    if moment.joint {
        let futures = moment.pedestrians[0].hypotheses.len();
        let differs = |pedestrian: &SnapshotPedestrian| pedestrian.hypotheses.len() != futures;
        if moment.pedestrians.iter().any(differs) {
            return Err("joint futures need the same number of hypotheses of all pedestrians".to_owned());
        }
    }
    if let Some(absent) = moment.groups.iter().flatten().find(|&&member| member >= count) {
        return Err(format!("a group names pedestrian {absent} of {count}, counted from 0"));
    }
    Ok(())
}

fn check_pedestrian(index: usize, pedestrian: &SnapshotPedestrian, truth: usize) -> Result<(), String> {
    if pedestrian.hypotheses.is_empty() {
        return Err("a pedestrian has no hypothesis".to_owned());
    }
    check_path(index, "observed", &pedestrian.observed, OBSERVED)?;
    check_path(index, "truth", &pedestrian.truth, pedestrian.truth.len().clamp(truth, HORIZON))?;
    for (number, hypothesis) in pedestrian.hypotheses.iter().enumerate() {
        check_path(index, "hypotheses", &hypothesis.positions, HORIZON)?;
        check_coordinates(index, "goal", hypothesis.goal.as_slice())?;
        let weight = hypothesis.weight;
        if !(0.0..=1.0).contains(&weight) {
            return Err(format!(
                "hypothesis {number} of pedestrian {index} has the weight {weight}, which is not between 0 and 1"
            ));
        }
    }
    Ok(())
}

fn check_path(index: usize, field: &str, path: &[Position], expected: usize) -> Result<(), String> {
    if path.len() != expected {
        let count = path.len();
        return Err(format!("pedestrian {index} has {count} positions in `{field}`, not {expected}"));
    }
    check_coordinates(index, field, path)
}

/// Millimetres of coordinates within the limit stay far below the largest whole number of an `f64`.
fn check_coordinates(index: usize, field: &str, path: &[Position]) -> Result<(), String> {
    let is_far = |value: &&f64| value.is_nan() || value.abs() > COORDINATE_LIMIT;
    match path.as_flattened().iter().find(is_far) {
        None => Ok(()),
        Some(value) => Err(format!(
            "pedestrian {index} has the coordinate {value} m in `{field}`; coordinates must be within 1000 km of the \
             origin"
        )),
    }
}
