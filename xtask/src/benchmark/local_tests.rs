//! The executor against a stand-in for `ddl`: a shell script that obeys the same protocol.

use std::sync::Arc;
use std::time::Duration;

use super::*;
use crate::benchmark::{Settings, Stop};

/// Trains in twenty short epochs, each saved; resumes; exits 130 on an interrupt; scores in one
/// step, measures goals in none. Fold `broken` fails to train, fold `stubborn` ignores the first interrupt, fold `patient` waits for one
/// halfway, however slow the machine that sends it.
const STAND_IN: &str = r#"#!/bin/sh
verb=$1; shift
while [ $# -gt 0 ]; do
  case "$1" in
    --out|--model) run=$2;;
    --fold) fold=$2;;
    --json|--last-epoch-only) shift; continue;;
  esac
  shift 2
done
echo "pid $$ $verb" >&2
if [ "$verb" = train ]; then
  mkdir -p "$run"
  [ "$fold" = broken ] && { echo "error: the loss is not a number" >&2; exit 1; }
  stopped=
  [ "$fold" = stubborn ] && trap '' INT || trap 'stopped=1' INT
  epoch=$(cat "$run/epoch" 2>/dev/null || echo 0)
  begun=$epoch
  echo "from epoch $epoch" >&2
  while [ "$epoch" -lt 20 ]; do
    sleep 0.05
    epoch=$((epoch + 1)); echo "$epoch" > "$run/epoch"
    echo "{\"stage\":\"train\",\"done\":$epoch,\"total\":20,\"message\":\"epoch $epoch\"}"
    [ "$fold" = stubborn ] && sleep 5
    while [ "$fold" = patient ] && [ "$begun" = 0 ] && [ "$epoch" -ge 10 ] && [ -z "$stopped" ]; do sleep 0.05; done
    [ -n "$stopped" ] && exit 130
  done
  exit 0
fi
[ "$verb" = goals ] && exit 0
echo "not json"
echo '{"stage":"score","done":1.0,"total":1.0}'
echo '{}' > "$run/report.json"
"#;

/// Remembers what it hears, and wishes to stop when a task has come far enough.
#[derive(Default)]
struct Heard {
    fractions: Mutex<Vec<(String, f64)>>,
    ended: Mutex<Vec<String>>,
    stop_at: Option<(f64, Stop)>,
}

impl Watch for Heard {
    fn started(&self, _: &Task) {}

    fn advanced(&self, task: &Task, fraction: f64, _: &str) {
        self.fractions
            .lock()
            .unwrap()
            .push((task.id.clone(), fraction));
        if let Some((at, stop)) = &self.stop_at
            && fraction >= *at
            && !stop.is_requested()
        {
            stop.request();
        }
    }

    fn ended(&self, task: &Task, _: &End) {
        self.ended.lock().unwrap().push(task.id.clone());
    }
}

/// Remembers only that some task has got on.
struct Started(Arc<AtomicBool>);

impl Watch for Started {
    fn started(&self, _: &Task) {}
    fn advanced(&self, _: &Task, _: f64, _: &str) {
        self.0.store(true, Ordering::SeqCst);
    }
    fn ended(&self, _: &Task, _: &End) {}
}

struct Bench {
    folder: tempfile::TempDir,
    executor: Local,
}

impl Bench {
    fn new(jobs: usize) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let script = folder.path().join("ddl");
        fs::write(&script, STAND_IN).unwrap();
        // The shell reads the script, nothing executes it: a process that another test starts at
        // this moment may still hold it open for writing, and such a file cannot be executed.
        let executor = Local::new(PathBuf::from("sh"), jobs, 1).leading(vec![script.into()]);
        Self { folder, executor }
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn log(&self, task: &str) -> String {
        fs::read_to_string(self.out().join(task).join("log.txt")).unwrap()
    }
}

fn plan(folds: &[&str]) -> Plan {
    let settings = Settings {
        profile: "smoke".to_owned(),
        convention: "simulated".to_owned(),
        data: None,
        device: "cpu".to_owned(),
        cargo_profile: "dev".to_owned(),
        epochs: 20,
        train_walkers: None,
        proposal_steps: None,
        test_walkers: None,
        protocols: vec!["fair".to_owned()],
        recipe: crate::benchmark::RECOMMENDED,
    };
    let folds: Vec<String> = folds.iter().map(|&fold| fold.to_owned()).collect();
    Plan::new(settings, &folds, &["full".to_owned()], &[1]).unwrap()
}

