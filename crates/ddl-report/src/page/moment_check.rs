//! Whether moments are whole: they may come from a file.

use crate::error::{MomentFault, ReportError};
use crate::snapshot::{ForecastSnapshot, SnapshotPedestrian};
use ddl_core::{COORDINATE_LIMIT, HORIZON, OBSERVED, Position};

/// Checks moments whose true futures have at least `truth` positions: [`HORIZON`] where errors are shown.
pub(super) fn check(moments: &[ForecastSnapshot], truth: usize) -> Result<(), ReportError> {
    for (index, moment) in moments.iter().enumerate() {
        check_moment(moment, truth).map_err(|fault| ReportError::Moment {
            index,
            recording: moment.recording.clone(),
            frame: moment.frame,
            fault,
        })?;
    }
    Ok(())
}

fn check_moment(moment: &ForecastSnapshot, truth: usize) -> Result<(), MomentFault> {
    let count = moment.pedestrians.len();
    if count == 0 {
        return Err(MomentFault::NoPedestrian);
    }
    for (index, pedestrian) in moment.pedestrians.iter().enumerate() {
        check_pedestrian(index, pedestrian, truth)?;
    }
    if moment.joint {
        let futures = moment.pedestrians[0].hypotheses.len();
        if moment.pedestrians.iter().any(|pedestrian: &SnapshotPedestrian| pedestrian.hypotheses.len() != futures) {
            return Err(MomentFault::JointFutures);
        }
    }
    if let Some(&member) = moment.groups.iter().flatten().find(|&&member| member >= count) {
        return Err(MomentFault::Group { member, count });
    }
    Ok(())
}

fn check_pedestrian(index: usize, pedestrian: &SnapshotPedestrian, truth: usize) -> Result<(), MomentFault> {
    if pedestrian.hypotheses.is_empty() {
        return Err(MomentFault::NoHypothesis);
    }
    check_path(index, "observed", &pedestrian.observed, OBSERVED)?;
    check_path(index, "truth", &pedestrian.truth, pedestrian.truth.len().clamp(truth, HORIZON))?;
    for (hypothesis, found) in pedestrian.hypotheses.iter().enumerate() {
        check_path(index, "hypotheses", &found.positions, HORIZON)?;
        check_coordinates(index, "goal", found.goal.as_slice())?;
        let weight = found.weight;
        if !(0.0..=1.0).contains(&weight) {
            return Err(MomentFault::Weight { hypothesis, pedestrian: index, weight });
        }
    }
    Ok(())
}

fn check_path(pedestrian: usize, field: &'static str, path: &[Position], expected: usize) -> Result<(), MomentFault> {
    if path.len() != expected {
        return Err(MomentFault::Length { pedestrian, field, count: path.len(), expected });
    }
    check_coordinates(pedestrian, field, path)
}

/// Millimetres of coordinates within the limit stay far below the largest whole number of an `f64`.
fn check_coordinates(pedestrian: usize, field: &'static str, path: &[Position]) -> Result<(), MomentFault> {
    match path.as_flattened().iter().find(|value: &&f64| value.is_nan() || value.abs() > COORDINATE_LIMIT) {
        None => Ok(()),
        Some(&value) => Err(MomentFault::Coordinate { pedestrian, field, value }),
    }
}
