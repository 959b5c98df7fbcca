//! The numbers of hypotheses, where a file gives them: those of one number are one joint future of the scene.

use super::error::ExternalProblem;

/// From where a file counts its hypotheses, once its first pedestrian has shown it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct HypothesisNumbering {
    first: Option<i64>,
}

impl HypothesisNumbering {
    /// Holds sorted numbers to 0 ... K - 1 or 1 ... K, the same for all pedestrians of the file.
    pub(super) fn check(
        &mut self,
        sorted: &[i64],
        pedestrian: &str,
    ) -> Result<(), ExternalProblem> {
        let counts_from = |first: i64| sorted.iter().copied().eq((first..).take(sorted.len()));
        let first = match self.first {
            Some(first) => Some(first).filter(|&first| counts_from(first)),
            None => [0, 1].into_iter().find(|&first| counts_from(first)),
        };
        if first.is_some() {
            self.first = first;
            return Ok(());
        }
        let last = sorted.len() as i64 - 1;
        let expected = match self.first {
            Some(first) => format!("{} as before", range(first, first + last)),
            None => format!("{} or {}", range(0, last), range(1, 1 + last)),
        };
        let found: Vec<String> = sorted.iter().map(i64::to_string).collect();
        Err(ExternalProblem::Numbers {
            pedestrian: pedestrian.to_owned(),
            numbers: format!("{}, expected {expected}", found.join(", ")),
        })
    }
}

fn range(first: i64, last: i64) -> String {
    if first == last {
        first.to_string()
    } else {
        format!("{first} to {last}")
    }
}
