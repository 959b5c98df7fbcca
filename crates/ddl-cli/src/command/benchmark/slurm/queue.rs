//! The jobs of one folder in the output of `squeue`.

use std::collections::BTreeSet;
use std::path::Path;

/// Number of the job or array, index in it, state, reason, nodes, name, working folder.
pub(super) const FORMAT: &str = "%F|%K|%T|%r|%N|%j|%Z";
const FIELDS: usize = 7;

/// Names of jobs: of an array of tasks (followed by the plan's index of its first task), and of the report.
pub(super) const TASKS: &str = "ddl-";
pub(super) const REPORT: &str = "ddl-report";

/// Ordinary reasons to wait, which are not shown.
const USUAL: [&str; 3] = ["None", "Priority", "Resources"];

#[derive(Debug, Clone, PartialEq, Eq)]
pub(in super::super) struct Job {
    id: String,
    /// Index in the plan; `None` for the job that makes the report.
    pub(super) task: Option<usize>,
    state: String,
    reason: String,
    nodes: String,
}

impl Job {
    /// The state as text.
    pub(super) fn state(&self) -> String {
        let state = self.state.to_lowercase();
        match (self.nodes.as_str(), self.reason.as_str()) {
            ("", reason) if USUAL.contains(&reason) => state,
            ("", reason) => format!("{state} ({reason})"),
            (nodes, _) => format!("{state} on {nodes}"),
        }
    }
}

/// The numbers of jobs and arrays, each once, as `scancel` takes them.
pub(in super::super) fn ids(jobs: &[Job]) -> String {
    let ids: BTreeSet<&str> = jobs.iter().map(|job| job.id.as_str()).collect();
    ids.into_iter().collect::<Vec<_>>().join(" ")
}

/// The jobs of `out` among the lines of `squeue`.
pub(super) fn jobs_in(out: &Path, lines: &str) -> Vec<Job> {
    let job = |line: &str| {
        let fields: Vec<&str> = line.splitn(FIELDS, '|').collect();
        let &[id, index, state, reason, nodes, name, folder] = fields.as_slice() else {
            return None;
        };
        let first = name.strip_prefix(TASKS)?;
        let task = match first.parse::<usize>() {
            Ok(first) => Some(first + index.parse::<usize>().ok()?),
            Err(_) if name == REPORT => None,
            Err(_) => return None,
        };
        (Path::new(folder) == out).then(|| Job {
            id: id.to_owned(),
            task,
            state: state.to_owned(),
            reason: reason.to_owned(),
            nodes: nodes.to_owned(),
        })
    };
    lines.lines().filter_map(job).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As Slurm 22.05 prints them.
    const LINES: &str = "\
        9|N/A|PENDING|Dependency||ddl-report|/data/a run\n\
        8|0|PENDING|BeginTime||ddl-0|/data/a run\n\
        8|3|RUNNING|None|n1|ddl-0|/data/a run\n\
        10|2|PENDING|Resources||ddl-1000|/data/a run\n\
        4|0|RUNNING|None|n2|ddl-0|/data/a run/other\n\
        5|N/A|RUNNING|None|n2|ddl-evaluation|/data/a run\n\
        6|N/A|RUNNING|None|n2|bash|/data/a run\n";

    #[test]
    fn jobs_of_other_folders_are_left_out() {
        let jobs = jobs_in(Path::new("/data/a run"), LINES);
        let shown: Vec<(Option<usize>, String)> = jobs.iter().map(|job| (job.task, job.state())).collect();
        let expected = [
            (None, "pending (Dependency)"),
            (Some(0), "pending (BeginTime)"),
            (Some(3), "running on n1"),
            (Some(1002), "pending"),
        ];
        assert_eq!(shown, expected.map(|(task, state)| (task, state.to_owned())));
        assert_eq!(ids(&jobs), "10 8 9");
        assert_eq!(jobs_in(Path::new("/data"), LINES), []);
        assert_eq!(jobs_in(Path::new("/data/a run"), "slurm_load_jobs error\n"), []);
    }
}
