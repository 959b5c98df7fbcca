//! How the node does: counts, latency, and what was wrong, as `diagnostic_msgs/DiagnosticArray`.

use crate::tell;
use ddl_ros::msg::{DiagnosticArray, DiagnosticStatus, Header, KeyValue, Time};
use std::collections::{BTreeSet, VecDeque};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Time between two reports.
const PAUSE: Duration = Duration::from_secs(1);
/// Time without tracks after which the node is stale.
const STALE: Duration = Duration::from_secs(2);
/// Latencies that the quantiles are of.
const KEPT: usize = 1000;
/// Faults that are told; the others only count.
const MOST_TOLD: usize = 100;

const NO_TRACKS: &str = "no tracks: check topic, type, domain and quality of service";

/// Levels of `diagnostic_msgs/DiagnosticStatus`.
const OK: u8 = 0;
const WARNING: u8 = 1;
const IS_STALE: u8 = 3;

#[derive(Debug, Default)]
pub(crate) struct Health {
    /// Messages with tracks that arrived, and those without a forecast because of a fault.
    pub(crate) frames: u64,
    dropped: u64,
    pub(crate) forecasts: u64,
    /// Messages without a forecast, because a newer one had come.
    pub(crate) skipped: u64,
    /// Messages that did not arrive.
    pub(crate) lost: u64,
    /// Messages that were moved by a transform older than they are.
    pub(crate) held: u64,
    pub(crate) left_out: usize,
    pub(crate) doubtful: usize,
    /// How often time went back.
    pub(crate) restarts: u64,
    /// Milliseconds from the arrival of a message to its forecast.
    latencies: VecDeque<f64>,
    last_error: String,
    told: BTreeSet<String>,
    heard: Option<Instant>,
    reported: Option<(Instant, u64)>,
}

impl Health {
    pub(crate) fn note_message(&mut self) {
        self.frames += 1;
        self.heard = Some(Instant::now());
    }

    pub(crate) fn answered(&mut self, latency: f64) {
        self.forecasts += 1;
        self.latencies.push_back(latency);
        if self.latencies.len() > KEPT {
            self.latencies.pop_front();
        }
    }

    /// Counts a frame that has no forecast because of a fault.
    pub(crate) fn dropped(&mut self, error: &anyhow::Error) {
        self.dropped += 1;
        self.fault(error);
    }

    /// Tells a fault, unless one was told that differs in numbers alone.
    pub(crate) fn fault(&mut self, error: &anyhow::Error) {
        self.last_error = format!("{error:#}");
        self.warn(&format!("{error:#}"));
    }

    pub(crate) fn warn(&mut self, text: &str) {
        let kind = text.replace(|letter: char| letter.is_ascii_digit() || letter == '.', "");
        if self.told.len() < MOST_TOLD && self.told.insert(kind) {
            tell(&format!("warning: {text} (told once; /diagnostics counts)"));
        }
    }

    /// A report, a second after the last one.
    pub(crate) fn report(&mut self, node: &str) -> Option<DiagnosticArray> {
        let dropped_before = match self.reported {
            Some((at, _)) if at.elapsed() < PAUSE => return None,
            Some((_, dropped)) => dropped,
            None => 0,
        };
        self.reported = Some((Instant::now(), self.dropped));
        let is_stale = self.heard.get_or_insert_with(Instant::now).elapsed() > STALE;
        if is_stale {
            self.warn(NO_TRACKS);
        }
        let (level, message) = match (is_stale, self.dropped - dropped_before) {
            (true, _) => (IS_STALE, NO_TRACKS.to_owned()),
            (false, 0) => (OK, "forecasting".to_owned()),
            (false, dropped) => (WARNING, format!("{dropped} frames dropped: {}", self.last_error)),
        };
        let mut sorted: Vec<f64> = self.latencies.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let quantile = |share: f64| sorted.get((share * sorted.len() as f64) as usize).map_or(f64::NAN, |value| *value);
        let values = [
            ("frames", self.frames.to_string()),
            ("forecasts", self.forecasts.to_string()),
            ("dropped", self.dropped.to_string()),
            ("skipped", self.skipped.to_string()),
            ("lost", self.lost.to_string()),
            ("transforms held", self.held.to_string()),
            ("rows left out", self.left_out.to_string()),
            ("doubtful positions", self.doubtful.to_string()),
            ("times gone back", self.restarts.to_string()),
            ("latency p50 (ms)", format!("{:.2}", quantile(0.5))),
            ("latency p99 (ms)", format!("{:.2}", quantile(0.99))),
            ("last error", self.last_error.clone()),
        ];
        let values = values.map(|(key, value)| KeyValue { key: key.to_owned(), value });
        let status = DiagnosticStatus {
            level,
            name: format!("{node}: forecasts"),
            message,
            hardware_id: String::new(),
            values: values.into(),
        };
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Some(DiagnosticArray {
            header: Header { stamp: Time::of_microseconds(now.as_micros() as i64), ..Header::default() },
            status: vec![status],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_has_all_counts_and_warns_of_frames_dropped_since_the_last() {
        let mut health = Health::default();
        (health.skipped, health.lost, health.held, health.left_out) = (3, 4, 5, 6);
        (health.doubtful, health.restarts) = (7, 8);
        // The 1000 newest latencies count: 1000, 999 .. 1.
        (1..=1002).rev().for_each(|latency| health.answered(latency.into()));
        (0..2).for_each(|_| health.note_message());
        health.dropped(&anyhow::anyhow!("no 1.5"));
        // Moments 3 s ago and in an hour, whatever the load of the machine.
        let ahead = Instant::now() + Duration::from_hours(1);
        let ago = Instant::now().checked_sub(Duration::from_secs(3)).unwrap();
        let mut said = |heard, reported| {
            health.heard = Some(heard);
            health.reported = Some((reported, health.reported.map_or(0, |(_, dropped)| dropped)));
            let status = health.report("ddl")?.status.remove(0);
            let values: Vec<_> = status.values.into_iter().map(|pair| pair.value).collect();
            assert_eq!(values.join(" "), "2 1002 1 3 4 5 6 7 8 501.00 991.00 no 1.5");
            Some((status.level, status.message))
        };
        assert_eq!(said(ahead, ahead), None);
        assert_eq!(said(ahead, ago), Some((1, "1 frames dropped: no 1.5".to_owned())));
        assert_eq!(said(ahead, ago), Some((0, "forecasting".to_owned())));
        assert_eq!(said(ago, ago), Some((3, NO_TRACKS.to_owned())));
    }
}
