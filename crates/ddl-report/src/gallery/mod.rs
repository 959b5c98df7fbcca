//! Which cases are shown, and why: chosen by rule, not by hand.

use std::fmt;

use serde::{Deserialize, Serialize};

mod choose;

pub use choose::moments;

/// What a case shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Show {
    /// A pedestrian who reaches the goal of the representative hypothesis.
    Convergence,
    /// People who walk together.
    Group,
    /// A pedestrian who slows down.
    SlowingDown,
    /// People who pass each other and keep their distance.
    KeepingDistance,
    /// A pedestrian who turns.
    Turning,
}

impl Show {
    /// Every one, in the order in which they are shown.
    pub const ALL: [Self; 5] = [
        Self::Convergence,
        Self::Group,
        Self::SlowingDown,
        Self::KeepingDistance,
        Self::Turning,
    ];
}

impl fmt::Display for Show {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Convergence => "convergence",
            Self::Group => "walking together",
            Self::SlowingDown => "slowing down",
            Self::KeepingDistance => "keeping distance",
            Self::Turning => "turning",
        })
    }
}

/// Why a moment is shown, and whom to look at.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Pick {
    /// What it shows.
    pub show: Show,
    /// Indices of the pedestrians it is about, in the order of the moment.
    #[serde(rename = "walkers")]
    pub pedestrians: Vec<usize>,
    /// By which rule it was picked, in words, with its numbers: "of 212 such pedestrians the one of median minADE (0.14 m)".
    pub rule: String,
}

impl Pick {
    /// A case of these pedestrians, picked by this rule.
    pub fn new(show: Show, pedestrians: Vec<usize>, rule: impl Into<String>) -> Self {
        Self {
            show,
            pedestrians,
            rule: rule.into(),
        }
    }
}
