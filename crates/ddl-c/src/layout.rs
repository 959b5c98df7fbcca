//! The types of `ddl.h`.

#![allow(non_camel_case_types, reason = "names of C")]

use std::ffi::c_char;

/// What a call returns. `ddl_last_error` has the words.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ddl_status {
    /// It has done what was asked.
    OK = 0,
    /// An argument is wrong: a null pointer, a number, a plan, a frame out of order. Nothing has changed.
    INVALID = 1,
    /// A file is missing, unreadable, or does not hold what it should.
    FILE = 2,
    /// A defect of the library. Free the handles of the call; others are unharmed.
    DEFECT = 3,
}

/// A position on the ground, metres.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ddl_point {
    /// Along the first axis.
    pub x: f64,
    /// Along the second axis.
    pub y: f64,
}

/// Where a tracker sees a pedestrian.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ddl_observation {
    /// Any number, the same as long as it is the same pedestrian.
    pub id: i64,
    /// Metres.
    pub position: ddl_point,
}

/// A row of a plan.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ddl_plan_point {
    /// Seconds after the moment of the forecast, ascending.
    pub time: f64,
    /// Metres.
    pub position: ddl_point,
    /// Radius of the robot or person that follows the plan, metres.
    pub radius: f64,
}

/// The path of a robot over time, with straight lines between its rows.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct ddl_plan {
    /// The rows.
    pub points: *const ddl_plan_point,
    /// Their number.
    pub count: usize,
}

/// How a place is observed. All zero: times in seconds, pedestrians from the first row on, every frame, no memory.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct ddl_live_options<'a> {
    /// Frames per second, if frames are numbered; 0 if they have times in seconds.
    pub rate: f64,
    /// The file of the memory of the place, which is made if there is none; null without a memory.
    pub memory: *const c_char,
    /// Only pedestrians tracked for all 8 steps.
    pub whole: bool,
    /// For so long (s, 0 to 2) a pedestrian without a new row is carried on; null: for 0.4 s, or as its rows come.
    pub max_age: Option<&'a f64>,
    /// Seconds (0 to 2) between two forecasts; 0 for one at every frame. All frames count for the observation.
    pub every: f64,
}

/// What is forecast. All zero, or null instead of it: the hypotheses of each pedestrian alone.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct ddl_request<'a> {
    /// Futures of the whole scene instead, for risk and occupancy: hypothesis k of every pedestrian is future k.
    pub joint: bool,
    /// With `joint`: a plan that the pedestrians respond to; all zero without one.
    pub plan: ddl_plan,
    /// The id of the pedestrian who follows that plan; null if it is somebody else, such as a robot. In a live frame
    /// without this pedestrian it is somebody else too.
    pub ego: Option<&'a i64>,
}

/// A pedestrian whose row does not fit its track: it is left out, or begins the track anew.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ddl_misfit {
    /// The pedestrian.
    pub id: i64,
    /// Distance from where it was expected, metres.
    pub distance: f64,
}

/// A forecast of N pedestrians with K hypotheses of 12 positions, 0.4 s apart: arrays in C order, valid until the next
/// forecast of the same handle. An array that does not apply is null.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct ddl_view {
    /// Whether the forecast was made at the last frame. False between two forecasts (option `every`): it is then of an
    /// earlier frame; misfits, memory and warning are always of the last frame.
    pub due: bool,
    /// N, the number of pedestrians that are forecast; may be 0. Who is where nobody can be is not: see the misfits.
    pub pedestrians: usize,
    /// K.
    pub hypotheses: usize,
    /// `[N]`.
    pub ids: *const i64,
    /// `[N][8]`: the observation that it is made from, 0.4 s apart.
    pub past: *const ddl_point,
    /// `[N]`: seconds since the last row.
    pub age: *const f64,
    /// `[N]`: what the observation adds to the error after 4.8 s, metres.
    pub uncertainty: *const f64,
    /// `[N][K][12]`.
    pub paths: *const ddl_point,
    /// `[N][K]`; they sum to 1 for each pedestrian.
    pub weights: *const f64,
    /// `[N][K]`.
    pub goals: *const ddl_point,
    /// `[N][K]`: the verdict of the certificate: the distance to the goal falls at every step, and the bounds are kept.
    pub certified: *const bool,
    /// `[N]`: share of training motions that are at least as unusual as the observed one.
    pub familiarity: *const f64,
    /// `[N][12]`: scale of Student's t, three degrees of freedom, around the hypothesis that is followed, metres.
    pub spread: *const f64,
    /// `[misfit_count]`: rows that this frame showed to be wrong, and tracks that it began anew.
    pub misfits: *const ddl_misfit,
    /// Their number.
    pub misfit_count: usize,
    /// Segments in the memory of the place; 0 without one.
    pub remembered: usize,
    /// What is wrong with the memory of the place, or doubtful of the plan, though there is a forecast; null if
    /// nothing.
    pub warning: *const c_char,
}

/// The risk of P plans: probabilities that somebody comes close within 4.8 s.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct ddl_risks {
    /// P.
    pub plans: usize,
    /// N.
    pub pedestrians: usize,
    /// `[P]`: that anybody does.
    pub total: *const f64,
    /// `[P][N]`: that this pedestrian does.
    pub of_each: *const f64,
    /// `[P][12]`: that somebody is close during this step.
    pub steps: *const f64,
    /// `[P][12]`: that somebody was close by the end of this step.
    pub until: *const f64,
    /// What is doubtful of the plans, which are counted from 0: their unit, times or place. Null if nothing is.
    pub warning: *const c_char,
}

/// The cells and times of an occupancy.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ddl_cells<'a> {
    /// Side of a cell, metres; above 0.
    pub cell: f64,
    /// Seconds between two grids; the first is at the moment itself.
    pub every: f64,
    /// Radius of a pedestrian, metres; 0.2 if nothing else is known.
    pub radius: f64,
    /// Two corners, the lowest x and y first; null for the smallest area around all paths.
    pub corners: Option<&'a [ddl_point; 2]>,
    /// Metres around all paths, without corners.
    pub margin: f64,
}

/// Probabilities that a pedestrian covers the middle of a cell.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct ddl_occupancy {
    /// Number of grids.
    pub times: usize,
    /// Cells along x.
    pub width: usize,
    /// Cells along y.
    pub height: usize,
    /// The corner with the lowest x and y.
    pub origin: ddl_point,
    /// Side of a cell, metres.
    pub cell: f64,
    /// Number of pedestrians who are too far from the others for the area; 0 where corners are given.
    pub outside: usize,
    /// `[times]`: seconds after the moment.
    pub time: *const f64,
    /// `[times][height][width]`, the row of the lowest y first.
    pub probabilities: *const f32,
}
