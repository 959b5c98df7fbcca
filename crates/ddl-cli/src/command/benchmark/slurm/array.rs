//! Job arrays, no longer than the site allows.

use anyhow::{Context as _, ensure};

/// One array of tasks: its `indices` count from the plan's task `first`.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Array {
    pub(super) first: usize,
    /// In the form of `sbatch --array`, as in `0-3,7`.
    pub(super) indices: String,
}

/// The largest number of indices of an array, from what `scontrol show config` prints.
pub(super) fn longest(config: &str) -> anyhow::Result<usize> {
    let mut lines = config.lines().filter_map(|line| line.split_once('='));
    let (_, value) = lines
        .find(|(name, _)| name.trim() == "MaxArraySize")
        .context("`scontrol show config` does not print MaxArraySize")?;
    let longest = value
        .trim()
        .parse()
        .with_context(|| format!("`scontrol show config` prints MaxArraySize ={value}, which is not a number"))?;
    ensure!(
        longest > 0,
        "this Slurm allows no arrays of jobs (MaxArraySize = 0): use `--executor none` and run the tasks by other means"
    );
    Ok(longest)
}

/// Arrays that hold all `tasks`, which are in ascending order.
pub(super) fn arrays(tasks: &[usize], longest: usize) -> Vec<Array> {
    tasks
        .chunk_by(|one, next| one / longest == next / longest)
        .map(|tasks| {
            let first = tasks[0] / longest * longest;
            let runs = tasks.chunk_by(|one, next| one + 1 == *next);
            let runs = runs.map(|run| match (run[0] - first, run[run.len() - 1] - first) {
                (one, last) if one == last => one.to_string(),
                (one, last) => format!("{one}-{last}"),
            });
            Array {
                first,
                indices: runs.collect::<Vec<_>>().join(","),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_no_longer_than_allowed_and_hold_every_task_once() {
        let shown = |tasks: &[usize], longest| {
            let arrays = arrays(tasks, longest);
            let shown = arrays.iter().map(|array| format!("{}+{}", array.first, array.indices));
            shown.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(shown(&[0, 1, 2, 3, 4], 1001), "0+0-4");
        assert_eq!(shown(&[1, 3, 4, 9], 1001), "0+1,3-4,9");
        assert_eq!(shown(&[0, 1, 2, 3, 4, 7], 4), "0+0-3 4+0,3");
        assert_eq!(shown(&[5, 6], 1), "5+0 6+0");
        assert_eq!(shown(&[2500], 1001), "2002+498");
    }

    #[test]
    fn the_limit_is_read_and_errors_name_it() {
        let config = "Configuration data as of 2026\nMaxArraySize            = 1001\nMaxBatchRequeue = 5\n";
        assert_eq!(longest(config).unwrap(), 1001);
        for (config, words) in [
            (config.replace("1001", "0"), "no arrays of jobs (MaxArraySize = 0)"),
            (config.replace("1001", "many"), "MaxArraySize = many"),
            (String::new(), "does not print MaxArraySize"),
        ] {
            let error = longest(&config).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
