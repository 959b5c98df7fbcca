//! Films of pedestrians with wrong rows, jumps, gaps and exchanged numbers, observed by a second program:
//! `reference/observed_tracks.py`.

use ddl_core::{OBSERVED, PedestrianId, Window};
use ddl_data::{Clock, Completeness, MisfitTreatment, Observation, WindowRule};
use serde::Deserialize;

use crate::observe::recording;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Film {
    /// Seconds; a frame has so many ticks, and 0.4 s so many ticks.
    frame_time: f64,
    ticks: i64,
    step: i64,
    max_age: Option<f64>,
    interval: Option<f64>,
    /// Frame, pedestrian, x and y.
    rows: Vec<(i64, i64, f64, f64)>,
    /// The tick of each, and of each pedestrian its number, the sums of x and of y (the first position once, the
    /// second twice and so on), its quality: unseen, age, deviation and velocity deviation, and the weight of the
    /// other explanation.
    windows: Vec<(i64, Vec<[f64; 8]>)>,
    misfits: Vec<(i64, i64, f64, u8)>,
    noise: f64,
}

fn of_window(window: &Window) -> Vec<[f64; 8]> {
    let of_pedestrian = |i: usize| {
        let times = |axis: usize| (1..).zip(window.observed(i)).map(move |(k, at)| f64::from(k) * at[axis]);
        let quality = window.quality(i);
        let [x, y] = [0, 1].map(|axis| times(axis).sum());
        let weight = window.other(i).map_or(0.0, |other| other.weight);
        let (id, unseen) = (window.pedestrians()[i].0 as f64, quality.unseen as f64);
        [id, x, y, unseen, quality.age, quality.deviation, quality.velocity_deviation, weight]
    };
    (0..window.len()).map(of_pedestrian).collect()
}

#[test]
fn films_are_observed_as_by_another_program() {
    let films: Vec<Film> = serde_json::from_str(include_str!("reference/observed_tracks.json")).unwrap();
    for (number, film) in (1..).zip(films) {
        let rows = film.rows.iter().map(|&(frame, id, x, y)| Observation::new(frame, PedestrianId(id), [x, y]));
        let clock = Clock::with_frame_time(film.frame_time).unwrap();
        assert_eq!((clock.tick(1).unwrap(), clock.frame_step()), (film.ticks, film.step));
        let recording = recording(clock, rows.collect());
        let tracks = recording.live_tracks().with_completeness(Completeness::Partial);
        let all = recording.observe(tracks.clone().with_interval(0.0)).windows;
        let observed = recording.observe(tracks.with_max_age(film.max_age).with_interval(film.interval));
        for (window, (tick, expected)) in observed.windows.iter().zip(&film.windows) {
            let first = tick - 7 * film.step;
            assert!(window.frames().iter().copied().eq((0..8).map(|k| first + k * film.step)));
            let found = of_window(window);
            let off = found.as_flattened().iter().zip(expected.as_flattened()).map(|(a, b)| (a - b).abs());
            let is_same = found.len() == expected.len() && off.fold(0.0, f64::max) < 1e-6;
            assert!(is_same, "film {number}, tick {tick}: {found:?} {expected:?}");
        }
        assert_eq!(observed.windows.len(), film.windows.len(), "film {number}");
        // Beside those whose futures are not known, a pedestrian is observed the same.
        for window in recording.windows(WindowRule::Observed) {
            let seen = all.iter().find(|seen| seen.frames() == &window.frames()[..OBSERVED]).unwrap();
            for (i, id) in window.pedestrians().iter().enumerate() {
                let j = seen.pedestrians().iter().position(|other| other == id).unwrap();
                let rows = seen.explanations();
                assert!(
                    rows.iter()
                        .any(|rows| (rows.quality(j), rows.observed(j)) == (window.quality(i), window.observed(i)))
                );
            }
        }
        for (misfit, &(tick, id, distance, treatment)) in observed.misfits.iter().zip(&film.misfits) {
            let expected = [MisfitTreatment::LeftOut, MisfitTreatment::BegunAnew, MisfitTreatment::Exchanged]
                [usize::from(treatment)];
            let found = (misfit.tick, misfit.pedestrian.0, misfit.treatment);
            assert_eq!(found, (tick, id, expected), "film {number}");
            assert!((misfit.distance - distance).abs() < 1e-6, "{misfit:?} {distance}");
        }
        assert_eq!(observed.misfits.len(), film.misfits.len(), "film {number}");
        assert!((observed.noise.metres() - film.noise).abs() < 1e-12, "film {number}");
    }
}
