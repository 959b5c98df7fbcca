//! Recordings: pinned files, their folders and sources.

mod choice;
mod fetch;
mod manifest;
mod source;

pub(crate) use choice::{Chosen, choose, fetch_to, find_right};
pub(crate) use fetch::check;
pub(crate) use manifest::Manifest;

use ddl_data::Convention;

/// Folder of fetched recordings, relative to the workspace root.
pub(crate) const FETCHED: &str = "datasets/eth_ucy";

/// The conventions with files, in order of preference.
pub(crate) const RECORDED: [Convention; 2] = [Convention::Star, Convention::SocialGan];
