//! Observations of recordings and streams: what passes unchanged, what is estimated, and that nothing later is read.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use ddl_core::{OBSERVED, ObservationQuality, PedestrianId, Position, TIME_STEP, Window, distance};
use ddl_data::{
    Clock, Completeness, Convention, Dataset, Format, FrameReader, LiveTracks, Misfit, MisfitTreatment, Observation,
    ObservedRecording, Recording, WindowRule, parse_recording,
};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::recordings;

/// How the rows of a film are timed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum RowTimes {
    /// Frames at a rate.
    Rate(f64),
    /// Milliseconds: each pedestrian every 400 or 410 ms from its own first row on.
    OwnClocks,
    /// Milliseconds: common frames every 100 ms, up to 10 ms early or late.
    Jitter,
}

const PACES: [RowTimes; 11] = [
    RowTimes::Rate(1.0),
    RowTimes::Rate(2.0),
    RowTimes::Rate(7.0),
    RowTimes::Rate(9.0),
    RowTimes::Rate(12.5),
    RowTimes::Rate(23.976),
    RowTimes::Rate(25.0),
    RowTimes::Rate(29.97),
    RowTimes::Rate(30.0),
    RowTimes::OwnClocks,
    RowTimes::Jitter,
];

impl RowTimes {
    fn clock(self) -> Clock {
        let seconds = if let RowTimes::Rate(rate) = self { 1.0 / rate } else { 0.001 };
        Clock::with_frame_time(seconds).unwrap()
    }

    /// The frame number of the k-th row of a pedestrian.
    fn frame(self, pedestrian: i64, k: i64) -> i64 {
        match self {
            Self::Rate(_) => k,
            Self::OwnClocks => 87 * pedestrian + k * (400 + 10 * (pedestrian % 2)),
            Self::Jitter => 100 * k + (k * k * 7 + 3 * k) % 21 - 10,
        }
    }

    fn rows_in(self, seconds: f64) -> i64 {
        match self {
            Self::Rate(rate) => (seconds * rate) as i64,
            Self::OwnClocks => (seconds / 0.4) as i64,
            Self::Jitter => (seconds / 0.1) as i64,
        }
    }
}

/// Pedestrians for 14 s that turn and pause, with noise and lost rows, in some order.
fn film(pace: RowTimes, seed: u64, noise: f64, lost: f64) -> Vec<Observation> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let lost = if pace == RowTimes::Rate(1.0) { 0.0 } else { lost }; // rows are at most 1.2 s apart
    let second = if let RowTimes::Rate(rate) = pace { rate } else { 1000.0 };
    let mut rows = Vec::new();
    for id in 1..=3 {
        let mut amount = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let (speed, heading, turn) = (amount(0.3, 1.8), amount(0.0, 6.0), amount(-0.4, 0.4));
        let (first, end) = (pace.rows_in(amount(0.0, 2.0)), pace.rows_in(amount(11.0, 14.0)));
        for k in first..end {
            let frame = pace.frame(id, k);
            let time = frame as f64 / second;
            let angle = heading + turn * (0.7 * time).sin();
            let place = [speed * time * angle.cos(), 2.0 * id as f64 + speed * time * angle.sin()];
            let place = place.map(|coordinate| coordinate + noise * amount(-1.7, 1.7));
            if amount(0.0, 1.0) >= lost {
                rows.push(Observation::new(frame, PedestrianId(id), place));
            }
        }
    }
    rows
}

fn films() -> impl Strategy<Value = (RowTimes, Vec<Observation>)> {
    let noise = prop::sample::select(vec![0.0, 0.0, 0.05, 0.2]);
    let lost = prop::sample::select(vec![0.0, 0.3]);
    let film = |(pace, seed, noise, lost)| (pace, film(pace, seed, noise, lost));
    (prop::sample::select(&PACES[..]), any::<u64>(), noise, lost).prop_map(film)
}

pub(crate) fn recording(clock: Clock, rows: Vec<Observation>) -> Recording {
    Recording::in_usual_step("film", rows).unwrap().on_clock(clock).unwrap()
}

pub(crate) fn partial(recording: &Recording) -> ObservedRecording {
    recording.observe(recording.live_tracks().with_completeness(Completeness::Partial))
}

type Bits = Vec<(i64, PedestrianId, Vec<u64>, usize)>;

