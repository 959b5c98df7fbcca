//! Through the functions of C come the numbers of the facade, and no panic.

#![allow(unsafe_code, reason = "calls as from C")]

use crate::boundary::guarded;
use crate::functions::*;
use crate::layout::{ddl_model, ddl_observation, ddl_point, ddl_request, ddl_status};
use ddl::data::{Clock, Completeness, LiveTracks, PedestrianId, TimeUnit};
use ddl::{AdaptiveRegions, BuiltinModel, Ddl, DeviceChoice, LiveForecaster};
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
    let expected = LiveForecaster::with_tracks(model, tracks);
    let mut expected = expected.with_adaptive_regions(AdaptiveRegions::default());

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
        let rows = seen(tick).map(|(id, [x, y])| ddl_observation {
            id: id.0,
            position: ddl_point { x, y },
        });
        let request = ddl_request {
            joint: tick % 3 == 2,
            ..ddl_request::default()
        };
        let at = 0.1 * f64::from(tick);
        // SAFETY: rows of this function.
        let status = unsafe {
            ddl_live_observe(
                Some(&live),
                at,
                rows.as_ptr(),
                PEOPLE,
                Some(&request),
                Some(&mut forecast),
            )
        };
        assert_eq!(status, ddl_status::OK);
        let (frame, seen) = (i64::from(tick) * 100_000, seen(tick));
        let now = if request.joint {
            expected.push_joint(frame, seen, None)
        } else {
            expected.push(frame, seen)
        };
        let view = ddl_forecast_view(Some(&forecast)).unwrap();
        let Some(now) = now.unwrap().map(|now| now.forecast) else {
            assert_eq!((tick, view.pedestrians), (0, 0));
            continue;
        };
        assert_eq!((view.pedestrians, view.hypotheses), (PEOPLE, now.hypotheses()));
        for pair in 0..PEOPLE * now.hypotheses() {
            let (i, k) = (pair / now.hypotheses(), pair % now.hypotheses());
            // SAFETY: arrays of a view of this shape.
            let (path, weight) = unsafe {
                let paths = view.paths.cast::<[f64; 2]>();
                (slice::from_raw_parts(paths.add(12 * pair), 12), *view.weights.add(pair))
            };
            assert_eq!((path, weight), (now.hypothesis(i, k), now.weight(i, k)));
        }
    }
    ddl_live_free(Some(live));
    ddl_forecast_free(Some(forecast));
}

#[test]
fn a_panic_is_a_status_with_words() {
    assert_eq!(guarded(|| panic!("for {}", "a test")), ddl_status::DEFECT);
    // SAFETY: the text of the last failure.
    let text = unsafe { CStr::from_ptr(ddl_last_error()) };
    assert_eq!(text.to_str(), Ok("a defect of the library: for a test"));
    assert_eq!(guarded(|| Ok(())), ddl_status::OK);
}
