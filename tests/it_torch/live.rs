//! Forecasts frame by frame are those of the windows cut from the whole recording, bit for bit.

use ddl::data::{Convention, Dataset, LiveError, Observation, PedestrianId, Position, Recording};
use ddl::eval::baseline::ConstantVelocity;
use ddl::{CertificateError, Ddl, DdlError, Forecaster as _, LiveForecaster, Variant};
use ddl_tests::{bits, own_tracks, recordings, tiny_model};

fn people(recording: &Recording, frame: i64) -> Vec<(PedestrianId, Position)> {
    let seen = recording.at(frame).iter();
    seen.map(|o| (o.pedestrian, o.position)).collect()
}

/// Three people for 24 frames; one is missing at frame 60 and leaves at 160, and nobody at all is seen at frame 180.
fn coming_and_going() -> Recording {
    let rows = own_tracks::three_people(24).into_iter();
    let there = |&(frame, id, _, _): &own_tracks::Row| {
        frame != 180 && !(id == 2 && (frame == 60 || frame >= 160))
    };
    let rows = rows
        .filter(there)
        .map(|(frame, id, x, y)| Observation::new(frame, PedestrianId(id), [x, y]));
    Recording::new("live", own_tracks::FRAME_STEP, rows.collect()).unwrap()
}

/// Plays a recording, plainly and certified where there is a flow, and holds every forecast to that of the window.
fn check(model: &Ddl, recording: &Recording, frames: &[i64]) -> usize {
    let step = recording.frame_step();
    let certify = model.config().star.variant.dynamics();
    let mut live = LiveForecaster::with_frame_step(model, step).unwrap();
    let mut certified = live.clone();
    let mut windows = recording.observed_windows().into_iter().peekable();
    let mut forecasts = 0;
    for &frame in frames {
        let people = people(recording, frame);
        let now = live.push(frame, people.iter().copied()).unwrap();
        let evidence = certify
            .then(|| certified.push_certified(frame, people).unwrap())
            .flatten();
        let expected = windows.next_if(|window| window.frames()[7] == frame);
        assert_eq!(now.is_some(), expected.is_some(), "frame {frame}");
        let (Some(now), Some(window)) = (now, expected) else {
            continue;
        };
        forecasts += 1;
        assert_eq!(now.frame(), frame);
        assert_eq!(now.window.pedestrians(), window.pedestrians());
        let forecast = model.forecast(&window).unwrap();
        assert_eq!(bits::of(&now.forecast), bits::of(&forecast));
        if let Some(evidence) = evidence {
            let windows = std::slice::from_ref(&window);
            let expected = model.forecast_certified(windows).unwrap().remove(0);
            let found = &evidence.forecast;
            assert_eq!(bits::of(&found.forecast), bits::of(&forecast));
            assert_eq!(found.certificates, expected.certificates);
            assert_eq!(evidence.window, now.window);
        }
    }
    forecasts
}

#[test]
fn every_frame_is_forecast_as_its_window_is() {
    let recording = coming_and_going();
    for variant in [Variant::Full, Variant::Star] {
        let tiny = tiny_model::of(variant);
        // Windows from frame 70 on; not at 180, and after it not before 260.
        assert_eq!(check(&tiny.model, &recording, recording.frames()), 11);
    }
}

/// A stretch of a crowd that was filmed.
#[test]
fn real_people_are_forecast_as_their_windows_are() {
    let Some(folder) = recordings::star_folder() else {
        return;
    };
    let dataset = Dataset::load(Convention::Star, &folder).unwrap();
    let recording = dataset.recording("zara01").unwrap();
    let until = recording.frames()[39];
    let early = recording.observations().iter();
    let early = early.filter(|o| o.frame <= until).copied().collect();
    let recording = Recording::new("live", recording.frame_step(), early).unwrap();
    let tiny = tiny_model::of(Variant::Full);
    assert!(check(&tiny.model, &recording, recording.frames()) > 20);
}

#[test]
fn an_error_changes_nothing() {
    let recording = coming_and_going();
    let tiny = tiny_model::of(Variant::Full);
    let step = recording.frame_step();
    let mut live = LiveForecaster::with_frame_step(&tiny.model, step).unwrap();
    live.push(0, people(&recording, 0)).unwrap();
    for &frame in &recording.frames()[1..9] {
        let everybody = people(&recording, frame);
        let before = live.tracks().clone();
        let twice = everybody.iter().chain(&everybody[..1]).copied();
        for error in [
            live.push(frame - step, everybody.clone()),
            live.push(frame, twice),
            live.push(frame, [(PedestrianId(3), [f64::NAN, 0.0])]),
        ] {
            let error = error.unwrap_err();
            assert!(matches!(error, DdlError::Live(_)), "{error}");
        }
        if frame >= 70 {
            // Finite, and a position like any other until somebody forecasts from it.
            let mut far = everybody.clone();
            far[0].1 = [f64::MAX, 0.0];
            let error = live.push(frame, far.clone()).unwrap_err();
            assert!(matches!(error, DdlError::Forecast(_)), "{error}");
            let error = live.push_certified(frame, far).unwrap_err();
            assert!(matches!(error, DdlError::Forecast(_)), "{error}");
        }
        assert_eq!(live.tracks(), &before);
        let now = live.push(frame, everybody).unwrap();
        assert_eq!(now.is_some(), frame >= 70);
    }
}

#[test]
fn without_a_flow_nothing_is_certified_and_nothing_changes() {
    let tiny = tiny_model::of(Variant::Star);
    let mut live = LiveForecaster::new(&tiny.model);
    let error = live
        .push_certified(0, [(PedestrianId(1), [0.0, 0.0])])
        .unwrap_err();
    let DdlError::Forecast(ddl::eval::ForecastError::Model { source, .. }) = &error else {
        panic!("{error}");
    };
    assert!(
        source.downcast_ref::<CertificateError>().is_some(),
        "{source}"
    );
    assert_eq!(live.tracks().last_frame(), None);
}

#[test]
fn a_step_of_nothing_is_refused() {
    let error = LiveForecaster::with_frame_step(ConstantVelocity::last_step(), 0).unwrap_err();
    assert!(matches!(
        error,
        DdlError::Live(LiveError::FrameStep { found: 0 })
    ));
}

/// Walkers come and go for 30,000 frames, more than three hours; constant velocity stands in for the model, which would
/// remember nothing either.
#[test]
fn a_long_day_is_forecast_from_the_people_present() {
    let mut live = LiveForecaster::new(ConstantVelocity::last_step());
    let mut most = 0;
    for frame in 0..30_000_i64 {
        // walker k is there from frame 5 k on, for 9 to 13 frames
        let present = (frame / 5 - 2..=frame / 5).filter(|k| frame - 5 * k < 9 + k.rem_euclid(5));
        let present: Vec<_> = present
            .map(|k| (PedestrianId(k), [frame as f64, k as f64]))
            .collect();
        let count = present.len();
        let now = live.push(frame, present).unwrap();
        assert_eq!(live.tracks().len(), count);
        let whole = now.as_ref().map_or(0, |now| now.window.len());
        assert!(whole <= count);
        if let Some(now) = now {
            assert_eq!(now.forecast.pedestrians(), whole);
        }
        most = most.max(whole);
    }
    assert_eq!(most, 2);
}