/// Moment, pedestrian, and the bits of all that is known of it.
fn bits(windows: &[Window]) -> Bits {
    let of_window = |window: &Window| -> Bits {
        let of_pedestrian = |i: usize| {
            let ObservationQuality { unseen, age, deviation, velocity_deviation } = window.quality(i);
            let numbers = window.observed(i).iter().flatten().chain([&age, &deviation, &velocity_deviation]);
            let numbers = numbers.map(|number| number.to_bits()).collect();
            (window.frames()[OBSERVED - 1], window.pedestrians()[i], numbers, unseen)
        };
        (0..window.len()).map(of_pedestrian).collect()
    };
    windows.iter().flat_map(of_window).collect()
}

/// The largest distance between the observations of two lists of windows of the same pedestrians.
fn farthest(a: &[Window], b: &[Window], moved: impl Fn(Position) -> Position) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().zip(b).flat_map(|(a, b)| {
        assert_eq!(a.pedestrians(), b.pedestrians());
        (0..a.len()).flat_map(|i| a.observed(i).iter().copied().zip(b.observed(i).iter().copied()))
    });
    pairs.map(|(a, b)| distance(moved(a), b)).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Rows after a tick may be changed, added and removed: no bit of a window up to it changes.
    #[test]
    fn nothing_later_is_read(
        (pace, rows) in films(),
        other in any::<u64>(),
        share in 0.2..0.9_f64,
        interval: Option<bool>,
    ) {
        let last = rows.iter().map(|row| row.frame).max().unwrap();
        let cut = (share * last as f64) as i64;
        let mut changed: Vec<_> = rows.iter().copied().filter(|row| row.frame <= cut).collect();
        changed.extend(film(pace, other, 1.0, 0.3).into_iter().filter(|row| row.frame > cut));
        let observed = |rows: Vec<Observation>| {
            let recording = recording(pace.clock(), rows);
            let tracks = recording.live_tracks().with_completeness(Completeness::Partial);
            let tracks = match interval {
                None => tracks,
                Some(is_step) => tracks.with_interval(if is_step { TIME_STEP } else { 0.0 }),
            };
            let windows = recording.observe(tracks).windows;
            let mut bits = bits(&windows);
            bits.retain(|seen| seen.0 <= pace.clock().tick(cut).unwrap());
            bits
        };
        let before = observed(rows);
        prop_assert!(before.len() > usize::from(share > 0.5), "{}", before.len());
        prop_assert_eq!(before, observed(changed));
    }

    /// The text of a stream, the file, and its rows in any order within a frame give the same windows.
    #[test]
    fn streams_and_files_are_observed_alike(
        (pace, mut rows) in films(),
        turned: bool,
        every in prop_oneof![Just(0.0), Just(TIME_STEP)],
    ) {
        rows.sort_by_key(|row| (row.frame, if turned { -row.pedestrian.0 } else { row.pedestrian.0 }));
        let times = if matches!(pace, RowTimes::Rate(_)) { "frame" } else { "time_ms" };
        let mut text = format!("x,y,pedestrian,{times}\n");
        for Observation { frame, pedestrian, position: [x, y] } in rows {
            writeln!(text, "{x},{y},{pedestrian},{frame}").unwrap();
        }
        let file = parse_recording(text.as_bytes(), "film", Format::Table).unwrap();
        let clock = file.stated_clock().unwrap_or_else(|| Ok(pace.clock())).unwrap();
        let file = file.on_clock(clock).unwrap();
        let options = |tracks: LiveTracks| tracks.with_completeness(Completeness::Partial).with_interval(every);
        let mut tracks = options(LiveTracks::with_clock(clock));
        let mut frames = FrameReader::new(text.as_bytes(), "tracker");
        let mut live = Vec::new();
        while let Some(frame) = frames.next_frame().unwrap() {
            live.extend(tracks.push(frame.number, frame.pedestrians).unwrap());
        }
        let of_file = file.observe(options(file.live_tracks()));
        prop_assert_eq!(bits(&live), bits(&of_file.windows));
        prop_assert_eq!(tracks.noise(), &of_file.noise);
        prop_assert_eq!(frames.time_unit(), file.time_unit());
    }

    /// Where and when a scene lies does not matter.
    #[test]
    fn observations_move_with_the_scene((pace, rows) in films(), angle in 0.0..6.3_f64, later in 0..1_000_000_i64) {
        let (sin, cos) = angle.sin_cos();
        let moved = |[x, y]: Position| [cos * x - sin * y + 31.0, sin * x + cos * y - 7.0];
        let clock = pace.clock();
        let here = partial(&recording(clock, rows.clone()));
        let shift = |row: &Observation| Observation { frame: row.frame + later, ..*row };
        let then = partial(&recording(clock, rows.iter().map(shift).collect()));
        let shifted = clock.tick(later).unwrap();
        let back = |(moment, id, bits, unseen)| (moment - shifted, id, bits, unseen);
        prop_assert_eq!(bits(&here.windows), bits(&then.windows).into_iter().map(back).collect::<Bits>());
        let turn = |row: &Observation| Observation { position: moved(row.position), ..*row };
        let there = partial(&recording(clock, rows.iter().map(turn).collect()));
        prop_assert!(farthest(&here.windows, &there.windows, moved) < 1e-6);
        prop_assert_eq!(here.misfits.len(), there.misfits.len());
    }

    /// Others tell how exact a tracker is; where it is exact, a pedestrian alone is observed the same.
    #[test]
    fn others_change_nothing_where_positions_are_exact(pace in prop::sample::select(&PACES[..]), seed in any::<u64>()) {
        let rows = film(pace, seed, 0.0, 0.2);
        let together = partial(&recording(pace.clock(), rows.clone())).windows;
        let mine: Vec<_> = rows.into_iter().filter(|row| row.pedestrian.0 == 1).collect();
        for window in partial(&recording(pace.clock(), mine)).windows {
            let Some(other) = together.iter().find(|other: &&Window| other.frames() == window.frames()) else {
                continue; // the common windows may be due at other moments
            };
            let i = other.pedestrians().iter().position(|id| id.0 == 1).unwrap();
            if window.other(0).is_some() || other.other(i).is_some() {
                continue;
            }
            let pairs = window.observed(0).iter().zip(other.observed(i)).skip(window.quality(0).unseen);
            let off = pairs.map(|(a, b)| distance(*a, *b)).fold(0.0, f64::max);
            prop_assert!(off < 0.1, "{off}");
        }
    }

    /// Whoever has a row at a moment is observed at it, wherever the row is. Of a first row nothing is known but the
    /// place; later rows, and all of others, show more.
    #[test]
    fn whoever_is_seen_is_observed(
        (pace, mut rows) in films(),
        jumps in prop::collection::vec((any::<prop::sample::Index>(), prop::array::uniform2(-9.0..9.0)), 0..9),
    ) {
        for (index, jump) in jumps {
            let place = &mut index.get_mut(&mut rows).position;
            *place = [0, 1].map(|axis| place[axis] + jump[axis]);
        }
        let recording = recording(pace.clock(), rows);
        let tracks = recording.live_tracks().with_completeness(Completeness::Partial).with_interval(0.0);
        let mut seen = Vec::new();
        for window in recording.observe(tracks).windows {
            let rows = recording.at(window.frames()[OBSERVED - 1]);
            for row in rows {
                let i = window.pedestrians().iter().position(|id| *id == row.pedestrian).unwrap();
                let quality = window.quality(i);
                if !seen.contains(&row.pedestrian) {
                    seen.push(row.pedestrian);
                    prop_assert_eq!(window.observed(i), [row.position; OBSERVED]);
                    prop_assert!(quality.is_hardly_observed() && quality.velocity_deviation > 1.0);
                }
                prop_assert!(quality.unseen == 7 || !quality.is_hardly_observed());
            }
        }
        prop_assert_eq!(seen.len(), recording.pedestrians().len());
    }

    /// A window of which fewer rows were seen: the last row and the future are as before; with 8 rows all is.
    #[test]
    fn fewer_rows_leave_the_last_one(rows in 1..=8_usize, seed in any::<u64>()) {
        let recording = recording(RowTimes::Rate(2.5).clock(), film(RowTimes::Rate(2.5), seed, 0.0, 0.0));
        for window in recording.windows(WindowRule::Complete) {
            let cut = LiveTracks::last_rows(&window, rows);
            prop_assert_eq!((cut.pedestrians(), cut.frames()), (window.pedestrians(), window.frames()));
            for i in 0..window.len() {
                prop_assert_eq!(&cut.track(i)[OBSERVED - rows..], &window.track(i)[OBSERVED - rows..]);
                prop_assert_eq!(cut.quality(i).unseen, OBSERVED - rows);
            }
        }
    }

    /// Rows at the steps, with or without others between them, pass to the bit, and nothing was estimated, unless a row
    /// is doubtful: then by one of the two explanations.
    #[test]
    fn rows_at_the_steps_pass_unchanged(frames in prop::sample::select(vec![1, 2, 4, 5, 10]), seed in any::<u64>()) {
        let pace = RowTimes::Rate(2.5 * f64::from(frames));
        let recording = recording(pace.clock(), film(pace, seed, 0.0, 0.0));
        let observed = recording.observe(recording.live_tracks());
        prop_assert!(observed.windows.len() > 5);
        for window in observed.windows {
            let is_told = |id: PedestrianId| observed.misfits.iter().any(|misfit| misfit.pedestrian == id);
            let now = recording.at(window.frames()[OBSERVED - 1]);
            let here = |id: &PedestrianId| now.iter().any(|row| row.pedestrian == *id);
            let explanations = window.explanations();
            for (i, &id) in window.pedestrians().iter().enumerate().filter(|(_, id)| here(id) && !is_told(**id)) {
                let are_rows = |window: &Window| {
                    let mut places = window.frames().iter().zip(window.observed(i));
                    window.quality(i) == ObservationQuality::default()
                        && places.all(|(&frame, &at)| recording.at(frame).contains(&Observation::new(frame, id, at)))
                };
                prop_assert!(explanations.iter().any(are_rows));
            }
        }
    }

    /// The definition, by a search: a row at the step, or a point between rows at most 1.2 s apart.
    #[test]
    fn futures_are_rows_or_lie_between_two(pace in prop::sample::select(&PACES[..]), seed in any::<u64>()) {
        let recording = recording(pace.clock(), film(pace, seed, 0.0, 0.35));
        let step = recording.frame_step();
        let tracks: BTreeMap<_, _> = recording.pedestrians().into_iter().map(|id| (id, recording.track(id))).collect();
        let position = |id, tick: i64| {
            let track = &tracks[&id];
            let off = |row: &&Observation| (row.frame - tick).abs();
            if let Some(row) = track.iter().min_by_key(off).filter(|row| off(row) * 200 <= step) {
                return Some(row.position);
            }
            let before = track.iter().rfind(|row| row.frame < tick)?;
            let after = track.iter().find(|row| row.frame > tick)?;
            let apart = after.frame - before.frame;
            let share = (tick - before.frame) as f64 / apart as f64;
            let ([x, y], [to_x, to_y]) = (before.position, after.position);
            (apart <= 3 * step).then_some([x + share * (to_x - x), y + share * (to_y - y)])
        };
        for window in partial(&recording).windows {
            let last = window.frames()[OBSERVED - 1];
            for (future, &id) in recording.futures().after(&window).iter().zip(window.pedestrians()) {
                let expected: Vec<Position> = (1..=12).map_while(|k| position(id, last + k * step)).collect();
                prop_assert_eq!(future, &expected);
            }
        }
    }
}

