//! The functions of `ddl.h`. Pointers to one value are references of Rust here, null being `None`.

#![allow(unsafe_code, reason = "functions of C")]
#![allow(clippy::missing_safety_doc, reason = "`ddl.h` begins with what holds for all pointers")]

use crate::answer::{Held, LiveNotes, warning_of};
use crate::boundary::{CallFailure, guarded, last_error, needed, text, values};
use crate::handles::{ddl_forecast, ddl_live, ddl_model};
use crate::layout::{
    ddl_cells, ddl_live_options, ddl_observation, ddl_occupancy, ddl_plan, ddl_plan_point, ddl_point, ddl_request,
    ddl_risks, ddl_status, ddl_view,
};
use crate::live::LivePlace;
use crate::model::LoadedModel;
use ddl::data::{Completeness, Misfit, OBSERVED, PedestrianId, Position};
use ddl::scene::{Plan, PlanPoint};
use ddl::{GivenPlan, Note, ObservedPast, Request};
use std::ffi::c_char;
use std::mem::MaybeUninit;
use std::sync::Arc;

/// The version of the library, such as "0.2.0".
#[unsafe(no_mangle)]
pub extern "C" fn ddl_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// What was wrong in the last call on this thread that failed: what, where, and what to do. Valid until the next
/// failure on this thread; empty before the first.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_last_error() -> *const c_char {
    last_error()
}

/// Takes so many bytes from the system now, for the pool of the library, so that later calls need not: 24 MB are enough
/// for 25 pedestrians. Without the feature `pool` it has no effect.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_reserve(bytes: usize) -> ddl_status {
    guarded(|| {
        let mut block = Vec::new();
        block.try_reserve_exact(bytes).map_err(CallFailure::invalid)?;
        // Pages are taken when they are written. The pool keeps the block that is freed here.
        block.resize(bytes, 1_u8);
        std::hint::black_box(&block);
        Ok(())
    })
}

/// Opens a model: "world", which is built in, a packed model, or the folder of a run. With `threads` 1 everything is
/// computed on the thread that calls, with its priority; each thread that calls takes some kB for good. Otherwise the
/// model has so many threads of its own; 0 for one on each core.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ddl_model_open(
    name: *const c_char,
    threads: usize,
    model: Option<&mut MaybeUninit<*mut ddl_model>>,
) -> ddl_status {
    guarded(|| {
        // SAFETY: a text of the caller.
        let name = needed(unsafe { text(name, "name")? }, "name")?;
        needed(model, "model")?.write(Box::into_raw(Box::new(ddl_model(LoadedModel::open(name, threads)?))));
        Ok(())
    })
}

/// Frees a model; live tracks keep what they need of it. Null is nothing, as in all functions that free.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_model_free(_: Option<Box<ddl_model>>) {}

/// A place for forecasts. It takes memory when it is filled, and uses it again.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_forecast_new() -> Box<ddl_forecast> {
    Box::default()
}

/// Frees a forecast with everything that it has shown.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_forecast_free(_: Option<Box<ddl_forecast>>) {}

