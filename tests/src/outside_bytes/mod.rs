//! A test function for every reader of untrusted input. Rules: no panic for any bytes; data that was read is written
//! and read back unchanged; a stream in pieces gives the same result as at once; an error changes nothing. The fuzz
//! targets of `tests/fuzz` call these functions, and so do plain tests with the committed corpora.

pub mod corpus;
mod edits;
pub mod external;
pub mod goal_library;
pub mod homography;
pub mod live_tracks;
pub mod model_files;
pub mod own_tracks;
pub mod report;
pub mod scene_memory;
pub mod stream;
pub mod tracks;

/// The test function of a reader, with the name of its fuzz target and corpus.
pub type Reader = (&'static str, fn(&[u8]));

/// The readers that need no libtorch.
pub const READERS: [Reader; 21] = [
    ("table", tracks::table),
    ("star_csv", tracks::star_csv),
    ("social_gan", tracks::social_gan),
    ("trajnet", tracks::trajnet),
    ("obsmat", tracks::obsmat),
    ("own_tracks", own_tracks::read),
    ("stream", stream::read),
    ("live_tracks", live_tracks::read),
    ("homography", homography::read),
    ("foreign_json_lines", external::read_json_lines),
    ("foreign_table", external::read_table),
    ("foreign_trajnet", external::read_trajnet),
    ("report", report::read),
    ("moments", report::read_moments),
    ("goal_library", goal_library::read),
    ("scene_memory", scene_memory::read),
    ("packed_model", model_files::packed_model::read),
    ("run_config", model_files::json::read_run_config),
    ("metrics", model_files::json::read_metrics),
    ("weights", model_files::weights::read),
    ("experts", model_files::experts::read),
];

/// The readers that need libtorch.
#[cfg(feature = "torch")]
pub const TORCH_READERS: [Reader; 1] = [("training_state", model_files::training_state::read)];
