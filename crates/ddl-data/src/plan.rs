//! What is known of a convention before any file is read: its files, recordings, folds and window rule.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::convention::Convention;
use crate::format::Format;
use crate::rule::{SOCIAL_GAN_FEWEST, WindowRule};

impl Convention {
    /// How the convention's files are written; `None` for those that have no files of fixed names.
    pub fn format(self) -> Option<Format> {
        match self {
            Self::Star => Some(Format::StarCsv),
            Self::SocialGan => Some(Format::SocialGan),
            Self::Simulated | Self::Own => None,
        }
    }

    /// The window rule that the convention's published numbers are measured with: the one of headline tables.
    pub fn headline_rule(self) -> WindowRule {
        match self {
            Self::Star => WindowRule::Published,
            Self::SocialGan => WindowRule::SocialGan {
                min_pedestrians: SOCIAL_GAN_FEWEST,
            },
            Self::Simulated | Self::Own => WindowRule::Complete,
        }
    }

    /// The files that a folder of this convention holds; none where they have no fixed names.
    pub fn file_names(self) -> impl Iterator<Item = &'static str> {
        self.plan()
            .recordings
            .iter()
            .filter_map(|r| r.file.as_deref())
    }

    /// Names of the recordings, in order.
    pub fn recording_names(self) -> impl Iterator<Item = &'static str> {
        self.plan().recordings.iter().map(|r| r.name.as_str())
    }

    /// Names of the leave-one-out folds, in order; none for own recordings, whose folds [the data set](crate::Dataset::fold_names) knows.
    pub fn fold_names(self) -> impl Iterator<Item = &'static str> {
        self.plan().folds.iter().map(|f| f.name.as_str())
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

/// One convention of `folds.json`: which recordings it has, and which ones each leave-one-out fold tests on.
///
/// A fold trains on every recording that it does not test on, in the order listed.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ConventionPlan {
    pub(crate) recordings: Vec<RecordingPlan>,
    pub(crate) folds: Vec<FoldPlan>,
}

/// One recording of `folds.json`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RecordingPlan {
    pub(crate) name: String,
    pub(crate) file: Option<String>,
    pub(crate) frame_step: i64,
}

/// One fold of `folds.json`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FoldPlan {
    pub(crate) name: String,
    pub(crate) test: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Plans {
    star: ConventionPlan,
    social_gan: ConventionPlan,
    simulated: ConventionPlan,
}

static NOTHING_PLANNED: ConventionPlan = ConventionPlan {
    recordings: Vec::new(),
    folds: Vec::new(),
};

static PLANS: LazyLock<Plans> = LazyLock::new(|| {
    // Compiled in, so wrong only if this crate itself is; the tests below read it.
    serde_json::from_str(include_str!("../folds.json"))
        .expect("the compiled-in folds.json is valid")
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
                assert!(
                    plan.recordings.iter().any(|r| r.name == *name),
                    "{convention}: {name}"
                );
            }
            for recording in &plan.recordings {
                assert_eq!(recording.file.is_some(), convention.format().is_some());
            }
        }
    }

    #[test]
    fn names_are_read_back() {
        for convention in Convention::ALL {
            assert_eq!(convention.to_string().parse(), Ok(convention));
            let json = serde_json::to_string(&convention).unwrap();
            assert_eq!(json, format!("\"{convention}\""));
        }
        let error = "Star".parse::<Convention>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "\"Star\" is no data convention; choose one of star, social-gan, simulated, own"
        );
    }
}