/// Forecasts `count` pedestrians whose last 8 positions are known: `past` is `[count][8]`, 0.4 s apart, the present
/// last. They have the ids 0, 1, 2 and so on. Positions are checked as those of a stream: who is where nobody can be is
/// not forecast (see ids and misfits), and without anybody else that is an error. `request` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ddl_model_forecast(
    model: Option<&ddl_model>,
    past: *const ddl_point,
    count: usize,
    request: Option<&ddl_request<'_>>,
    forecast: Option<&mut ddl_forecast>,
) -> ddl_status {
    guarded(|| {
        let (model, forecast) = (&needed(model, "model")?.0, needed(forecast, "forecast")?);
        // SAFETY: positions of the caller, and those of a plan.
        let (past, request) = unsafe { (values(past, count.saturating_mul(OBSERVED), "past")?, asked(request)?) };
        let tracks = past.chunks_exact(OBSERVED);
        let tracks = tracks.map(|track| track.iter().map(|position| [position.x, position.y]).collect());
        let tracks: Vec<Vec<Position>> = tracks.collect();
        if tracks.is_empty() {
            return Err(CallFailure::invalid("no pedestrian is given; a forecast is of at least one"));
        }
        for (id, track) in tracks.iter().enumerate() {
            if let Some(place) = track.iter().find(|place| place.iter().any(|axis| axis.is_nan())) {
                return Err(CallFailure::invalid(format!("pedestrian {id} is at {place:?}; give finite positions")));
            }
        }
        let observed = ObservedPast::of_tracks(&tracks, count, Completeness::Partial).map_err(CallFailure::invalid)?;
        let place = |misfit: &Misfit| format!("pedestrian {}, position {}", misfit.pedestrian, misfit.tick);
        let words = || Misfit::words(&observed.misfits, place).unwrap_or_default();
        let nobody = || CallFailure::invalid(format!("no pedestrian can be forecast: {}", words()));
        let window = observed.window.ok_or_else(nobody)?;
        if let Some(GivenPlan { ego: Some(ego), .. }) = request.plan()
            && window.named(ego).is_none()
        {
            return Err(CallFailure::invalid(format!("ego is {ego}, but no such pedestrian is forecast")));
        }
        let answer = model.forecast(&window, &request)?;
        let warning = warning_of(&Note::of_given(request.plan(), &window, &answer));
        let notes = LiveNotes { misfits: observed.misfits, warning, ..LiveNotes::default() };
        forecast.0.hold(Some(Held { window, answer, threads: Arc::clone(&model.threads) }), &notes);
        Ok(())
    })
}

/// Begins to observe a place. `options` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ddl_live_new(
    model: Option<&ddl_model>,
    options: Option<&ddl_live_options<'_>>,
    live: Option<&mut MaybeUninit<*mut ddl_live>>,
) -> ddl_status {
    guarded(|| {
        let (model, options, live) = (needed(model, "model")?, options.copied(), needed(live, "live")?);
        let options = options.unwrap_or_default();
        // SAFETY: a text of the caller.
        let memory = unsafe { text(options.memory, "memory")? };
        live.write(Box::into_raw(Box::new(ddl_live(LivePlace::new(&model.0, &options, memory)?))));
        Ok(())
    })
}

/// Adds a frame with all observed pedestrians, in any order, and writes the forecast to `forecast`. N is 0 if no
/// pedestrian can be forecast. Between two forecasts (option `every`), `forecast` keeps the previous one and `due` is
/// false. `at` is the time in seconds or the frame number; it must increase. After an error the tracks are unchanged,
/// and the corrected frame can be added. `request` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ddl_live_observe(
    live: Option<&ddl_live>,
    at: f64,
    observations: *const ddl_observation,
    count: usize,
    request: Option<&ddl_request<'_>>,
    forecast: Option<&mut ddl_forecast>,
) -> ddl_status {
    guarded(|| {
        let (live, forecast) = (&needed(live, "live")?.0, &mut needed(forecast, "forecast")?.0);
        // SAFETY: rows of the caller, and those of a plan.
        let (rows, request) = unsafe { (values(observations, count, "observations")?, asked(request)?) };
        let seen = rows.iter().map(|row| (PedestrianId(row.id), [row.position.x, row.position.y]));
        live.observe(at, seen.collect(), request, forecast)
    })
}

/// Forgets all tracks, as when a tracker restarts; the memory of the place is kept.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_live_clear(live: Option<&ddl_live>) -> ddl_status {
    guarded(|| {
        needed(live, "live")?.0.clear();
        Ok(())
    })
}

/// Writes the memory of the place and closes its file; nothing without one. While frames come it is written once a
/// minute.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_live_close(live: Option<&ddl_live>) -> ddl_status {
    guarded(|| needed(live, "live")?.0.close())
}

/// Frees live tracks. It does not write the memory: `ddl_live_close` does.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_live_free(_: Option<Box<ddl_live>>) {}

/// What was forecast last; null for null. Valid until the next forecast into the handle.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_forecast_view(forecast: Option<&ddl_forecast>) -> Option<&ddl_view> {
    forecast.map(|forecast| &forecast.0.view)
}

