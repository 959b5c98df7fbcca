//! A Slurm of two nodes on this machine, in a temporary folder and without systemd.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use rustix::process::{Pid, Signal, kill_process};
use tempfile::TempDir;

use crate::debian;
use crate::workspace::program_on_path;

pub(crate) const NODES: [&str; 2] = ["n1", "n2"];

/// Largest number of tasks in an array. The benchmark has more tasks.
pub(crate) const LONGEST_ARRAY: usize = 4;

const PACKAGES: [&str; 3] = ["slurmctld", "slurmd", "munge"];

/// A running Slurm; dropping it ends the daemons.
#[derive(Debug)]
pub(crate) struct Slurm {
    folder: TempDir,
    daemons: Vec<Child>,
    nodes: Vec<Child>,
}

impl Slurm {
    /// Installs missing programs, starts the daemons, and waits until both nodes are idle.
    pub(crate) fn start() -> Result<Self> {
        if !["slurmctld", "slurmd", "munged", "sbatch"]
            .map(OsStr::new)
            .into_iter()
            .all(program_on_path)
        {
            ensure!(
                debian::can_install(),
                "Slurm is missing: install {} (on Debian, as root, this command does it)",
                PACKAGES.join(", ")
            );
            debian::install(&PACKAGES)?;
        }
        // munge refuses folders that others can write to, and a socket that others cannot reach.
        let open = fs::Permissions::from_mode(0o755);
        let folder = tempfile::Builder::new().prefix("slurm-").permissions(open).tempdir()?;
        let mut slurm = Self {
            folder,
            daemons: Vec::new(),
            nodes: Vec::new(),
        };
        slurm.configure()?;
        let at = |name: &str| format!("{}/{name}", slurm.folder.path().display());
        let munge = [
            "--foreground".to_owned(),
            format!("--key-file={}", at("key")),
            format!("--socket={}", at("socket")),
            format!("--pid-file={}", at("munged.pid")),
            format!("--log-file={}", at("munged.log")),
            format!("--seed-file={}", at("seed")),
        ];
        let munged = slurm.daemon("munged", &munge)?;
        slurm.daemons.push(munged);
        let controller = slurm.daemon("slurmctld", &["-D"])?;
        slurm.daemons.push(controller);
        for node in NODES {
            let daemon = slurm.daemon("slurmd", &["-D", "-N", node])?;
            slurm.nodes.push(daemon);
        }
        slurm.wait_for_nodes()?;
        Ok(slurm)
    }

    fn configure(&self) -> Result<()> {
        let folder = self.folder.path();
        for name in ["state", NODES[0], NODES[1]] {
            fs::create_dir(folder.join(name)).with_context(|| format!("cannot make {name}"))?;
        }
        let key = folder.join("key");
        let mut bytes = [0; 1024];
        std::io::Read::read_exact(&mut fs::File::open("/dev/urandom")?, &mut bytes)?;
        fs::write(&key, bytes)?;
        fs::set_permissions(&key, fs::Permissions::from_mode(0o400))?;
        let host = fs::read_to_string("/proc/sys/kernel/hostname")?;
        let host = host.trim().split('.').next().unwrap_or_default();
        let nodes = NODES.iter().enumerate().map(|(index, node)| {
            let port = 16_821 + index;
            format!(
                "NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=1 \
                 RealMemory=4000\n"
            )
        });
        let text = include_str!("slurm/slurm.conf")
            .replace("HOST", host)
            .replace("FOLDER", &folder.display().to_string())
            .replace("LONGEST", &LONGEST_ARRAY.to_string());
        fs::write(self.config(), nodes.fold(text, |text, node| text + &node))?;
        Ok(())
    }

    fn config(&self) -> PathBuf {
        self.folder.path().join("slurm.conf")
    }

    fn daemon(&self, program: &str, arguments: &[impl AsRef<OsStr>]) -> Result<Child> {
        self.command(program)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .with_context(|| format!("{program} cannot be started"))
    }

