//! Programs that may hang: they are given a time.

use std::process::{Child, Command, ExitStatus};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

/// How often a program is asked whether it is done.
const GLANCE: Duration = Duration::from_millis(50);

/// Runs a program to its end; one that fails, or is not done in time and is then stopped, is an error.
pub(super) fn run_within(command: &mut Command, limit: Duration) -> Result<()> {
    let name = command.get_program().display().to_string();
    let mut child = command
        .spawn()
        .with_context(|| format!("{name} cannot be started"))?;
    match wait(&mut child, limit).with_context(|| format!("{name} cannot be waited for"))? {
        Some(status) if status.success() => Ok(()),
        Some(status) => bail!("{name} failed: {status}"),
        None => bail!(
            "{name} was not done after {} s and was stopped",
            limit.as_secs()
        ),
    }
}

fn wait(child: &mut Child, limit: Duration) -> std::io::Result<Option<ExitStatus>> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if start.elapsed() >= limit {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        sleep(GLANCE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ends_well_fails_or_hangs_is_told_apart() {
        let run = |script: &str, limit| {
            let mut shell = Command::new("sh");
            run_within(shell.args(["-c", script]), Duration::from_millis(limit))
        };
        assert!(run("exit 0", 60_000).is_ok());
        let failed = run("exit 3", 60_000).unwrap_err().to_string();
        assert!(
            failed.contains("sh failed") && failed.contains('3'),
            "{failed}"
        );
        let stopped = run("exec sleep 60", 100).unwrap_err().to_string();
        assert!(stopped.contains("was stopped"), "{stopped}");
        let absent = run_within(
            &mut Command::new("no-such-program-anywhere"),
            Duration::ZERO,
        );
        assert!(
            absent
                .unwrap_err()
                .to_string()
                .contains("cannot be started")
        );
    }
}
