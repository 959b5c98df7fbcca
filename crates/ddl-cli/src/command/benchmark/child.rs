//! A process that can be asked to stop while its output is read.

use crate::interrupt::Interrupt;
use crate::telling::tell;
use anyhow::Context as _;
use std::io::{BufRead as _, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// Time between two checks for a request to stop and for the end of a process.
pub(super) const BEAT: Duration = Duration::from_millis(20);

pub(super) fn this_program() -> anyhow::Result<PathBuf> {
    std::env::current_exe().context("cannot find the path of this program")
}

/// Runs a process to its end in its own process group, which Ctrl-C does not reach. The first request to stop is passed
/// on as SIGTERM: the process then saves its state. Further requests kill it.
pub(super) fn run(
    command: &mut Command,
    interrupt: &Interrupt,
    mut hear: impl FnMut(&str),
) -> anyhow::Result<ExitStatus> {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start {}", command.get_program().display()))?;
    let output = child.stdout.take().context("a process has no output")?;
    let (sender, lines) = mpsc::channel();
    thread::spawn(move || {
        let lines = BufReader::new(output).lines().map_while(Result::ok);
        // The receiver is gone when the process has ended.
        for line in lines {
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    let mut passed_on = 0;
    loop {
        let has_closed = match lines.recv_timeout(BEAT) {
            Ok(line) => {
                hear(&line);
                false
            }
            Err(RecvTimeoutError::Timeout) => false,
            Err(RecvTimeoutError::Disconnected) => true,
        };
        if (has_closed || passed_on > 1)
            && let Some(status) = child.try_wait()?
        {
            return Ok(status);
        }
        if has_closed {
            thread::sleep(BEAT);
        }
        let wishes = interrupt.wishes();
        if wishes > passed_on {
            passed_on = wishes;
            stop(&mut child, wishes > 1);
        }
    }
}

/// Asks a process to stop, or kills it. It is not an error if the process has just ended.
fn stop(child: &mut Child, at_once: bool) {
    #[cfg(unix)]
    if !at_once {
        use rustix::process::{Pid, Signal, kill_process};
        if kill_process(Pid::from_child(child), Signal::TERM).is_err() {
            tell(format_args!("warning: cannot send SIGTERM to process {}", child.id()));
        }
        return;
    }
    let _ = at_once;
    let _ = child.kill();
}