/// Rows of pedestrians straight on at 1.2 m/s along x, in milliseconds, given the times of each.
fn straight(times: impl Fn(i64) -> Vec<i64>, pedestrians: i64) -> Vec<Observation> {
    let of_pedestrian = |id| {
        let row = move |time| Observation::new(time, PedestrianId(id), [0.0012 * time as f64, 2.0 * id as f64]);
        times(id).into_iter().map(row)
    };
    (1..=pedestrians).flat_map(of_pedestrian).collect()
}

/// Each of the pedestrians in each window from a moment to another (s), and near the true place.
fn assert_all_observed(rows: Vec<Observation>, pedestrians: usize, from: f64, until: f64) {
    let recording = recording(Clock::with_frame_time(0.001).unwrap(), rows);
    let mut count = 0.0;
    for window in partial(&recording).windows {
        let now = window.frames()[OBSERVED - 1] as f64 * 0.001;
        if (from..until).contains(&now) {
            assert_eq!(window.len(), pedestrians, "{now} s");
            let places = (0..pedestrians).map(|i| window.observed(i)[OBSERVED - 1]);
            assert!(places.into_iter().all(|place| (place[0] - 1.2 * now).abs() < 0.1), "{window:?}");
            count += 1.0;
        }
    }
    assert!(count >= (until - from) / 0.41, "{count} moments");
}

