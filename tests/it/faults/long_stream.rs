//! A day of live tracks: memory and time per frame stay constant. Measured in a separate process, because the other
//! tests of this program use memory as well.

use ddl::data::{LiveTracks, PedestrianId, Position};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Request, Session};
use ddl_tests::{nightly, processes};
use std::time::Instant;

/// Frames per hour, 0.4 s apart.
const HOUR: usize = 9_000;
const MIB: u64 = 1 << 20;

/// The pedestrians at a frame: a new one every 12 frames, each present for 20 to 50 frames and walking at 1.25 m/s.
fn pedestrians(frame: i64) -> Vec<(PedestrianId, Position)> {
    let mut pedestrians = Vec::new();
    for id in (frame / 12 - 4).max(0)..=frame / 12 {
        let age = frame - 12 * id;
        let stays = 20 + id * 7 % 31;
        if age < stays {
            let lane = (id % 5) as f64;
            let place = [0.5 * age as f64, lane + 0.1 * (0.3 * age as f64).sin()];
            pedestrians.push((PedestrianId(id), place));
        }
    }
    pedestrians
}

/// The median and the 99th percentile of durations in seconds, as milliseconds.
fn quantiles(seconds: &mut [f64]) -> [f64; 2] {
    seconds.sort_by(f64::total_cmp);
    [0.5, 0.99].map(|q| 1e3 * seconds[(q * (seconds.len() - 1) as f64) as usize])
}

/// The child process: streams `frames` frames and measures the first and last `part`. `push` adds a frame, and says
/// whether there is a window and how many pedestrians are kept.
fn stream(mut push: impl FnMut(i64) -> (bool, usize), (frames, part): (usize, usize)) -> Option<Vec<f64>> {
    let mut seconds = vec![0.0; frames];
    let (mut early, mut most) = (0, 0);
    for (frame, seconds) in seconds.iter_mut().enumerate() {
        let begun = Instant::now();
        let (is_window, kept) = push(frame as i64);
        *seconds = begun.elapsed().as_secs_f64();
        assert_eq!(is_window, frame >= 7, "a pedestrian is always present");
        most = most.max(kept);
        if frame + 1 == part {
            early = processes::resident_bytes()?;
        }
    }
    let late = processes::resident_bytes()?;
    let peak = processes::peak_bytes(std::process::id())?;
    let [median, p99] = quantiles(&mut seconds[..part].to_vec());
    let [last_median, last_p99] = quantiles(&mut seconds[frames - part..].to_vec());
    let [early, late, peak] = [early, late, peak].map(|bytes| bytes as f64);
    Some(vec![early, late, peak, most as f64, median, p99, last_median, last_p99])
}

#[test]
fn a_day_of_forecasts_needs_constant_memory() {
    let size = nightly::rounds((3_000, 600), (24 * HOUR, HOUR));
    watched("a live stream, one forecast per pedestrian", "a_day_of_forecasts_needs_constant_memory", size, || {
        ddl::prepare(DeviceChoice::Cpu, Some(1)).unwrap();
        let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu).unwrap();
        let mut session = Session::new(model, LiveTracks::new(), Request::one()).unwrap();
        let push = |frame| {
            let now = session.push(frame, pedestrians(frame)).unwrap();
            (now.answer.is_some(), session.tracks(None).map_or(0, LiveTracks::len))
        };
        stream(push, size)
    });
}

#[test]
fn a_day_of_tracks_needs_constant_memory() {
    let size = (24 * HOUR, HOUR);
    watched("live tracks alone", "a_day_of_tracks_needs_constant_memory", size, || {
        let mut tracks = LiveTracks::new();
        stream(|frame| (tracks.push(frame, pedestrians(frame)).unwrap().is_some(), tracks.len()), size)
    });
}

fn watched(what: &str, test: &str, (frames, part): (usize, usize), stream: impl FnOnce() -> Option<Vec<f64>>) {
    let Some(numbers) = processes::alone(&format!("faults::long_stream::{test}"), stream) else {
        return;
    };
    let [early, late, peak, most, median, p99, last_median, last_p99] = numbers[..] else {
        panic!("{numbers:?}");
    };
    assert!(most <= 6.0, "{most} pedestrians remembered");
    // The reserves of allocators; 8 bytes lost per frame would add 1.7 MB a day.
    let growth = late - early;
    assert!(growth <= 8.0 * MIB as f64, "{growth} bytes more");
    // The machine may be busy in one of the measurements, so a factor of two is not a trend.
    assert!(last_median < 3.0 * median, "{median} ms, then {last_median} ms");
    let mib = |bytes: f64| bytes / MIB as f64;
    eprintln!(
        "{what}, {frames} frames of 0.4 s: {:.1} MiB after {part}, {:.1} MiB at the end (peak {:.1}); a frame takes \
         {median:.3} ms at first (p99 {p99:.3}), {last_median:.3} ms at last (p99 {last_p99:.3})",
        mib(early),
        mib(late),
        mib(peak),
    );
}
