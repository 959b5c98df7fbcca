//! `cargo xtask cluster`: `ddl benchmark --executor slurm` on a real Slurm of two nodes on this machine.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Child, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use rustix::process::{Pid, Signal, kill_process};

use super::{benchmark, set_up};
use crate::data;
use crate::slurm::{LONGEST_ARRAY, NODES, Slurm};
use crate::workspace::Workspace;

/// Slurm notices a lost node after half a minute and restarts its tasks two minutes later.
const LIMIT: Duration = Duration::from_mins(10);

pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    set_up(workspace)?;
    let convention = data::choose(workspace, None, None, &mut |_| {})?.convention;
    let folder = workspace.path("target/cluster");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("{} cannot be deleted", folder.display()))?;
    }
    fs::create_dir_all(&folder)?;
    let begun = Instant::now();
    let slurm = Slurm::start()?;
    tell("Slurm is up", begun);
    let mut cluster = Cluster {
        workspace: workspace.clone(),
        slurm,
        folder,
        convention: convention.to_string(),
        folds: convention.fold_names().map(str::to_owned).collect(),
    };
    for (name, check) in CHECKS {
        let begun = Instant::now();
        check(&mut cluster).with_context(|| format!("{name}; logs are in {}", cluster.folder.display()))?;
        tell(name, begun);
    }
    Ok(())
}

