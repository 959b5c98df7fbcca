//! The five simulated scenes.

/// A simulated scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum CrowdScene {
    /// A walled way with two pillars, used in both directions.
    Corridor,
    /// Two ways that cross at right angles.
    Crossing,
    /// An open square with a fountain, crossed in all directions; pedestrians stop and talk.
    Plaza,
    /// A room that narrows to a passage.
    Bottleneck,
    /// Two halls joined by two doors.
    Doorway,
}

impl CrowdScene {
    /// Every scene.
    pub(crate) const ALL: [Self; 5] = [
        Self::Corridor,
        Self::Crossing,
        Self::Plaza,
        Self::Bottleneck,
        Self::Doorway,
    ];

    /// The scene's name, also used for its recording and its fold.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Corridor => "corridor",
            Self::Crossing => "crossing",
            Self::Plaza => "plaza",
            Self::Bottleneck => "bottleneck",
            Self::Doorway => "doorway",
        }
    }
}
