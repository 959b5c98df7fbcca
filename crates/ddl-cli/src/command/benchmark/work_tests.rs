//! The workers with a stand-in for `ddl`: a shell script with the same options, output and exit codes.
#![cfg(unix)]

use super::super::choice::tests::plan_of;
use super::super::method::Method;
use super::*;
use std::path::PathBuf;
use std::time::Duration;

const STAND_IN: &str = include_str!("stand_in.sh");

struct Bench {
    folder: tempfile::TempDir,
    workers: Workers,
}

impl Bench {
    fn new(jobs: usize) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let script = folder.path().join("ddl");
        fs::write(&script, STAND_IN).unwrap();
        // The shell reads the script instead of executing it. Execution could fail, because a process of another test
        // may still hold the file open for writing.
        let workers =
            Workers { program: vec!["sh".into(), script.into()], jobs, threads: 1, commit: "of a test".to_owned() };
        Self { folder, workers }
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn log(&self, task: &str) -> String {
        fs::read_to_string(self.out().join(task).join("log.txt")).unwrap()
    }

    fn run(&self, plan: &BenchmarkPlan) -> Vec<TaskEnd> {
        let ignore = |_: &Task, _: Event<'_>| {};
        self.workers.run(plan, &self.out(), &ignore, &Interrupt::default())
    }
}

fn plan(folds: &[&str]) -> BenchmarkPlan {
    let settings = plan_of("--epochs 20").unwrap().settings;
    BenchmarkPlan::new(settings, folds, &[Method::FULL], &[1]).unwrap()
}

fn finished(ends: &[TaskEnd]) -> usize {
    let mut ends = ends.to_vec();
    ends.retain(|end| matches!(end, TaskEnd::Finished { .. }));
    ends.len()
}

#[test]
fn every_task_is_trained_scored_and_kept_the_second_time() {
    let bench = Bench::new(2);
    let plan = plan(&["a", "b", "c"]);
    let of_a = Mutex::new(Vec::new());
    let ended = AtomicUsize::new(0);
    let watch = |task: &Task, event: Event<'_>| match event {
        Event::Advanced(fraction, _) if task.fold == "a" => of_a.lock().unwrap().push(fraction),
        Event::Ended(_) => drop(ended.fetch_add(1, Ordering::SeqCst)),
        _ => {}
    };
    let ends = bench.workers.run(&plan, &bench.out(), &watch, &Interrupt::default());
    assert_eq!((finished(&ends), ended.into_inner()), (3, 3), "{ends:?}");
    let of_a = of_a.into_inner().unwrap();
    assert_eq!(of_a.len(), 21);
    assert!(of_a.is_sorted() && (of_a[20] - 1.0).abs() < 1e-12);
    assert!(bench.log("a-full-1").contains("not json"));
    assert_eq!(bench.run(&plan), [TaskEnd::Kept, TaskEnd::Kept, TaskEnd::Kept]);
    // Deleted scores are made again from the model.
    fs::remove_file(bench.out().join("b-full-1/run/report.json")).unwrap();
    assert_eq!(finished(&bench.run(&plan)), 1);
}

#[test]
fn a_failed_task_shows_its_log_and_lets_the_others_run() {
    let mut bench = Bench::new(1);
    let ends = bench.run(&plan(&["broken", "fine"]));
    let [TaskEnd::Failed { reason }, TaskEnd::Finished { .. }] = &ends[..] else { panic!("{ends:?}") };
    assert!(reason.contains("`ddl train` ended with exit status: 1"), "{reason}");
    assert!(reason.contains("the loss is not a number") && reason.contains("broken-full-1/log.txt"));
    bench.workers.program = vec!["/no/such/program".into()];
    let ends = bench.run(&plan(&["a"]));
    let [TaskEnd::Failed { reason }] = &ends[..] else { panic!("{ends:?}") };
    assert!(reason.contains("cannot start /no/such/program"));
}

#[test]
fn interrupted_tasks_save_and_a_second_run_resumes_them() {
    let bench = Bench::new(2);
    let plan = plan(&["patient", "b", "c"]);
    let interrupt = Interrupt::default();
    let watch = |_: &Task, event: Event<'_>| {
        if let Event::Advanced(fraction, _) = event
            && fraction >= 0.1
            && interrupt.wishes() == 0
        {
            interrupt.wish();
        }
    };
    let ends = bench.workers.run(&plan, &bench.out(), &watch, &interrupt);
    assert_eq!(ends, [TaskEnd::Interrupted, TaskEnd::Interrupted, TaskEnd::Interrupted]);
    assert!(!bench.out().join("c-full-1").exists());
    let saved = fs::read_to_string(bench.out().join("patient-full-1/run/epoch")).unwrap();
    let saved: u32 = saved.trim().parse().unwrap();
    assert!((1..20).contains(&saved), "{saved}");
    // A half-written file of a killed process is removed.
    let half = bench.out().join("b-full-1/.writing-x");
    fs::write(&half, "half").unwrap();
    assert_eq!(finished(&bench.run(&plan)), 3);
    assert!(!half.exists());
    let resumed = format!("from epoch {saved}");
    assert!(bench.log("patient-full-1").contains(&resumed));
}

#[test]
fn a_second_interrupt_kills_a_task_that_ignores_the_first() {
    let bench = Bench::new(1);
    let interrupt = Interrupt::default();
    let watch = |_: &Task, event: Event<'_>| {
        if let Event::Advanced(..) = event {
            interrupt.wish();
            thread::spawn({
                let interrupt = interrupt.clone();
                move || {
                    thread::sleep(Duration::from_millis(200));
                    interrupt.wish();
                }
            });
        }
    };
    let start = Instant::now();
    let ends = bench.workers.run(&plan(&["stubborn"]), &bench.out(), &watch, &interrupt);
    assert_eq!(ends, [TaskEnd::Interrupted]);
    // Without the second interrupt it would have slept a hundred seconds.
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn a_process_that_writes_into_a_log_holds_its_lock() {
    let folder = tempfile::tempdir().unwrap();
    let log = open_log(folder.path()).unwrap();
    assert!(!is_held(&log));
    let mut left = Command::new("sleep").arg("0.3").stderr(Stdio::from(log.try_clone().unwrap())).spawn().unwrap();
    // As when a benchmark is killed: its files are closed, and its process continues.
    drop(log);
    let next = open_log(folder.path()).unwrap();
    assert!(is_held(&next));
    left.wait().unwrap();
    assert!(!is_held(&next));
}

#[test]
fn a_card_takes_all_folds_at_once_and_they_share_the_cores() {
    use DeviceChoice::{Auto, Cpu, Cuda};
    for (asked, device, cores, tasks, expected) in [
        (None, Cuda, 16, 5, (5, 3)),
        (None, Cuda, 16, 2, (2, 8)),
        (None, Cuda, 2, 20, (5, 1)),
        (Some(3), Cuda, 16, 20, (3, 5)),
        (None, Cpu, 16, 5, (16, 1)),
        (Some(2), Cpu, 16, 5, (2, 8)),
        (None, Auto, 2, 5, (2, 1)),
    ] {
        assert_eq!(side_by_side(asked, device, cores, tasks), expected);
    }
}
