//! Recordings: what is pinned, where it lies, how to get it.

mod choice;
mod fetch;
mod locate;
mod manifest;
mod source;

use std::fmt;
use std::str::FromStr;

use anyhow::bail;

pub(crate) use choice::{Chosen, at_hand, choose};
pub(crate) use fetch::fetch;
pub(crate) use locate::{Places, check, lookup};
pub(crate) use manifest::Manifest;

/// Where fetched recordings are put, relative to the workspace root.
pub(crate) const FETCHED: &str = "datasets/eth_ucy";

/// How the recordings were sampled and written; numbers of two conventions do not compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Convention {
    Star,
    SocialGan,
    Simulated,
}

impl Convention {
    /// In order of preference.
    pub(crate) const ALL: [Self; 3] = [Self::Star, Self::SocialGan, Self::Simulated];
    /// Those that are made of files.
    pub(crate) const RECORDED: [Self; 2] = [Self::Star, Self::SocialGan];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Star => "star",
            Self::SocialGan => "social-gan",
            Self::Simulated => "simulated",
        }
    }
}

impl fmt::Display for Convention {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FromStr for Convention {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match Self::ALL
            .into_iter()
            .find(|convention| convention.name() == text)
        {
            Some(convention) => Ok(convention),
            None => bail!("a convention is star, social-gan or simulated"),
        }
    }
}
