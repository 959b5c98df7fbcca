//! The data conventions, which published tables mix and this crate keeps apart.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::unknown_name::UnknownName;

/// Where recordings come from and how they were sampled: numbers of two conventions are never
/// comparable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// ETH/UCY as SR-LSTM, STAR and DDL use it: eth has a step of 6 raw frames, the others of 10.
    Star,
    /// ETH/UCY as Social-GAN and most other papers use it: eth has a step of 10 raw frames, so that
    /// its "0.4 s" are 0.667 s.
    SocialGan,
    /// Simulated crowds ([`simulate`](crate::simulate)), for machines without the recordings.
    Simulated,
    /// Somebody's own recordings ([`Dataset::own`](crate::Dataset::own)).
    Own,
}

impl Convention {
    /// Every convention, in order of preference.
    pub const ALL: [Self; 4] = [Self::Star, Self::SocialGan, Self::Simulated, Self::Own];

    /// The name, which is also that of the folder which holds the files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Star => "star",
            Self::SocialGan => "social-gan",
            Self::Simulated => "simulated",
            Self::Own => "own",
        }
    }
}

impl fmt::Display for Convention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Convention {
    type Err = UnknownName;

    fn from_str(word: &str) -> Result<Self, UnknownName> {
        let expected = "star, social-gan, simulated, own";
        UnknownName::find(word, &Self::ALL, Self::name, "data convention", expected)
    }
}
