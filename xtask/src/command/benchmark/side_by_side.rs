//! How many tasks run at a time, and with how many threads each.

/// Tasks that share one graphics card when nobody says how many: the folds of a convention. Their kernels are small
/// and their memory is a gigabyte or two each.
const ON_ONE_CARD: usize = 5;

/// Processes side by side and the threads of each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SideBySide {
    pub(super) jobs: usize,
    pub(super) threads: usize,
}

impl SideBySide {
    /// `asked` processes for `tasks` tasks on `device`. When nobody asks: on the CPU one a core; on CUDA all tasks up to
    /// five, since a training waits for its next launch most of the time.
    pub(super) fn new(asked: Option<usize>, device: &str, cores: usize, tasks: usize) -> Self {
        let jobs = asked.unwrap_or_else(|| match device {
            "cuda" => tasks.clamp(1, ON_ONE_CARD),
            _ => cores,
        });
        Self {
            jobs,
            threads: (cores / jobs.max(1)).max(1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_takes_all_folds_at_once_and_they_share_the_cores() {
        let of = |asked, device, cores, tasks| {
            let SideBySide { jobs, threads } = SideBySide::new(asked, device, cores, tasks);
            (jobs, threads)
        };
        assert_eq!(of(None, "cuda", 16, 5), (5, 3));
        assert_eq!(of(None, "cuda", 16, 2), (2, 8));
        assert_eq!(of(None, "cuda", 2, 20), (5, 1));
        assert_eq!(of(Some(3), "cuda", 16, 20), (3, 5));
        assert_eq!(of(None, "cpu", 16, 5), (16, 1));
        assert_eq!(of(Some(2), "cpu", 16, 5), (2, 8));
        assert_eq!(of(None, "auto", 2, 5), (2, 1));
    }
}