#[test]
fn every_task_is_trained_scored_and_kept_the_second_time() {
    let bench = Bench::new(2);
    let plan = plan(&["a", "b", "c"]);
    let heard = Heard::default();
    let ends = bench
        .executor
        .run(&plan, &bench.out(), &heard, &Stop::default())
        .unwrap();
    assert!(
        ends.iter().all(|end| matches!(end, End::Finished { .. })),
        "{ends:?}"
    );
    assert_eq!(heard.ended.lock().unwrap().len(), 3);
    let fractions = heard.fractions.lock().unwrap();
    let of_a: Vec<f64> = fractions
        .iter()
        .filter(|(id, _)| id == "a-full-1")
        .map(|(_, fraction)| *fraction)
        .collect();
    assert_eq!(of_a.len(), 21);
    assert!(of_a.windows(2).all(|pair| pair[0] <= pair[1]), "{of_a:?}");
    assert!((of_a[20] - 1.0).abs() < 1e-12);
    assert!(bench.log("a-full-1").contains("not json"));
    let ends = bench
        .executor
        .run(&plan, &bench.out(), &Heard::default(), &Stop::default());
    assert_eq!(ends.unwrap(), [End::Kept, End::Kept, End::Kept]);
    // Scores that were deleted are made again, from the model that is there.
    fs::remove_file(bench.out().join("b-full-1/run/report.json")).unwrap();
    let ends = bench
        .executor
        .run(&plan, &bench.out(), &Heard::default(), &Stop::default());
    let again = ends
        .unwrap()
        .iter()
        .filter(|end| matches!(end, End::Finished { .. }))
        .count();
    assert_eq!(again, 1);
}

#[test]
fn a_failed_task_shows_its_log_and_lets_the_others_run() {
    let bench = Bench::new(1);
    let plan = plan(&["broken", "fine"]);
    let heard = Heard::default();
    let ends = bench
        .executor
        .run(&plan, &bench.out(), &heard, &Stop::default())
        .unwrap();
    let End::Failed { reason } = &ends[0] else {
        panic!("{ends:?}")
    };
    assert!(
        reason.contains("`ddl train` ended with exit status: 1"),
        "{reason}"
    );
    assert!(reason.contains("the loss is not a number"), "{reason}");
    assert!(reason.contains("broken-full-1/log.txt"), "{reason}");
    assert!(matches!(ends[1], End::Finished { .. }), "{ends:?}");
}

#[test]
fn an_interrupt_lets_tasks_save_and_a_second_run_goes_on() {
    let bench = Bench::new(2);
    let plan = plan(&["patient", "b", "c"]);
    let stop = Stop::default();
    let heard = Heard {
        stop_at: Some((0.2, stop.clone())),
        ..Heard::default()
    };
    let ends = bench
        .executor
        .run(&plan, &bench.out(), &heard, &stop)
        .unwrap();
    assert_eq!(ends, [End::Interrupted, End::Interrupted, End::Interrupted]);
    // The third was not begun.
    assert!(!bench.out().join("c-full-1").exists());
    let saved = fs::read_to_string(bench.out().join("patient-full-1/run/epoch")).unwrap();
    let saved: u32 = saved.trim().parse().unwrap();
    assert!((1..20).contains(&saved), "{saved}");
    let ends = bench
        .executor
        .run(&plan, &bench.out(), &Heard::default(), &Stop::default());
    assert!(
        ends.unwrap()
            .iter()
            .all(|end| matches!(end, End::Finished { .. }))
    );
    assert!(
        bench
            .log("patient-full-1")
            .contains(&format!("from epoch {saved}"))
    );
}

#[test]
fn a_second_wish_ends_a_task_that_does_not_listen() {
    let bench = Bench::new(1);
    let plan = plan(&["stubborn"]);
    let stop = Stop::default();
    let impatient = stop.clone();
    let started = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&started);
    let person = thread::spawn(move || {
        while !seen.load(Ordering::SeqCst) {
            thread::sleep(Duration::from_millis(10));
        }
        impatient.request();
        thread::sleep(Duration::from_millis(200));
        impatient.request();
    });
    let start = Instant::now();
    let ends = bench
        .executor
        .run(&plan, &bench.out(), &Started(started), &stop)
        .unwrap();
    person.join().unwrap();
    assert_eq!(ends, [End::Interrupted]);
    // Left alone, it would have slept a hundred seconds.
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn a_program_that_is_not_there_is_a_failure_of_the_task() {
    let bench = Bench::new(1);
    let executor = Local::new(PathBuf::from("/no/such/program"), 1, 1);
    let ends = executor.run(
        &plan(&["a"]),
        &bench.out(),
        &Heard::default(),
        &Stop::default(),
    );
    let ends = ends.unwrap();
    let End::Failed { reason } = &ends[0] else {
        panic!("{ends:?}")
    };
    assert!(
        reason.contains("/no/such/program cannot be started"),
        "{reason}"
    );
}

#[test]
fn who_writes_into_a_log_holds_it_until_it_ends() {
    let folder = tempfile::tempdir().unwrap();
    let log = open_log(folder.path()).unwrap();
    assert!(!is_held(&log));
    let mut left = Command::new("sleep")
        .arg("0.3")
        .stderr(Stdio::from(log.try_clone().unwrap()))
        .spawn()
        .unwrap();
    // As when a benchmark is killed: its files are closed, its process goes on.
    drop(log);
    let next = open_log(folder.path()).unwrap();
    assert!(is_held(&next));
    left.wait().unwrap();
    assert!(!is_held(&next));
}
