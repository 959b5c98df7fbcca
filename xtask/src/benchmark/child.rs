//! Child processes that can be asked to stop while others wait for them.

use std::collections::BTreeMap;
use std::os::unix::process::CommandExt as _;
use std::process::{Child, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use anyhow::{Context, Result};

use super::executor::Stop;

/// How often a wish to stop and the end of a child are looked for.
pub(super) const BEAT: Duration = Duration::from_millis(20);

/// The running children.
#[derive(Debug, Default)]
pub(super) struct Children(Mutex<BTreeMap<u32, Running>>);

#[derive(Debug)]
struct Running {
    child: Child,
    /// How many wishes to stop it has been told of.
    told: usize,
}

impl Children {
    /// Starts a child in a process group of its own and gives its standard output.
    ///
    /// In a terminal Ctrl-C reaches the whole foreground group; children outside it hear of it
    /// once, from [`Children::forward`], and not twice.
    pub(super) fn start(&self, command: &mut Command) -> Result<(u32, ChildStdout)> {
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .process_group(0)
            .spawn()
            .with_context(|| format!("{} cannot be started", command.get_program().display()))?;
        let stdout = child.stdout.take().context("a child has no output")?;
        let id = child.id();
        self.lock().insert(id, Running { child, told: 0 });
        Ok((id, stdout))
    }

    /// Waits for a child that has closed its output.
    ///
    /// The child stays in the list until it is gone, under the lock that [`Children::forward`]
    /// takes: no signal can reach another process that got the same number.
    pub(super) fn wait(&self, id: u32) -> Result<ExitStatus> {
        loop {
            let mut running = self.lock();
            let entry = running.get_mut(&id).context("a child is not in the list")?;
            let status = entry
                .child
                .try_wait()
                .context("a child cannot be waited for")?;
            if let Some(status) = status {
                running.remove(&id);
                return Ok(status);
            }
            drop(running);
            std::thread::sleep(BEAT);
        }
    }

    /// Tells every child of wishes to stop that it has not heard of: the first as an interrupt,
    /// which lets it save, any further one as a kill.
    pub(super) fn forward(&self, stop: &Stop) {
        let wishes = stop.wishes();
        for (id, running) in self
            .lock()
            .iter_mut()
            .filter(|(_, running)| running.told < wishes)
        {
            if wishes > 1 {
                // It may have ended this moment, which is as good.
                let _ = running.child.kill();
            } else {
                interrupt(*id);
            }
            running.told = wishes;
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeMap<u32, Running>> {
        // A panic elsewhere leaves the list as it was: children must still be told to stop.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Sends SIGINT by the shell's own `kill`: the standard library has no call for it.
fn interrupt(id: u32) {
    let sent = Command::new("sh")
        .arg("-c")
        .arg(format!("kill -INT {id}"))
        .status();
    if !sent.is_ok_and(|status| status.success()) {
        eprintln!("warning: process {id} could not be asked to stop");
    }
}
