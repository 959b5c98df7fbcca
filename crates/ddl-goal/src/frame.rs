//! The frame in which walkers are compared.

use serde::{Deserialize, Serialize};

/// In which coordinates walkers are compared and their ends are carried over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RetrievalFrame {
    /// The coordinates of the recording: a walker is like another only if both head the same way. What the published
    /// estimator does, with soft-DTW and k-means.
    World,
    /// The walker's own [`crate::HeadingFrame`], in which every track of the library also serves as its mirror image.
    #[default]
    Heading,
}
