//! Processes with a time limit.

use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

/// Runs a program to its end. It is an error if the program fails, or exceeds the time limit and is stopped.
pub(crate) fn run_within(command: &mut Command, limit: Duration) -> Result<()> {
    let name = command.get_program().display().to_string();
    let mut child = command.spawn().with_context(|| format!("{name} cannot be started"))?;
    let start = Instant::now();
    loop {
        match child.try_wait().context("the state of a program cannot be read")? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => bail!("{name} failed: {status}"),
            None if start.elapsed() < limit => sleep(Duration::from_millis(50)),
            None => {
                child.kill().context("a program cannot be stopped")?;
                child.wait().context("the state of a program cannot be read")?;
                bail!("{name} did not finish within {} s and was stopped", limit.as_secs());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn success_failure_and_timeout_are_distinguished() {
        let run = |script: &str, limit| {
            let mut shell = Command::new("sh");
            let outcome = run_within(shell.args(["-c", script]), Duration::from_millis(limit));
            outcome.map_err(|error| error.to_string())
        };
        assert_eq!(run("exit 0", 60_000), Ok(()));
        let failed = run("exit 3", 60_000).unwrap_err();
        assert!(failed.contains("sh failed") && failed.contains('3'), "{failed}");
        let stopped = run("exec sleep 60", 100).unwrap_err();
        assert!(stopped.contains("was stopped"), "{stopped}");
    }
}
