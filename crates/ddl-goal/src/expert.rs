//! An expert: a pedestrian of the library that a goal set comes from.

/// A pedestrian of the library that moved like the observed one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expert {
    /// Index of its track in the library, from 0.
    pub index: usize,
    /// Distance from the observed pedestrian: normalised soft-DTW (m²/s²) in [`crate::RetrievalFrame::World`], a
    /// squared difference of velocities relative to the pace (no unit) in [`crate::RetrievalFrame::Heading`].
    pub distance: f64,
    /// Whether the expert is the mirror image of the track.
    pub mirrored: bool,
}
