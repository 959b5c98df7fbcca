//! Through the functions of C come the numbers of the facade, and no panic.

#![allow(unsafe_code, reason = "calls as from C")]

use crate::boundary::{guarded, values};
use crate::functions::*;
use crate::handles::ddl_model;
use crate::layout::{ddl_observation, ddl_point, ddl_request, ddl_status, ddl_view};
use ddl::data::{Clock, Completeness, LiveTracks, PedestrianId, TimeUnit, Window};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecast, Request, Session};
use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::slice;

const PEOPLE: usize = 6;

/// Ten rows a second of six people, each on a way of its own.
fn seen(tick: i32) -> [(PedestrianId, [f64; 2]); PEOPLE] {
    std::array::from_fn(|i| {
        let ([sin, cos], time) = ([(i as f64).sin(), (i as f64).cos()], 0.1 * f64::from(tick));
        let position = [3.0 * cos + 1.2 * time * sin, 3.0 * sin - 1.1 * time * cos];
        (PedestrianId(40 - i as i64), position)
    })
}

#[test]
fn live_tracks_have_the_bits_of_the_facade() {
    let tracks = LiveTracks::with_clock(Clock::with_stamps(TimeUnit::Seconds));
    let tracks = tracks.with_completeness(Completeness::Partial);
    let model = Ddl::builtin(BuiltinModel::World, DeviceChoice::Cpu).unwrap();
    let mut expected = Session::new(model, tracks, Request::default()).unwrap();

    let (mut model, mut live, mut forecast) = (MaybeUninit::uninit(), MaybeUninit::uninit(), ddl_forecast_new());
    // SAFETY: a text and addresses of this function, written where the status is OK; each handle is freed once.
    let (model, live) = unsafe {
        assert_eq!(ddl_model_open(c"world".as_ptr(), 1, Some(&mut model)), ddl_status::OK);
        let model: *mut ddl_model = model.assume_init();
        assert_eq!(ddl_live_new(model.as_ref(), None, Some(&mut live)), ddl_status::OK);
        (Box::from_raw(model), Box::from_raw(live.assume_init()))
    };
    ddl_model_free(Some(model));
    for tick in 0..30 {
        let rows = seen(tick).map(|(id, [x, y])| ddl_observation { id: id.0, position: ddl_point { x, y } });
        let request = ddl_request { joint: tick % 3 == 2, ..ddl_request::default() };
        let at = 0.1 * f64::from(tick);
        // SAFETY: rows of this function.
        let status =
            unsafe { ddl_live_observe(Some(&live), at, rows.as_ptr(), PEOPLE, Some(&request), Some(&mut forecast)) };
        assert_eq!(status, ddl_status::OK);
        let (frame, seen) = (i64::from(tick) * 100_000, seen(tick));
        let asked = if request.joint { Request::joint() } else { Request::default() };
        expected.ask(asked.with_adaptive_regions()).unwrap();
        let view = ddl_forecast_view(Some(&forecast)).unwrap();
        let (window, answer) = expected.push(frame, seen).unwrap().answer.unwrap();
        is_shown(view, &window, answer.forecast());
    }
    ddl_live_free(Some(live));
    ddl_forecast_free(Some(forecast));
}

/// All arrays of a view have the numbers of a forecast.
fn is_shown(view: &ddl_view, window: &Window, now: &Forecast) {
    let mut expected = <[Vec<f64>; 8]>::default();
    assert_eq!((view.pedestrians, view.hypotheses), (PEOPLE, now.hypotheses()));
    let [past, age, uncertainty, paths, weights, goals, familiarity, spread] = &mut expected;
    for i in 0..PEOPLE {
        past.extend(window.observed(i).as_flattened());
        age.push(window.quality(i).age);
        uncertainty.push(window.quality(i).uncertainty());
        familiarity.extend(now.familiarity(i));
        spread.extend((0..12).filter_map(|t| now.scale(i, t)));
        for k in 0..now.hypotheses() {
            paths.extend(now.hypothesis(i, k).as_flattened());
            weights.push(now.weight(i, k));
            goals.extend(now.goal(i, k).into_iter().flatten());
        }
    }
    let [past, paths, goals] = [view.past, view.paths, view.goals].map(<*const ddl_point>::cast);
    let (first, second) = ([past, view.age, view.uncertainty, paths], [view.weights, goals]);
    let found = first.into_iter().chain(second).chain([view.familiarity, view.spread]);
    for (first, expected) in found.zip(&expected) {
        // SAFETY: an array of a view of this shape, or null.
        let found = unsafe { values(first, expected.len(), "numbers") };
        assert!(found.is_ok_and(|found| found == *expected) && first.is_null() == expected.is_empty());
    }
    // SAFETY: as above.
    let ids = unsafe { slice::from_raw_parts(view.ids, PEOPLE) };
    assert_eq!(ids, [35, 36, 37, 38, 39, 40]);
}

#[test]
fn a_panic_is_a_status_with_words() {
    assert_eq!(guarded(|| panic!("for {}", "a test")), ddl_status::DEFECT);
    // SAFETY: the text of the last failure.
    let text = unsafe { CStr::from_ptr(ddl_last_error()) };
    assert_eq!(text.to_str(), Ok("a defect of the library: for a test"));
    assert_eq!(guarded(|| Ok(())), ddl_status::OK);
}