#[test]
fn every_clock_is_observed() {
    // Every 400 ms, each from its own first row on, and three phases of a camera at 25 frames a second.
    let phases = [66, 121, 189, 278, 303, 309];
    let own = |id: i64| (0..30).map(|k| phases[id as usize - 1] + 400 * k).collect();
    assert_all_observed(straight(own, 6), 6, 0.8, 11.6);
    assert_all_observed(
        straight(|id| (0..25).map(|k| 40 * (10 * k + [0, 3, 7][id as usize - 1])).collect(), 3),
        3,
        0.8,
        9.6,
    );
    // A common clock that jitters: each at every moment from its first row on.
    let jitter = |_| (0..100).map(|k| 1_000 + RowTimes::Jitter.frame(0, k)).collect();
    let recording = recording(Clock::with_frame_time(0.001).unwrap(), straight(jitter, 4));
    assert_eq!(partial(&recording).windows.iter().map(Window::len).sum::<usize>(), 4 * 100);
    let slow = recording.observe(recording.live_tracks().with_interval(0.4)).windows;
    assert!((16..=18).contains(&slow.len()), "{} windows every 0.4 s of the last 7.1 s", slow.len());
}

/// Two rows a second, and a turn after 4.5 s: at 4.6 s nothing of it is known.
#[test]
fn between_rows_a_walk_goes_on_straight() {
    let mut tracks = LiveTracks::with_clock(Clock::with_frame_time(0.001).unwrap());
    for k in 0..10 {
        tracks.push(500 * k, [(PedestrianId(1), [0.65 * k as f64, 0.0])]).unwrap();
    }
    let window = tracks.push(4_600, [(PedestrianId(2), [9.0, 9.0])]).unwrap().unwrap();
    let (quality, track) = (window.quality(0), window.observed(0));
    assert!(distance(track[7], [5.98, 0.0]) < 0.01 && distance(track[0], [2.34, 0.0]) < 0.01, "{track:?}");
    assert!((quality.age - 0.1).abs() < 1e-12 && quality.is_whole(), "{quality:?}");
    // Carried on up to an age, then no longer.
    let present = |tracks: LiveTracks, frame| tracks.after(frame, []).unwrap().window().is_some();
    for (age, [here, gone]) in [(0.4, [4_899, 4_900]), (1.2, [5_699, 5_700]), (f64::NAN, [4_601, 4_602])] {
        let tracks = tracks.clone().with_max_age(age);
        assert_eq!((present(tracks.clone(), here), present(tracks, gone)), (age > 0.0, false), "{age}");
    }
}

