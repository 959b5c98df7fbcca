//! How a plan gets on: bars in a terminal, lines elsewhere, and the time left.

use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use super::executor::{End, Watch};
use super::plan::{Plan, Task};

/// Steps of a bar.
const STEPS: u64 = 1000;

/// Without a terminal, a running task is heard of at most this often.
const QUIET: Duration = Duration::from_secs(30);

/// Shows progress on standard error.
#[derive(Debug)]
pub(crate) struct Display {
    state: Mutex<State>,
    /// None where nobody watches: lines are printed instead.
    bars: Option<MultiProgress>,
    overall: ProgressBar,
}

#[derive(Debug)]
struct State {
    estimate: Estimate,
    bars: BTreeMap<String, ProgressBar>,
    last_line: BTreeMap<String, Instant>,
    ended: usize,
    tasks: usize,
}

impl Display {
    pub(crate) fn new(plan: &Plan) -> Self {
        let bars = std::io::stderr().is_terminal().then(MultiProgress::new);
        let overall = match &bars {
            Some(bars) => bars.add(ProgressBar::new(STEPS)),
            None => ProgressBar::hidden(),
        };
        overall.set_style(style("{bar:30} {percent:>3} %  {msg}"));
        let costs = plan.tasks.iter().map(|task| (task.id.clone(), task.cost()));
        let state = State {
            estimate: Estimate::new(costs),
            bars: BTreeMap::new(),
            last_line: BTreeMap::new(),
            ended: 0,
            tasks: plan.tasks.len(),
        };
        Self {
            state: Mutex::new(state),
            bars,
            overall,
        }
    }

    /// Takes the bars away, so that what follows is printed on a clean screen.
    pub(crate) fn close(&self) {
        self.overall.finish_and_clear();
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn line(&self, text: &str) {
        match &self.bars {
            // The terminal may be gone; the work goes on.
            Some(bars) => drop(bars.println(text)),
            None => eprintln!("{text}"),
        }
    }

    fn refresh(&self, state: &State) {
        let fraction = state.estimate.fraction();
        self.overall.set_position(steps(fraction));
        self.overall.set_message(format!(
            "{} of {} tasks, {}",
            state.ended,
            state.tasks,
            state.estimate.left_in_words()
        ));
    }
}

impl Watch for Display {
    fn started(&self, task: &Task) {
        let mut state = self.state();
        if let Some(bars) = &self.bars {
            let bar = bars.insert_before(&self.overall, ProgressBar::new(STEPS));
            bar.set_style(style("{bar:30} {percent:>3} %  {prefix}  {msg}"));
            bar.set_prefix(task.id.clone());
            state.bars.insert(task.id.clone(), bar);
        } else {
            state.last_line.insert(task.id.clone(), Instant::now());
            drop(state);
            self.line(&format!("{}: started", task.id));
        }
    }

    fn advanced(&self, task: &Task, fraction: f64, message: &str) {
        let mut state = self.state();
        state.estimate.advance(&task.id, fraction);
        if let Some(bar) = state.bars.get(&task.id) {
            bar.set_position(steps(fraction));
            bar.set_message(message.to_owned());
        }
        self.refresh(&state);
        let due = state
            .last_line
            .get(&task.id)
            .is_some_and(|last| last.elapsed() >= QUIET);
        if due {
            state.last_line.insert(task.id.clone(), Instant::now());
            let left = state.estimate.left_in_words();
            drop(state);
            let percent = fraction * 100.0;
            self.line(&format!(
                "{}: {percent:.0} % ({message}); in all {left}",
                task.id
            ));
        }
    }

