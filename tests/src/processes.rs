//! Processor time and memory of a process, read from `/proc` on Linux. On other systems they are unknown, and the tests
//! are skipped with a message.

use std::process::{Child, Command, ExitStatus};
use std::str::FromStr;
use std::time::Duration;

/// Clock ticks per second in `/proc`.
const TICKS_A_SECOND: f64 = 100.0;

/// Processor time of the process so far, user and system time of all threads. Also available after its end, until its
/// exit status has been read.
fn processor_time(id: u32) -> Option<Duration> {
    let ticks: f64 = stat::<f64>(id, 11)? + stat::<f64>(id, 12)?;
    Some(Duration::from_secs_f64(ticks / TICKS_A_SECOND))
}

/// A field of the status of a process, counted from its state, which is field 0.
fn stat<T: FromStr>(id: u32, field: usize) -> Option<T> {
    let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    // The second field is the program's name in parentheses, which may contain any characters.
    let (_, fields) = stat.rsplit_once(')')?;
    fields.split_whitespace().nth(field)?.parse().ok()
}

/// Bytes of this process that are resident or swapped out.
pub fn resident_bytes() -> Option<u64> {
    let id = std::process::id();
    Some(status_bytes(id, "VmRSS:")? + status_bytes(id, "VmSwap:").unwrap_or(0))
}

/// Peak resident bytes of a process.
pub fn peak_bytes(id: u32) -> Option<u64> {
    status_bytes(id, "VmHWM:")
}

fn status_bytes(id: u32, name: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}

/// Waits for the end of a process; returns its status, and its processor time and peak memory if the system reports
/// them.
pub fn watch(child: &mut Child) -> (ExitStatus, Option<(Duration, u64)>) {
    let mut seen = None;
    loop {
        let time = processor_time(child.id());
        seen = time.zip(peak_bytes(child.id())).or(seen);
        if let Some(status) = child.try_wait().expect("a child can be waited for") {
            return (status, seen);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Sends a signal, such as `KILL`.
pub fn signal(id: u32, name: &str) {
    let id = id.to_string();
    let sent = Command::new("kill").args(["-s", name, &id]).output();
    // It may have ended by itself.
    drop(sent.expect("`kill` can be started"));
}

/// A process and all its descendants whose parents still exist.
pub fn with_descendants(id: u32) -> Vec<u32> {
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let ids = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
    // With the parent of each.
    let pairs: Vec<(u32, u32)> = ids.filter_map(|id| Some((stat::<u32>(id, 1)?, id))).collect();
    let mut family = vec![id];
    let mut next = 0;
    while let Some(&of) = family.get(next) {
        next += 1;
        family.extend(pairs.iter().filter(|(parent, _)| *parent == of).map(|(_, id)| id));
    }
    family
}

/// Runs `measure` in a separate process, a new start of the calling test, because the other tests of the program use
/// memory as well. The caller passes the name of its test. Returns `None` if the system does not report memory, and in
/// the new process itself.
pub fn alone(test: &str, measure: impl FnOnce() -> Option<Vec<f64>>) -> Option<Vec<f64>> {
    const FILE: &str = "DDL_TESTS_NUMBERS_FILE";
    if let Some(file) = std::env::var_os(FILE) {
        let numbers = serde_json::to_string(&measure()).expect("numbers are JSON");
        std::fs::write(file, numbers).expect("a file can be written");
        return None;
    }
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let file = folder.path().join("numbers");
    let program = std::env::current_exe().expect("a running test has a path");
    let mut command = Command::new(program);
    let output = command.args(["--exact", test]).env(FILE, &file).output();
    let output = output.expect("the test can be started again");
    assert!(output.status.success(), "{output:?}");
    let numbers = std::fs::read(file).expect("the test of that name measures");
    let numbers: Option<Vec<f64>> = serde_json::from_slice(&numbers).expect("numbers are JSON");
    if numbers.is_none() {
        eprintln!("skipped: this system does not report the memory of a process");
    }
    numbers
}
