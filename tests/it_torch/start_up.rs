//! How long `ddl forecast` takes from its start to its first output.

use ddl::Variant;
use ddl_tests::{own_tracks, processes, program, tiny_model};
use std::io::Read as _;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// The promise, of a release build: loading libtorch, the model and the expert library (12,000 simulated walkers), and a forecast.
const RELEASE: Duration = Duration::from_secs(1);
/// Rust is optimised in a debug build too, but the binding of libtorch is not, and assertions are on.
const DEBUG: Duration = Duration::from_secs(2);
/// The best of so many counts: the others were held up by something else.
const RUNS: usize = 3;

/// Processor time until the first byte is there, or a little later, as the process goes on meanwhile.
fn until_first_output(folder: &Path) -> Option<Duration> {
    let mut command = program::command(folder, "forecast --model . tracks.csv --threads 1");
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut output = child.stdout.take().unwrap();
    let mut first = [0];
    output.read_exact(&mut first).unwrap();
    let time = processes::processor_time(child.id());
    let mut rest = String::new();
    output.read_to_string(&mut rest).unwrap();
    assert!(child.wait().unwrap().success());
    assert!(rest.lines().count() > 100, "no forecast: {rest}");
    time
}

/// Processor time and not the clock's, so that other work on the machine does not decide.
#[test]
fn the_first_output_comes_soon() {
    let folder = tiny_model::folder(Variant::Full);
    let tracks = own_tracks::csv(&own_tracks::three_people(8));
    std::fs::write(folder.path().join("tracks.csv"), tracks).unwrap();
    let runs: Option<Vec<Duration>> = (0..RUNS)
        .map(|_| until_first_output(folder.path()))
        .collect();
    let Some(runs) = runs else {
        eprintln!("skipped: this system does not tell the processor time of a process");
        return;
    };
    let best = runs.iter().min().unwrap();
    let most = if cfg!(debug_assertions) {
        DEBUG
    } else {
        RELEASE
    };
    assert!(
        *best <= most,
        "{runs:?} of processor time, at most {most:?}"
    );
    // libtorch alone registers thousands of operators: less would mean that nothing is measured
    assert!(*best >= Duration::from_millis(30), "{runs:?}");
}