    fn wait_for_nodes(&self) -> Result<()> {
        let begun = Instant::now();
        // Queries fail until the controller listens.
        while self
            .ask("sinfo", &["--noheader", "--states=idle", "--format=%D"])
            .ok()
            .as_deref()
            != Some("2\n")
        {
            ensure!(
                begun.elapsed() < Duration::from_secs(30),
                "the nodes of Slurm do not become idle; is another Slurm using the ports 16817, 16821 or 16822, or is \
                     this user not root? The end of its logs:\n{}",
                self.logs()
            );
            sleep(Duration::from_millis(100));
        }
        Ok(())
    }

    fn logs(&self) -> String {
        let end = |name: &str| {
            let text = fs::read_to_string(self.folder.path().join(name)).unwrap_or_default();
            let lines: Vec<&str> = text.lines().collect();
            lines[lines.len().saturating_sub(5)..].join("\n")
        };
        ["munged.log", "slurmctld.log", "slurmd-n1.log"].map(end).join("\n")
    }

    /// A command for a program that uses this Slurm.
    pub(crate) fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        self.show_to(&mut command);
        command
    }

    pub(crate) fn show_to(&self, command: &mut Command) {
        command.env("SLURM_CONF", self.config());
    }

    /// The output of a program of Slurm.
    pub(crate) fn ask(&self, program: &str, arguments: &[&str]) -> Result<String> {
        let output = self.command(program).args(arguments).output();
        let output = output.with_context(|| format!("{program} cannot be started"))?;
        if !output.status.success() {
            let told = String::from_utf8_lossy(&output.stderr);
            bail!("`{program} {}` failed: {}", arguments.join(" "), told.trim());
        }
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    }

    /// Ends a node as a power failure would: its daemon and all processes on it, by SIGKILL.
    pub(crate) fn kill_node(&mut self, node: usize) -> Result<()> {
        self.nodes[node].kill()?;
        self.nodes[node].wait()?;
        let mine = [
            format!("SLURM_CONF={}", self.config().display()),
            format!("SLURMD_NODENAME={}", NODES[node]),
        ];
        let is_mine = |process: &Path| {
            let variables = fs::read(process.join("environ")).unwrap_or_default();
            let variables: Vec<&[u8]> = variables.split(|byte| *byte == 0).collect();
            mine.iter().all(|variable| variables.contains(&variable.as_bytes()))
        };
        let mut found = Vec::new();
        for entry in fs::read_dir("/proc")? {
            let process = entry?.path();
            let id = process.file_name().and_then(|name| name.to_str()?.parse::<i32>().ok());
            if let Some(id) = id.filter(|_| is_mine(&process)) {
                // The daemon of a job does not have the job's variables.
                found.extend(parent(id).filter(|parent| is_of_job(*parent)));
                found.push(id);
            }
        }
        ensure!(!found.is_empty(), "no process runs on {}", NODES[node]);
        for id in found.into_iter().filter_map(Pid::from_raw) {
            // It may have ended together with another one.
            let _ = kill_process(id, Signal::KILL);
        }
        Ok(())
    }

    pub(crate) fn start_node(&mut self, node: usize) -> Result<()> {
        self.nodes[node] = self.daemon("slurmd", &["-D", "-N", NODES[node]])?;
        self.wait_for_nodes()
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        // The remaining jobs would outlive the daemons.
        let _ = self.ask("scancel", &["--me", "--signal=KILL", "--full"]);
        let _ = self.ask("scancel", &["--me"]);
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_secs(20)
            && self.ask("squeue", &["--noheader"]).is_ok_and(|jobs| !jobs.is_empty())
        {
            sleep(Duration::from_millis(200));
        }
        for daemon in self.nodes.iter_mut().chain(self.daemons.iter_mut().rev()) {
            if kill_process(Pid::from_child(daemon), Signal::TERM).is_ok() {
                let _ = daemon.wait();
            }
        }
    }
}

fn parent(process: i32) -> Option<i32> {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The second field is the program's name in parentheses, which may contain any characters.
    let (_, fields) = stat.rsplit_once(')')?;
    fields.split_whitespace().nth(1)?.parse().ok()
}

fn is_of_job(process: i32) -> bool {
    let name = fs::read_to_string(format!("/proc/{process}/comm"));
    name.is_ok_and(|name| name.starts_with("slurmstepd"))
}