/// Radii (m) `[N][K][12]` of the discs around the hypotheses that together contain a pedestrian with the probability
/// `level`. NaN: the hypothesis has no disc. Null: no pedestrian is forecast. Valid until the next call for radii of
/// the handle.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_forecast_radii(
    forecast: Option<&mut ddl_forecast>,
    level: f64,
    radii: Option<&mut MaybeUninit<*const f64>>,
) -> ddl_status {
    guarded(|| {
        let (forecast, radii) = (&mut needed(forecast, "forecast")?.0, needed(radii, "radii")?);
        radii.write(forecast.compute_radii(level)?);
        Ok(())
    })
}

/// The risk that somebody comes within `within` metres of the edge of each plan, from joint futures. People see a plan
/// and keep away from it as from a pedestrian, unless `unseen`. `ego` is the id of the pedestrian who follows the
/// plans; null if it is somebody else, such as a robot. Valid until the next call for risks of the handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ddl_forecast_risks(
    forecast: Option<&mut ddl_forecast>,
    plans: *const ddl_plan,
    count: usize,
    within: f64,
    ego: Option<&i64>,
    unseen: bool,
    risks: Option<&mut MaybeUninit<*const ddl_risks>>,
) -> ddl_status {
    guarded(|| {
        let (forecast, risks) = (&mut needed(forecast, "forecast")?.0, needed(risks, "risks")?);
        // SAFETY: plans of the caller, with their rows.
        let plans = unsafe { values(plans, count, "plans")? }.iter().map(|plan| unsafe { planned(plan) });
        forecast.compute_risks(&plans.collect::<Result<Vec<_>, _>>()?, within, ego.copied(), !unseen)?;
        risks.write(&raw const forecast.risks);
        Ok(())
    })
}

/// Grids of the probability that a pedestrian covers the middle of a cell, from joint futures, at 0, `every`, .. 4.8 s.
/// Valid until the next call for occupancy of the handle.
#[unsafe(no_mangle)]
pub extern "C" fn ddl_forecast_occupancy(
    forecast: Option<&mut ddl_forecast>,
    cells: Option<&ddl_cells<'_>>,
    occupancy: Option<&mut MaybeUninit<*const ddl_occupancy>>,
) -> ddl_status {
    guarded(|| {
        let (forecast, occupancy) = (&mut needed(forecast, "forecast")?.0, needed(occupancy, "occupancy")?);
        forecast.compute_occupancy(needed(cells, "cells")?)?;
        occupancy.write(&raw const forecast.occupancy);
        Ok(())
    })
}

/// # Safety
/// The rows of its plan are the caller's.
unsafe fn asked(request: Option<&ddl_request<'_>>) -> Result<Request, CallFailure> {
    let Some(request) = request else {
        return Ok(Request::default());
    };
    let is_planned = !request.plan.points.is_null() || request.plan.count > 0;
    if request.ego.is_some() && !is_planned {
        return Err(CallFailure::invalid("ego follows a plan: give the plan, or leave out ego"));
    }
    if !request.joint {
        let words = "only joint futures respond to a plan: set joint, or leave out the plan";
        return if is_planned { Err(CallFailure::invalid(words)) } else { Ok(Request::default()) };
    }
    // SAFETY: the caller's.
    let plan = is_planned.then(|| unsafe { planned(&request.plan) }).transpose()?;
    let ego = request.ego.map(|&id| PedestrianId(id).into());
    Ok(plan.map_or_else(Request::joint, |plan| Request::given(GivenPlan { plan, ego })))
}

/// # Safety
/// The rows of the plan are the caller's.
unsafe fn planned(plan: &ddl_plan) -> Result<Plan, CallFailure> {
    // SAFETY: the caller's.
    let rows = unsafe { values(plan.points, plan.count, "points of a plan")? };
    let point = |&ddl_plan_point { time, position, radius }: &ddl_plan_point| PlanPoint {
        time,
        position: [position.x, position.y],
        radius,
    };
    Plan::new(rows.iter().map(point).collect()).map_err(CallFailure::invalid)
}
