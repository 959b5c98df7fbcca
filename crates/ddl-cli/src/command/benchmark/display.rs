//! Progress of a plan: bars in a terminal, lines elsewhere, and the time left.

use super::plan::Task;
use super::work::{End, Event};
use crate::progress::{LINE_EVERY, ProgressLine, ProgressMode};
use crate::telling::{human, tell};
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

const STEPS: u64 = 1000;

/// Shows progress on standard error, or as JSON on standard output.
#[derive(Debug)]
pub(super) struct Display {
    mode: ProgressMode,
    /// `None` outside a terminal, where lines are printed instead.
    bars: Option<MultiProgress>,
    overall: ProgressBar,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    start: Instant,
    tasks: BTreeMap<String, Progressing>,
    ended: usize,
}

#[derive(Debug)]
struct Progressing {
    /// Expected share of the task in the work of the plan.
    cost: f64,
    done: f64,
    bar: ProgressBar,
    told: Instant,
}

impl Display {
    pub(super) fn new(tasks: &[Task], mode: ProgressMode) -> Self {
        let watched = mode == ProgressMode::Auto && std::io::stderr().is_terminal();
        let bars = watched.then(MultiProgress::new);
        let overall = match &bars {
            Some(bars) => bars.add(ProgressBar::new(STEPS)),
            None => ProgressBar::hidden(),
        };
        overall.set_style(style("{bar:30} {percent:>3} %  {msg}"));
        let costs = tasks.iter().map(|task| (task.id.as_str(), task.cost()));
        let state = Mutex::new(State::new(costs));
        Self {
            mode,
            bars,
            overall,
            state,
        }
    }

    pub(super) fn close(&self) {
        self.overall.finish_and_clear();
    }

    pub(super) fn hear(&self, task: &Task, event: Event<'_>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let line = match event {
            Event::Started => self.started(&mut state, &task.id),
            Event::Advanced(fraction, message) => self.advanced(&mut state, &task.id, fraction, message),
            Event::Ended(end) => state.ended(&task.id, end),
        };
        let left = state.left_in_words();
        self.overall.set_position(steps(state.fraction()));
        self.overall
            .set_message(format!("{} of {} tasks, {left}", state.ended, state.tasks.len()));
        let has_failed = matches!(event, Event::Ended(End::Failed { .. }));
        if let Some(line) = line {
            self.say(&line, has_failed);
        }
    }

    /// Prints a line. In modes other than `Auto` it is printed only if `must_be` is set.
    pub(super) fn say(&self, line: &str, must_be: bool) {
        match &self.bars {
            _ if self.mode != ProgressMode::Auto && !must_be => {}
            // The terminal may be closed, which must not stop the work.
            Some(bars) => drop(bars.println(line)),
            None => tell(format_args!("{line}")),
        }
    }

    fn started(&self, state: &mut State, id: &str) -> Option<String> {
        let task = state.tasks.get_mut(id)?;
        task.told = Instant::now();
        let Some(bars) = &self.bars else {
            return Some(format!("{id}: started"));
        };
        task.bar = bars.insert_before(&self.overall, ProgressBar::new(STEPS));
        task.bar.set_style(style("{bar:30} {percent:>3} %  {prefix}  {msg}"));
        task.bar.set_prefix(id.to_owned());
        None
    }

    fn advanced(&self, state: &mut State, id: &str, fraction: f64, message: &str) -> Option<String> {
        let task = state.tasks.get_mut(id)?;
        task.done = fraction.clamp(0.0, 1.0);
        task.bar.set_position(steps(fraction));
        task.bar.set_message(message.to_owned());
        let is_due = self.bars.is_none() && task.told.elapsed() >= LINE_EVERY;
        if is_due {
            task.told = Instant::now();
        }
        if self.mode == ProgressMode::Json {
            ProgressLine {
                stage: "benchmark".into(),
                done: steps(state.fraction()),
                total: STEPS,
                message: format!("{id}: {message}").into(),
            }
            .print();
        }
        let percent = fraction * 100.0;
        is_due.then(|| {
            let left = state.left_in_words();
            format!("{id}: {percent:.0} % ({message}); in all {left}")
        })
    }
}

impl State {
    fn new<'a>(costs: impl Iterator<Item = (&'a str, f64)>) -> Self {
        let start = Instant::now();
        let task = |cost| Progressing {
            cost,
            done: 0.0,
            bar: ProgressBar::hidden(),
            told: start,
        };
        Self {
            start,
            tasks: costs.map(|(id, cost)| (id.to_owned(), task(cost))).collect(),
            ended: 0,
        }
    }

    fn ended(&mut self, id: &str, end: &End) -> Option<String> {
        let task = self.tasks.get_mut(id)?;
        task.bar.finish_and_clear();
        task.done = 1.0;
        if *end == End::Kept {
            // The work of an earlier run must not count towards the speed of this one.
            task.cost = 0.0;
        }
        self.ended += 1;
        let (ended, tasks) = (self.ended, self.tasks.len());
        Some(match end {
            End::Finished { seconds } => {
                let took = human(Duration::from_secs_f64(*seconds));
                let left = self.left_in_words();
                format!("{id}: done in {took} ({ended} of {tasks}; {left})")
            }
            End::Kept => format!("{id}: kept from an earlier run ({ended} of {tasks})"),
            End::Failed { reason } => format!("{id}: failed: {reason}"),
            End::Interrupted => format!("{id}: stopped"),
        })
    }

    fn fraction(&self) -> f64 {
        let total: f64 = self.tasks.values().map(|task| task.cost).sum();
        let done: f64 = self.tasks.values().map(|task| task.cost * task.done).sum();
        if total > 0.0 { done / total } else { 1.0 }
    }

    /// `None` until 1 % of the work is done.
    fn left(&self, elapsed: Duration) -> Option<Duration> {
        let fraction = self.fraction();
        (fraction > 0.01).then(|| elapsed.mul_f64((1.0 - fraction) / fraction))
    }

    fn left_in_words(&self) -> String {
        match self.left(self.start.elapsed()) {
            Some(left) => format!("about {} left", human(left)),
            None => "time left unknown".to_owned(),
        }
    }
}

fn steps(fraction: f64) -> u64 {
    (fraction.clamp(0.0, 1.0) * STEPS as f64) as u64
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_the_work_left() {
        let mut state = State::new([("kept", 99.0), ("long", 3.0), ("short", 1.0)].into_iter());
        let finished = End::Finished { seconds: 1.0 };
        let minute = Duration::from_mins(1);
        state.ended("kept", &End::Kept);
        assert_eq!(state.left(minute), None);
        state.ended("long", &finished);
        assert_eq!(state.left(minute), Some(Duration::from_secs(20)));
        let told = state.ended("short", &finished).unwrap();
        assert!(told.starts_with("short: done in 1 s (3 of 3; "), "{told}");
        assert_eq!(state.left(minute), Some(Duration::ZERO));
    }
}
