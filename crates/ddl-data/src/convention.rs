//! Data conventions. Published tables mix them; this crate keeps them apart.

use serde::{Deserialize, Serialize};

use crate::rule::{SOCIAL_GAN_FEWEST, WindowRule};

/// Source and sampling of the recordings. Numbers of different conventions are not comparable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// ETH/UCY as SR-LSTM, STAR and DDL use it: eth has a step of 6 raw frames, the others of 10.
    Star,
    /// ETH/UCY as Social-GAN and most other papers use it: eth has a step of 10 raw frames, so that its "0.4 s" are
    /// 0.667 s.
    SocialGan,
    /// Simulated crowds ([`Dataset::simulated`](crate::Dataset::simulated)), for machines without the recordings.
    Simulated,
    /// The user's own recordings ([`Dataset::own`](crate::Dataset::own)).
    Own,
}

impl Convention {
    /// The window rule used for the convention's published numbers and for the headline tables.
    pub fn headline_rule(self) -> WindowRule {
        match self {
            Self::Star => WindowRule::Published,
            Self::SocialGan => WindowRule::SocialGan { min_pedestrians: SOCIAL_GAN_FEWEST },
            Self::Simulated => WindowRule::Complete,
            Self::Own => WindowRule::Observed,
        }
    }
}

// In order of preference; the folders of a convention's files have its name.
ddl_core::named!(
    Convention, "data convention",
    Star => "star", SocialGan => "social-gan", Simulated => "simulated", Own => "own"
);
