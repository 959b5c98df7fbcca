//! A queue of camera frames that one core forecasts.

use crate::Result;
use crate::cameras::{Camera, FRAME};
use ddl::data::{Completeness, LiveTracks, OBSERVED, SceneName};
use ddl::{Ddl, LiveScenes};
use rustix::time::{ClockId, clock_gettime};
use std::collections::BTreeMap;

pub(crate) struct Figures {
    /// Seconds from a complete frame to its forecast, sorted.
    latencies: Vec<f64>,
    pub(crate) dropped_share: f64,
    /// Share of the time in which the core was busy.
    pub(crate) busy: f64,
}

impl Figures {
    pub(crate) fn latency(&self, share: f64) -> f64 {
        self.latencies[(share * (self.latencies.len() - 1) as f64).round() as usize]
    }
}

fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

fn timed<T>(work: impl FnOnce() -> Result<T>) -> Result<(T, f64)> {
    let before = processor_time();
    let made = work()?;
    Ok((made, processor_time() - before))
}

/// Cameras after 7 frames: from the next frame on, all their pedestrians have 8 observations and can be forecast.
fn watched(cameras: usize) -> Result<(Vec<Camera>, LiveScenes)> {
    let mut cameras: Vec<Camera> = (0..cameras).map(Camera::new).collect::<Result<_>>()?;
    let mut scenes = LiveScenes::new(LiveTracks::new().with_completeness(Completeness::Partial)).latest_only();
    for camera in &mut cameras {
        for frame in 0..OBSERVED as i64 - 1 {
            let seen = camera.frame(frame);
            scenes.observe(Some(&camera.name), frame, seen)?;
            // Discards the waiting windows, so that they are not measured.
            scenes.next_batch(usize::MAX);
        }
    }
    Ok((cameras, scenes))
}

/// Processor time (s) per camera and frame, in batches of `batch` cameras: the median over the batches.
pub(crate) fn service(model: &Ddl, batch: usize, frames: usize) -> Result<f64> {
    let (mut cameras, mut scenes) = watched(batch)?;
    let mut times = Vec::new();
    for frame in (OBSERVED as i64 - 1..).take(frames.div_ceil(batch)) {
        let seen: Vec<_> = cameras.iter_mut().map(|it| it.frame(frame)).collect();
        let ((), seconds) = timed(|| {
            for (camera, seen) in cameras.iter().zip(seen) {
                scenes.observe(Some(&camera.name), frame, seen)?;
            }
            for made in scenes.forecast(model, usize::MAX) {
                made.forecast?;
            }
            Ok(())
        })?;
        times.push(seconds / batch as f64);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}

/// Simulates the queue: the clock advances by the processor time of the work, and idle time is skipped.
pub(crate) fn simulated(model: &Ddl, cameras: usize, frames: usize) -> Result<Figures> {
    let (mut cameras, mut scenes) = watched(cameras)?;
    let dropped_before = scenes.dropped();
    let mut due: Vec<(f64, usize, i64)> = Vec::new();
    for (number, camera) in cameras.iter().enumerate() {
        due.extend((0..frames).map(|frame| {
            let time = FRAME * (frame as f64 + camera.phase);
            (time, number, (frame + OBSERVED) as i64 - 1)
        }));
    }
    due.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut due = due.into_iter().peekable();
    // Arrival time of the waiting frame of each scene.
    let mut came: BTreeMap<SceneName, f64> = BTreeMap::new();
    let (mut now, mut busy, mut latencies) = (0.0, 0.0, Vec::new());
    loop {
        if scenes.waiting() == 0 {
            let Some(&(next, ..)) = due.peek() else { break };
            now = next.max(now);
        }
        let mut work = 0.0;
        while let Some((time, camera, frame)) = due.next_if(|&(time, ..)| time <= now + work) {
            let camera = &mut cameras[camera];
            let seen = camera.frame(frame);
            let name = Some(&camera.name);
            work += timed(|| Ok(scenes.observe(name, frame, seen)?))?.1;
            came.insert(camera.name.clone(), time);
        }
        let (made, seconds) = timed(|| Ok(scenes.forecast(model, LiveScenes::BATCH)))?;
        work += seconds;
        now += work;
        busy += work;
        for made in made {
            made.forecast?;
            let scene = made.scene.ok_or("a camera has a name")?;
            latencies.push(now - came[&scene]);
        }
    }
    let (total, dropped) = (cameras.len() * frames, scenes.dropped() - dropped_before);
    if latencies.len() as u64 + dropped != total as u64 {
        return Err(format!(
            "of {total} frames {} were forecast and {dropped} dropped",
            latencies.len()
        )
        .into());
    }
    latencies.sort_by(f64::total_cmp);
    Ok(Figures {
        latencies,
        dropped_share: dropped as f64 / total as f64,
        busy: busy / now,
    })
}

/// Memory per camera (KiB): after 7 frames, including the simulation of the camera; and in addition while a frame
/// waits.
pub(crate) fn memory(cameras: usize) -> Result<[f64; 2]> {
    let before = resident()?;
    let (mut seen, mut scenes) = watched(cameras)?;
    let watched = resident()?;
    for camera in &mut seen {
        let frame = OBSERVED as i64 - 1;
        let seen = camera.frame(frame);
        scenes.observe(Some(&camera.name), frame, seen)?;
    }
    let waiting = resident()?;
    let per_camera = |bytes: f64| bytes / cameras as f64;
    Ok([per_camera(watched - before), per_camera(waiting - watched)])
}

/// Resident memory of the process (KiB).
fn resident() -> Result<f64> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kib = line.and_then(|line| line.split_whitespace().next());
    Ok(kib.ok_or("no VmRSS in /proc/self/status")?.parse()?)
}