/// The arrivals, and the last window, of pedestrians at 1.4 m/s along x whose rows from an index on are moved.
fn told(rate: f64, pedestrians: i64, from: usize, moved: impl Fn(i64, Position) -> Position) -> (Vec<Misfit>, Window) {
    let clock = Clock::with_frame_time(1.0 / rate).unwrap();
    let mut rows = Vec::new();
    for id in 1..=pedestrians {
        rows.extend((0..(5.0 * rate) as i64).map(|k| {
            let place = [1.4 * k as f64 / rate, 3.0 * id as f64];
            let place = if k as usize >= from { moved(id, place) } else { place };
            Observation::new(k, PedestrianId(id), place)
        }));
    }
    let mut observed = partial(&recording(clock, rows));
    (observed.misfits, observed.windows.pop().unwrap())
}

/// A row that could be a sudden turn is found to be wrong only when the next row comes; that next row is kept.
#[test]
fn the_wrong_of_two_rows_is_named() {
    let mut tracks = LiveTracks::new();
    for frame in 0..42 {
        let x = 0.72 * frame as f64 - if frame == 40 { 1.4 } else { 0.0 };
        tracks.push(frame, [(PedestrianId(1), [x, 0.0])]).unwrap();
    }
    assert!(matches!(tracks.misfits(), [Misfit { tick: 40, treatment: MisfitTreatment::LeftOut, .. }]));
    assert!(!tracks.has_left_out(PedestrianId(1)));
    tracks.push(42, [(PedestrianId(1), [0.0, 0.0])]).unwrap();
    assert!(matches!(tracks.misfits(), [Misfit { tick: 42, .. }]) && tracks.has_left_out(PedestrianId(1)));
}