    fn ended(&self, task: &Task, end: &End) {
        let mut state = self.state();
        match end {
            End::Kept => state.estimate.leave_out(&task.id),
            _ => state.estimate.advance(&task.id, 1.0),
        }
        state.ended += 1;
        if let Some(bar) = state.bars.remove(&task.id) {
            bar.finish_and_clear();
        }
        self.refresh(&state);
        let (ended, tasks) = (state.ended, state.tasks);
        let left = state.estimate.left_in_words();
        drop(state);
        let id = &task.id;
        self.line(&match end {
            End::Finished { seconds } => {
                let took = human(Duration::from_secs_f64(*seconds));
                format!("{id}: done in {took} ({ended} of {tasks}; {left})")
            }
            End::Kept => format!("{id}: kept from an earlier run ({ended} of {tasks})"),
            End::Failed { reason } => format!("{id}: failed: {reason}"),
            End::Interrupted => format!("{id}: stopped"),
        });
    }
}

/// How far a bar is filled.
#[allow(clippy::cast_sign_loss, reason = "the fraction is clamped to 0..=1")]
fn steps(fraction: f64) -> u64 {
    (fraction.clamp(0.0, 1.0) * STEPS as f64) as u64
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
}

/// The time left, from the share of the expected work that is done.
#[derive(Debug)]
struct Estimate {
    start: Instant,
    /// Expected cost and done fraction of each task of this run.
    tasks: BTreeMap<String, (f64, f64)>,
}

impl Estimate {
    fn new(costs: impl Iterator<Item = (String, f64)>) -> Self {
        let tasks = costs.map(|(id, cost)| (id, (cost, 0.0))).collect();
        Self {
            start: Instant::now(),
            tasks,
        }
    }

    fn advance(&mut self, id: &str, fraction: f64) {
        if let Some((_, done)) = self.tasks.get_mut(id) {
            *done = fraction.clamp(0.0, 1.0);
        }
    }

    /// Work of an earlier run tells nothing about the speed of this one.
    fn leave_out(&mut self, id: &str) {
        self.tasks.remove(id);
    }

    fn fraction(&self) -> f64 {
        let total: f64 = self.tasks.values().map(|(cost, _)| cost).sum();
        if total <= 0.0 {
            return 1.0;
        }
        self.tasks
            .values()
            .map(|(cost, done)| cost * done)
            .sum::<f64>()
            / total
    }

    /// None until enough is done to tell.
    fn left(&self, elapsed: Duration) -> Option<Duration> {
        let fraction = self.fraction();
        (fraction > 0.01).then(|| elapsed.mul_f64((1.0 - fraction) / fraction))
    }

    fn left_in_words(&self) -> String {
        match self.left(self.start.elapsed()) {
            Some(left) => format!("about {} left", human(left)),
            None => "time left not known yet".to_owned(),
        }
    }
}

/// A duration as a person says it.
pub(crate) fn human(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, seconds) => format!("{seconds} s"),
        (0, minutes, seconds) => format!("{minutes} min {seconds} s"),
        (hours, minutes, _) => format!("{hours} h {minutes} min"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_the_work_left() {
        let costs = [("long", 3.0), ("short", 1.0)].map(|(id, cost)| (id.to_owned(), cost));
        let mut estimate = Estimate::new(costs.into_iter());
        let minute = Duration::from_mins(1);
        assert_eq!(estimate.left(minute), None);
        estimate.advance("long", 1.0);
        assert_eq!(estimate.left(minute), Some(Duration::from_secs(20)));
        estimate.advance("short", 1.0);
        assert_eq!(estimate.left(minute), Some(Duration::ZERO));
    }

    #[test]
    fn what_an_earlier_run_did_does_not_make_this_one_look_fast() {
        let costs = [("kept", 99.0), ("new", 1.0)].map(|(id, cost)| (id.to_owned(), cost));
        let mut estimate = Estimate::new(costs.into_iter());
        estimate.leave_out("kept");
        assert!(estimate.fraction().abs() < 1e-12);
        estimate.advance("new", 0.5);
        assert_eq!(
            estimate.left(Duration::from_secs(8)),
            Some(Duration::from_secs(8))
        );
        estimate.leave_out("new");
        assert!((estimate.fraction() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn durations_read_well() {
        let said = [7, 67, 3_725].map(|seconds| human(Duration::from_secs(seconds)));
        assert_eq!(said, ["7 s", "1 min 7 s", "1 h 2 min"]);
    }
}
