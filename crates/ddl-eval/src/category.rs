//! Categories of pedestrians: [`MotionKind`], and `TrajNet++`'s [`TrajectoryType`] with [`Interaction`]s.
//!
//! All categories read the future. They group results after the forecasts are made; forecasts must not depend on them.

mod interaction;
mod kalman;
mod motion_kind;
mod trajectory_type;

use std::fmt;

use ddl_core::Window;
use serde::{Deserialize, Serialize};

pub use interaction::Interaction;
pub use motion_kind::MotionKind;
pub use trajectory_type::TrajectoryType;

/// A category of pedestrians.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Category {
    /// The kind of its own motion.
    Motion(MotionKind),
    /// Its type in `TrajNet++`'s taxonomy.
    Type(TrajectoryType),
    /// A sub-kind of type III.
    Interaction(Interaction),
}

impl Category {
    /// All categories, in display order.
    pub fn all() -> impl Iterator<Item = Self> {
        let motions = MotionKind::ALL.into_iter().map(Self::Motion);
        let types = TrajectoryType::ALL.into_iter().map(Self::Type);
        let interactions = Interaction::ALL.into_iter().map(Self::Interaction);
        motions.chain(types).chain(interactions)
    }

    /// The categories of pedestrian `i`, in that order; empty for windows without a future.
    pub fn of(window: &Window, i: usize) -> Vec<Self> {
        let Some((kind, interactions)) = TrajectoryType::with_interactions(window, i) else {
            return Vec::new();
        };
        let motion = MotionKind::of(window.track(i)).map(Self::Motion);
        let interactions = interactions.into_iter().map(Self::Interaction);
        motion
            .into_iter()
            .chain([Self::Type(kind)])
            .chain(interactions)
            .collect()
    }
}

impl fmt::Display for Category {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Motion(kind) => kind.fmt(f),
            Self::Type(kind) => kind.fmt(f),
            Self::Interaction(kind) => kind.fmt(f),
        }
    }
}
