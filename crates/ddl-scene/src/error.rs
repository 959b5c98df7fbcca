//! Errors of this crate.

use ddl_core::Setting;

/// A forecast is not one of joint futures, does not belong to its window, or cannot answer what was asked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum SceneError {
    #[error("the window holds {window} pedestrians, its forecast {forecast}")]
    Pedestrians { window: usize, forecast: usize },
    #[error(
        "hypothesis {future} has the weight {found} for pedestrian {pedestrian} and {expected} for pedestrian 0: joint \
         futures have one weight for the whole scene; make them with the joint forecast of a model"
    )]
    NotJoint { future: usize, pedestrian: usize, expected: f64, found: f64 },
    #[error("risk and occupancy are of joint futures; these are forecasts of each pedestrian alone")]
    Alone,
    #[error(
        "the people of these futures already keep away from the plan that they were given: ask for the risk of \
         plans that nobody sees ({})",
        Setting::Unseen
    )]
    PlanGiven,
    #[error("a forecast without spread has no risk and no occupancy; make it with all hypotheses of a model")]
    NoSpread,
    #[error("a forecast of {found} hypotheses has no joint futures; at most {most} hypotheses: train with fewer goals")]
    Hypotheses { found: usize, most: usize },
    #[error("{name} is {value}; it must be {expected}")]
    Number { name: &'static str, value: f64, expected: &'static str },
    #[error(
        "an area of {width} x {height} m in cells of {cell} m has more than {most} cells: take larger cells, or a \
         smaller area"
    )]
    Cells { width: f64, height: f64, cell: f64, most: usize },
}

/// A plan cannot be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum PlanError {
    #[error("a plan needs at least one row of time, x and y")]
    Empty,
    #[error("row {row} of the plan: {field} is {value}; it must be a finite number{more}")]
    Number { row: usize, field: &'static str, value: f64, more: &'static str },
    #[error("row {row} of the plan: time {time} s does not come after {before} s; sort the rows by time")]
    Order { row: usize, time: f64, before: f64 },
    #[error(
        "the plan is from {first} s to {last} s; forecasts reach from 0 to 4.8 s after the moment: give times in \
         seconds from the moment, not those of a clock and not milliseconds"
    )]
    OutOfHorizon { first: f64, last: f64 },
}