type Check = (&'static str, fn(&mut Cluster) -> Result<()>);

const CHECKS: [Check; 5] = [
    ("all folds on this machine alone", Cluster::here),
    (
        "all folds on Slurm in two arrays: a second command only watches, Ctrl-C leaves the first one, same report",
        Cluster::watched,
    ),
    (
        "a node is lost: its task restarts automatically, with the same results",
        Cluster::lost_node,
    ),
    (
        "Slurm warns of the time limit: the task saves, is queued again, and resumes to the same results",
        Cluster::warned,
    ),
    (
        "a task is cancelled: it saves and is not queued again; the same command resumes to the same results",
        Cluster::cancelled,
    ),
];

fn tell(name: &str, begun: Instant) {
    println!("| {name} | {:.0} s |", begun.elapsed().as_secs_f64());
}

struct Cluster {
    workspace: Workspace,
    slurm: Slurm,
    folder: PathBuf,
    convention: String,
    folds: Vec<String>,
}

/// A running `ddl benchmark`.
struct Begun {
    child: Child,
    log: PathBuf,
}

/// A task in Slurm's queue.
#[derive(Debug)]
struct Element {
    /// Such as `12_3`.
    id: String,
    state: String,
    reason: String,
    node: String,
}

impl Cluster {
    /// Starts `ddl benchmark` of the first folds in the folder of this name.
    fn begin(&self, name: &str, folds: usize, words: &[&str], variables: &[(&str, &str)]) -> Result<Begun> {
        let folds = self.folds[..folds].join(",");
        let out = self.folder.join(name).display().to_string();
        let options = ["--profile", "smoke", "--cargo-profile", "dev"].into_iter();
        let options = options.chain(["--convention", &self.convention]);
        let options = options.chain(["--folds", &folds, "--out", &out]);
        let options = options.chain(words.iter().copied()).map(str::to_owned);
        let options = options.collect();
        let mut command = benchmark::command(&self.workspace, options)?;
        self.slurm.show_to(&mut command);
        let logs = fs::read_dir(&self.folder)?.count();
        let log = self.folder.join(format!("{name}-{logs}.log"));
        let child = command
            .envs(variables.iter().copied())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(File::create(&log)?)
            .spawn()
            .context("cargo cannot be started")?;
        Ok(Begun { child, log })
    }

    fn on_slurm(&self, name: &str, folds: usize, variables: &[(&str, &str)]) -> Result<Begun> {
        self.begin(name, folds, &["--executor", "slurm"], variables)
    }

    fn here(&mut self) -> Result<()> {
        self.begin("here", self.folds.len(), &[], &[])?.end(0)
    }

    fn watched(&mut self) -> Result<()> {
        let first = self.on_slurm("watched", self.folds.len(), &[])?;
        until("tasks that run", || Ok(self.running()?.get(1).map(drop)))?;
        let submitted = self.jobs()?;
        let arrays = self.folds.len().div_ceil(LONGEST_ARRAY);
        ensure!(
            submitted.len() == arrays + 1,
            "expected {arrays} arrays and a report, found the jobs {submitted:?}"
        );
        let second = self.on_slurm("watched", self.folds.len(), &[])?;
        second.until_it_tells("nothing is submitted")?;
        kill_process(Pid::from_child(&first.child), Signal::INT)?;
        first.until_it_tells("its jobs go on")?;
        first.end(130)?;
        let live = self.jobs()?;
        ensure!(live == submitted, "jobs {submitted:?} have become {live:?}");
        second.end(0)?;
        let submitted = self.jobs()?;
        ensure!(submitted.is_empty(), "jobs {submitted:?} are left");
        for file in ["report.json", "report.md", "moments.json"] {
            self.compare("watched", file)?;
        }
        self.compare_tasks("watched", self.folds.len())
    }

    fn lost_node(&mut self) -> Result<()> {
        let run = self.on_slurm("lost-node", NODES.len(), &[])?;
        self.until_trained_in("lost-node", NODES.len())?;
        let running = self.running()?;
        let node = 0;
        let lost = running.iter().find(|element| element.node == NODES[node]);
        let lost = lost.context("nothing runs on the node")?.id.clone();
        self.slurm.kill_node(node)?;
        let again = |element: &Element| element.id == lost && element.state == "PENDING";
        until("its task in the queue again", || {
            Ok(self.elements()?.iter().any(again).then_some(()))
        })?;
        self.slurm.start_node(node)?;
        run.end(0)?;
        self.ensure_restarts(&lost, 1)?;
        self.compare_tasks("lost-node", NODES.len())
    }

    fn warned(&mut self) -> Result<()> {
        let short = [("SBATCH_TIMELIMIT", "2"), ("SBATCH_SIGNAL", "B:INT@110")];
        let run = self.on_slurm("warned", NODES.len(), &short)?;
        let warned = until("a warned task in the queue again", || {
            let elements = self.elements()?;
            Ok(elements.into_iter().find(|element| element.reason == "BeginTime"))
        })?;
        for element in self.elements()? {
            // One of them may have just ended.
            let _ = self.update(&element.id, "TimeLimit=60");
        }
        self.update(&warned.id, "StartTime=now")?;
        run.end(0)?;
        self.ensure_restarts(&warned.id, 1)?;
        self.compare_tasks("warned", NODES.len())
    }

    fn cancelled(&mut self) -> Result<()> {
        let run = self.on_slurm("cancelled", 1, &[])?;
        self.until_trained_in("cancelled", 1)?;
        let id = self.running()?.first().context("nothing runs")?.id.clone();
        self.slurm.ask("scancel", &[&id])?;
        run.until_it_tells("1 of 1 tasks are not finished")?;
        run.end(1)?;
        self.ensure_restarts(&id, 0)?;
        let log = self.folder.join(format!("cancelled/{}-full-1/log.txt", self.folds[0]));
        let log = fs::read_to_string(log)?;
        ensure!(log.contains("interrupted"), "the training did not save: {log}");
        self.on_slurm("cancelled", 1, &[])?.end(0)?;
        self.compare_tasks("cancelled", 1)
    }

    /// Waiting and running tasks.
    fn elements(&self) -> Result<Vec<Element>> {
        let lines = self
            .slurm
            .ask("squeue", &["--noheader", "--array", "--format=%F_%K|%T|%r|%N"])?;
        let element = |line: &str| {
            let mut fields = line.split('|').map(str::to_owned);
            let mut next = || fields.next().context("squeue prints too little");
            Ok(Element {
                id: next()?,
                state: next()?,
                reason: next()?,
                node: next()?,
            })
        };
        let of_tasks = lines.lines().filter(|line| !line.contains("_N/A"));
        of_tasks.map(element).collect()
    }

    fn running(&self) -> Result<Vec<Element>> {
        let mut elements = self.elements()?;
        elements.retain(|element| element.state == "RUNNING");
        Ok(elements)
    }

    /// Numbers of the arrays and of other jobs.
    fn jobs(&self) -> Result<BTreeSet<String>> {
        let lines = self.slurm.ask("squeue", &["--noheader", "--format=%F"])?;
        Ok(lines.lines().map(str::to_owned).collect())
    }

    fn update(&self, id: &str, what: &str) -> Result<String> {
        self.slurm.ask("scontrol", &["update", &format!("JobId={id}"), what])
    }

    fn ensure_restarts(&self, id: &str, times: usize) -> Result<()> {
        let job = self.slurm.ask("scontrol", &["show", "job", id])?;
        ensure!(
            job.contains(&format!(" Restarts={times} ")),
            "job {id} was not restarted {times} times: {job}"
        );
        Ok(())
    }

    /// Waits until the first stage of `tasks` tasks is trained and the second is running.
    fn until_trained_in(&self, name: &str, tasks: usize) -> Result<()> {
        let trained = |fold: &String| {
            let run = format!("{name}/{fold}-full-1/run/proposal.safetensors");
            self.folder.join(run).exists()
        };
        until("a trained first stage", || {
            Ok(self.folds[..tasks].iter().all(trained).then_some(()))
        })
    }

    /// Checks that a file equals the one made on this machine without Slurm.
    fn compare(&self, name: &str, file: &str) -> Result<()> {
        let read = |folder: &str| {
            let file = self.folder.join(folder).join(file);
            fs::read(&file).with_context(|| format!("{} cannot be read", file.display()))
        };
        ensure!(read(name)? == read("here")?, "{name}/{file} differs from here/{file}");
        Ok(())
    }

    fn compare_tasks(&self, name: &str, folds: usize) -> Result<()> {
        for fold in &self.folds[..folds] {
            for file in [
                "model.safetensors",
                "proposal.safetensors",
                "report.json",
                "moments.json",
            ] {
                self.compare(name, &format!("{fold}-full-1/run/{file}"))?;
            }
        }
        Ok(())
    }
}

impl Begun {
    fn told(&self) -> Result<String> {
        Ok(fs::read_to_string(&self.log)?)
    }

    fn until_it_tells(&self, words: &str) -> Result<()> {
        until(words, || Ok(self.told()?.contains(words).then_some(())))
    }

    fn end(mut self, code: i32) -> Result<()> {
        let status: ExitStatus = until("the end of `ddl benchmark`", || Ok(self.child.try_wait()?))?;
        if status.code() != Some(code) {
            bail!(
                "`ddl benchmark` ended with {status} instead of {code}:\n{}",
                self.told()?
            );
        }
        Ok(())
    }
}

fn until<T>(what: &str, mut look: impl FnMut() -> Result<Option<T>>) -> Result<T> {
    let begun = Instant::now();
    loop {
        if let Some(found) = look()? {
            return Ok(found);
        }
        ensure!(
            begun.elapsed() < LIMIT,
            "{what:?} did not happen within {} s",
            LIMIT.as_secs()
        );
        sleep(Duration::from_millis(100));
    }
}
