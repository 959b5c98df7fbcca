//! The tasks of a plan as jobs of Slurm. The plan's folder shows which tasks are finished, `squeue` which jobs exist. A
//! job belongs to the plan whose folder is its working folder, so no list of jobs is kept, and `sacct` is not needed.

mod array;
mod queue;

use crate::command::benchmark::child::this_program;
use crate::output::shell_word;
use crate::telling::tell;
use anyhow::{Context as _, ensure};
use ddl::data::write_atomically;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

#[derive(Debug)]
pub(super) struct Slurm {
    /// The plan's folder, spelled as `squeue` prints it.
    out: PathBuf,
    /// Arguments of the scripts of all jobs: the working folder, the program and its arguments.
    arguments: Vec<OsString>,
}

impl Slurm {
    pub(super) fn new(out: &Path, commit: &str) -> anyhow::Result<Self> {
        let unreadable = || format!("cannot read {}", out.display());
        let out = out.canonicalize().with_context(unreadable)?;
        let here = std::env::current_dir().context("cannot read the current folder")?;
        let mut arguments: Vec<OsString> = vec![here.into(), this_program()?.into()];
        arguments.extend(["benchmark", "--commit", commit, "--out"].map(OsString::from));
        arguments.push(out.clone().into());
        Ok(Self { out, arguments })
    }

    /// The numbers of the jobs of this folder that have not ended.
    pub(super) fn queue(&self) -> anyhow::Result<Vec<String>> {
        let mut squeue = Command::new("squeue");
        // Filters that the user has set would hide jobs.
        for (name, _) in std::env::vars_os() {
            if name.to_string_lossy().starts_with("SQUEUE_") {
                squeue.env_remove(name);
            }
        }
        squeue.args(["--me", "--noheader", "--format", queue::FORMAT]);
        Ok(queue::jobs_in(&self.out, &answer(&mut squeue)?))
    }

    /// Submits these tasks of the plan, `jobs` of them at a time, and a job that makes the report after them.
    pub(super) fn submit(&self, tasks: &[usize], jobs: Option<usize>, threads: usize) -> anyhow::Result<()> {
        let logs = self.out.join("slurm");
        fs::create_dir_all(&logs).with_context(|| format!("cannot make {}", logs.display()))?;
        let config = answer(Command::new("scontrol").args(["show", "config"]))?;
        let at_a_time = jobs.map_or_else(String::new, |jobs| format!("%{jobs}"));
        let mut submitted: Vec<String> = Vec::new();
        for array in array::arrays(tasks, array::longest(&config)?) {
            let mut options = vec![
                format!("--job-name={}{}", queue::NAME, array.first),
                format!("--array={}{at_a_time}", array.indices),
                format!("--cpus-per-task={threads}"),
            ];
            // The limit holds for all arrays together.
            if let (Some(_), Some(before)) = (jobs, submitted.last()) {
                options.push(format!("--dependency=afterany:{before}"));
            }
            let first = [OsString::from(array.first.to_string())];
            let script = ("task.sh", include_str!("slurm/task.sh"));
            let id = self
                .sbatch(&options, script, &first)
                .with_context(|| match submitted.join(" ") {
                    none if none.is_empty() => "no task is submitted".to_owned(),
                    some => format!(
                        "only some tasks are submitted, as jobs {some}; run the same command again later for the rest"
                    ),
                })?;
            submitted.push(id);
        }
        let options = [
            format!("--job-name={}", queue::REPORT),
            format!("--dependency=afterany:{}", submitted.join(":")),
            "--cpus-per-task=1".to_owned(),
        ];
        let script = ("report.sh", include_str!("slurm/report.sh"));
        let report = self.sbatch(&options, script, &[]);
        let report = report.context(
            "the tasks are submitted, but not the job that makes the report: run the same command again, or use \
             `--collect`",
        )?;
        let submitted = submitted.join(" ");
        tell(format_args!(
            "submitted: {} tasks with {threads} threads each as job {submitted}, and job {report} for the report; logs \
             are in {}; `squeue --me` shows the jobs, `scancel {submitted} {report}` cancels them",
            tasks.len(),
            logs.display()
        ));
        Ok(())
    }

    /// Submits a job and returns its number.
    fn sbatch(&self, options: &[String], (name, script): (&str, &str), first: &[OsString]) -> anyhow::Result<String> {
        let file = self.out.join("slurm").join(name);
        let unwritable = || format!("cannot write {}", file.display());
        write_atomically(&file, script.as_bytes()).with_context(unwritable)?;
        let mut sbatch = Command::new("sbatch");
        sbatch
            .args(["--parsable", "--chdir"])
            .arg(&self.out)
            .args(options)
            .arg(&file)
            .args(first)
            .args(&self.arguments);
        let answer_of_sbatch = answer(&mut sbatch)?;
        // On a site with several clusters Slurm prints `number;cluster`.
        let id = answer_of_sbatch.trim().split(';').next().unwrap_or_default();
        ensure!(
            !id.is_empty() && id.bytes().all(|byte| byte.is_ascii_digit()),
            "`sbatch` printed {answer_of_sbatch:?} instead of the number of a job"
        );
        Ok(id.to_owned())
    }
}

/// The output of a program of Slurm.
fn answer(command: &mut Command) -> anyhow::Result<String> {
    let name = command.get_program().display().to_string();
    let output = command
        .output()
        .with_context(|| format!("cannot start `{name}`: `--executor slurm` needs Slurm's programs on this machine"))?;
    ensure!(
        output.status.success(),
        "`{}` failed ({}): {}",
        shown(&name, command.get_args()),
        output.status,
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn shown<'a>(name: &str, arguments: impl Iterator<Item = &'a OsStr>) -> String {
    arguments.fold(name.to_owned(), |shown, argument| {
        shown + " " + &shell_word(Path::new(argument))
    })
}

#[cfg(all(test, unix))]
mod tests;
