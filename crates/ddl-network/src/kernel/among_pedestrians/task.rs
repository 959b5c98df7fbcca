//! What attention has to do for one scene.

use super::dropout::Decisions;
use crate::kernel::heads::Heads;
use crate::kernel::scenes::Scene;

/// One scene in one batch entry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub(super) scene: Scene<'a>,
    pub(super) entry: usize,
    pub(super) decisions: Option<Decisions>,
    pub(super) heads: Heads,
}

impl Task<'_> {
    /// Groups of heads times pairs of queries.
    pub(super) fn normalisers(&self) -> usize {
        self.heads.groups() * self.scene.pedestrians.div_ceil(2)
    }
}