/// One pedestrian with such positions until a row, and what is observed then.
fn walked(rate: f64, last: usize, place: impl Fn(usize) -> Position) -> Window {
    let clock = Clock::with_frame_time(1.0 / rate).unwrap();
    let rows = (0..=last).map(|row| Observation::new(row as i64, PedestrianId(1), place(row)));
    partial(&recording(clock, rows.collect())).windows.pop().unwrap()
}

/// Somebody who stops, turns back or steps aside at once is where the rows of 0.4 s agree that he is.
#[test]
fn rows_that_agree_are_no_longer_doubted() {
    for rate in [2.5, 5.0, 10.0] {
        for (speed, then) in [(1.5, [0.0, 0.0]), (1.2, [0.0, 0.0]), (1.5, [-1.5, 0.0]), (1.4, [0.0, 1.4])] {
            let turned = (4.0 * rate) as usize;
            let walk = move |row: usize| {
                let [before, after] = [row.min(turned), row.saturating_sub(turned)].map(|rows| rows as f64 / rate);
                [speed * before + then[0] * after, then[1] * after]
            };
            let rows = turned + (0.8 * rate) as usize;
            let window = walked(rate, rows, walk);
            assert!(window.other(0).is_none() && window.own_quality(0).age < 1e-9, "{rate} {speed} {then:?}");
        }
        for aside in [0.3, 0.4, 0.6, 0.75, 1.0] {
            let stepped = (4.0 * rate) as usize;
            let rows = stepped + (0.4 * rate).ceil() as usize;
            let window = walked(rate, rows, |row| [0.0, if row < stepped { 0.0 } else { aside }]);
            let seen = window.observed(0)[OBSERVED - 1];
            assert!(distance(seen, [0.0, aside]) < 0.05 && window.own_quality(0).age < 1e-9, "{rate} {aside} {seen:?}");
        }
    }
}

#[test]
fn a_wrong_position_is_left_out_and_told() {
    for rate in [2.5, 7.0, 10.0, 25.0] {
        for off in [1.0, 2.0, 3.0, 5.0, 8.0, 30.0] {
            let last = (5.0 * rate) as usize - 1;
            let (told, window) = told(rate, 1, last, |_, [x, y]| [x, y + off]);
            assert!(
                matches!(told[..], [Misfit { distance, treatment: MisfitTreatment::LeftOut, .. }]
                    if (distance - off).abs() < 0.1),
                "{rate} {off}: {told:?}"
            );
            let seen = window.observed(0)[OBSERVED - 1];
            assert!(distance(seen, [1.4 * last as f64 / rate, 3.0]) < 0.3, "{rate} {off}: {seen:?}");
            assert!((window.quality(0).age * rate - 1.0).abs() < 1e-9);
        }
    }
}

/// What a live stream sees of recordings with a row at every step is what they hold; nearly nothing is told: of eth,
/// whose annotations jump by .2 to .7 m, a row of a hundred.
#[test]
fn exact_recordings_are_observed_as_they_are() {
    let mut datasets = vec![Dataset::simulated(1)];
    datasets.extend(recordings::load(Convention::Star));
    for recording in datasets.iter().flat_map(Dataset::recordings) {
        let told = recording.observe(recording.live_tracks()).misfits.len();
        let seldom = if recording.name().ends_with("eth") { 100 } else { 500 };
        assert!(told <= recording.observations().len() / seldom, "{}: {told} told", recording.name());
        let complete = recording.windows(WindowRule::Complete);
        let observed = recording.windows(WindowRule::Observed);
        if told > 0 {
            continue;
        }
        assert_eq!(observed.len(), complete.len(), "{}", recording.name());
        let mut bystanders = 0;
        for (observed, complete) in observed.into_iter().zip(complete) {
            bystanders += observed.bystanders().map_or(0, Window::len);
            let others = observed.bystanders().into_iter().flat_map(Window::pedestrians);
            assert!(others.into_iter().all(|id| !complete.pedestrians().contains(id)));
            assert_eq!(observed.with_bystanders(None), complete);
        }
        assert!(bystanders > 0);
    }
}
