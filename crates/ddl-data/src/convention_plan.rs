//! The recordings and folds of each convention, as `folds.json` lists them.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::convention::Convention;
use crate::format::Format;

impl Convention {
    /// The file format of the convention; `None` for conventions without files of fixed names.
    pub(crate) fn format(self) -> Option<Format> {
        match self {
            Self::Star => Some(Format::StarCsv),
            Self::SocialGan => Some(Format::SocialGan),
            Self::Simulated | Self::Own => None,
        }
    }

    /// The files in a folder of this convention; empty where the convention has no files of fixed names.
    pub fn file_names(self) -> impl Iterator<Item = &'static str> {
        self.plan().recordings.iter().filter_map(|r| r.file.as_deref())
    }

    /// Names of the leave-one-out folds, in order; empty for own recordings.
    pub fn fold_names(self) -> impl Iterator<Item = &'static str> {
        self.plan().folds.iter().map(|f| f.name.as_str())
    }

    /// Names of the folds in which a memory of the place of the test recordings may hold training recordings
    /// ([`Fold::place_memory_confirmed_by`](crate::Fold::place_memory_confirmed_by)).
    pub fn folds_with_place_memory(self) -> impl Iterator<Item = &'static str> {
        self.plan().folds.iter().filter(|fold| !fold.place_memory.is_empty()).map(|fold| fold.name.as_str())
    }

    pub(crate) fn plan(self) -> &'static ConventionPlan {
        match self {
            Self::Star => &PLANS.star,
            Self::SocialGan => &PLANS.social_gan,
            Self::Simulated => &PLANS.simulated,
            Self::Own => &NOTHING_PLANNED,
        }
    }
}

/// One convention of `folds.json`: its recordings, and the recordings that each leave-one-out fold tests on. A fold
/// trains on all other recordings, in the order listed.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ConventionPlan {
    pub(crate) recordings: Vec<RecordingPlan>,
    pub(crate) folds: Vec<FoldPlan>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RecordingPlan {
    pub(crate) name: String,
    pub(crate) file: Option<String>,
    /// Recordings with the same place come from the same camera.
    pub(crate) place: Option<String>,
    pub(crate) frame_step: i64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FoldPlan {
    pub(crate) name: String,
    pub(crate) test: Vec<String>,
    /// The pair of [`Fold::place_memory_confirmed_by`](crate::Fold::place_memory_confirmed_by), if there is one.
    #[serde(default)]
    pub(crate) place_memory: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Plans {
    star: ConventionPlan,
    social_gan: ConventionPlan,
    simulated: ConventionPlan,
}

static NOTHING_PLANNED: ConventionPlan = ConventionPlan { recordings: Vec::new(), folds: Vec::new() };

static PLANS: LazyLock<Plans> = LazyLock::new(|| {
    // Cannot fail: the file is compiled in, and the tests below parse it.
    serde_json::from_str(include_str!("../folds.json")).expect("the compiled-in folds.json is valid")
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_test_recording_of_every_fold_exists() {
        for convention in Convention::ALL {
            let plan = convention.plan();
            let folds = if convention == Convention::Own { 0 } else { 5 };
            assert_eq!(plan.folds.len(), folds, "{convention}");
            for name in plan.folds.iter().flat_map(|f| &f.test) {
                assert!(plan.recordings.iter().any(|r| r.name == *name), "{convention}: {name}");
            }
            for recording in &plan.recordings {
                assert_eq!(recording.file.is_some(), convention.format().is_some());
            }
        }
    }
}
