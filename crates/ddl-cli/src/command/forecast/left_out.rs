//! Counts and reports what is left out of a stream: invalid lines, and frames dropped for lack of time.

use crate::telling::{tell, words};
use anyhow::anyhow;
use ddl::data::{MisfitTreatment, SceneName};
use ddl::{MisfitNote, Note, WaitingWindows};
use std::time::{Duration, Instant};

/// Time between two messages of a kind, so that many invalid lines do not cause as many messages.
const PAUSE: Duration = Duration::from_secs(10);

/// Number of rows that show whether most are doubtful.
const MANY_ROWS: usize = 20;

#[derive(Debug, Default)]
pub(super) struct LeftOut {
    wrong: Seldom,
    dropped: Seldom,
    doubtful: Seldom,
    begun_anew: Seldom,
    exchanged: Seldom,
    /// Whether the warning about units has been given.
    is_unit_doubted: bool,
    is_few_told: bool,
    /// Rows, and forecasts of pedestrians whose velocity is known.
    rows: usize,
    forecast: usize,
    frames: usize,
}

/// Counts events, and limits the rate of messages about them.
#[derive(Debug, Default)]
struct Seldom {
    count: u64,
    reported: u64,
    last: Option<Instant>,
}

impl Seldom {
    /// Number of events since the last message, if the next message is due.
    fn take_due(&mut self) -> Option<u64> {
        let new = self.count - self.reported;
        if new == 0 || self.last.is_some_and(|last| last.elapsed() < PAUSE) {
            return None;
        }
        self.last = Some(Instant::now());
        self.reported = self.count;
        Some(new)
    }

    /// Counts doubtful rows, and tells of them when the next message is due.
    fn tell(&mut self, rows: usize, doubt: Option<String>) {
        self.count += rows as u64;
        if let Some(doubt) = doubt
            && let Some(new) = self.take_due()
        {
            let since = if new as usize > rows { format!(" ({new} since the last warning)") } else { String::new() };
            tell(format_args!("warning: {doubt}{since}"));
        }
    }
}

impl LeftOut {
    /// A line or a frame of one scene cannot be used. The other scenes continue.
    pub(super) fn wrong(&mut self, error: &anyhow::Error) {
        self.wrong.count += 1;
        if let Some(new) = self.wrong.take_due() {
            let others = match new {
                1 => String::new(),
                _ => format!(" (the last of {new})"),
            };
            tell(format_args!("error: {}{others}; this is left out, and the stream goes on", words(error)));
        }
    }

    /// Reports rows of a frame that were left out, and tracks that begin anew.
    pub(super) fn doubtful(&mut self, rows: usize, scene: Option<&SceneName>, misfits: &[MisfitNote]) {
        self.rows += rows;
        self.frames += 1;
        for treatment in [MisfitTreatment::LeftOut, MisfitTreatment::BegunAnew, MisfitTreatment::Exchanged] {
            let some = misfits.iter().filter(|noted| noted.misfit.treatment == treatment).cloned();
            let (some, scene): (Vec<MisfitNote>, _) = (some.collect(), scene.cloned());
            let rows = some.len();
            let doubt = (rows > 0).then(|| Note::Misfits { scene, misfits: some }.to_string());
            self.of_treatment(treatment).tell(rows, doubt);
        }
        let doubtful = self.doubtful.count + self.begun_anew.count + self.exchanged.count;
        let are_most = self.rows >= MANY_ROWS && 2 * doubtful > self.rows as u64;
        if are_most && !std::mem::replace(&mut self.is_unit_doubted, true) {
            tell(format_args!(
                "warning: most positions are too far from the ones before: are they in metres (--homography), and is \
                 the rate right (--fps)?"
            ));
        }
    }

    fn of_treatment(&mut self, treatment: MisfitTreatment) -> &mut Seldom {
        match treatment {
            MisfitTreatment::LeftOut => &mut self.doubtful,
            MisfitTreatment::BegunAnew => &mut self.begun_anew,
            MisfitTreatment::Exchanged => &mut self.exchanged,
        }
    }

    /// Counts forecasts of pedestrians whose velocity is known.
    pub(super) fn forecast(&mut self, pedestrians: usize) {
        self.forecast += pedestrians;
    }

    /// Says once why most motions are not known, if so after these numbers of rows and frames.
    pub(super) fn tell_if_few(&mut self, rows: usize, frames: usize) {
        let are_few = self.rows >= rows && self.frames >= frames && 2 * self.forecast < self.rows;
        if are_few && !std::mem::replace(&mut self.is_few_told, true) {
            tell(format_args!(
                "warning: only {} of {} positions were forecast from with a known velocity: a pedestrian needs some \
                 rows, at most 2 s apart, under one name; is the rate right, and does the tracker keep its names?",
                self.forecast, self.rows
            ));
        }
    }

    /// Reports the frames that were dropped so far.
    pub(super) fn dropped(&mut self, waiting: &WaitingWindows) {
        self.dropped.count = waiting.dropped();
        if let Some(new) = self.dropped.take_due() {
            tell(format_args!("warning: {} not forecast, because a later one of the scene came first", frames(new)));
        }
    }

    /// Reports the totals at the end of the stream; an error if lines were invalid.
    pub(super) fn end(&self, forecast: u64, waiting: Option<&WaitingWindows>) -> anyhow::Result<()> {
        let dropped = waiting.map_or(0, WaitingWindows::dropped);
        if dropped > 0 {
            let most = waiting.and_then(WaitingWindows::most_dropped);
            let most = most.map(|(scene, count)| format!(", most of them of scene {scene} ({count})"));
            tell(format_args!(
                "note: {} forecast, and {dropped} dropped, because a later one came first{}",
                frames(forecast),
                most.unwrap_or_default()
            ));
        }
        let kinds = [&self.doubtful, &self.begun_anew];
        if kinds.iter().any(|kind| kind.count > kind.reported) {
            tell(format_args!(
                "warning: {} positions were left out or began a track anew in all",
                kinds.iter().map(|kind| kind.count).sum::<u64>()
            ));
        }
        match self.wrong.count {
            0 => Ok(()),
            1 => Err(anyhow!("standard input: one line or frame was wrong, and was left out")),
            count => Err(anyhow!("standard input: {count} lines or frames were wrong, and were left out")),
        }
    }
}

fn frames(count: u64) -> String {
    match count {
        1 => "1 frame was".to_owned(),
        count => format!("{count} frames were"),
    }
}
