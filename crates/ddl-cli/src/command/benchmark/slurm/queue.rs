//! The jobs of one folder in the output of `squeue`.

use std::collections::BTreeSet;
use std::path::Path;

/// Number of the job or array, name, working folder.
pub(super) const FORMAT: &str = "%F|%j|%Z";

/// Names of jobs begin with this: `ddl-` and the plan's index of the first task of an array, or `ddl-report`.
pub(super) const NAME: &str = "ddl-";
pub(super) const REPORT: &str = "ddl-report";

/// The numbers of the jobs and arrays of the folder `out`, each once, among the lines of `squeue`.
pub(super) fn jobs_in(out: &Path, lines: &str) -> Vec<String> {
    let number = |line: &str| {
        let mut fields = line.splitn(3, '|');
        let (number, name, folder) = (fields.next()?, fields.next()?, fields.next()?);
        let first_task = name.strip_prefix(NAME)?.parse::<usize>();
        let is_of_benchmark = name == REPORT || first_task.is_ok();
        (is_of_benchmark && Path::new(folder) == out).then(|| number.to_owned())
    };
    let numbers: BTreeSet<String> = lines.lines().filter_map(number).collect();
    numbers.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As Slurm 22.05 prints them.
    const LINES: &str = "\
        9|ddl-report|/data/a run\n\
        8|ddl-0|/data/a run\n\
        8|ddl-0|/data/a run\n\
        10|ddl-1000|/data/a run\n\
        4|ddl-0|/data/a run/other\n\
        5|ddl-evaluation|/data/a run\n\
        6|bash|/data/a run\n";

    #[test]
    fn jobs_of_other_folders_are_left_out() {
        assert_eq!(jobs_in(Path::new("/data/a run"), LINES), ["10", "8", "9"]);
        assert!(jobs_in(Path::new("/data"), LINES).is_empty());
        assert!(jobs_in(Path::new("/data/a run"), "slurm_load_jobs error\n").is_empty());
    }
}
