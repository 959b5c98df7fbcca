//! From what pedestrians see to features, whatever the network is made of.

use crate::backend::{Backend, Memory};
use crate::weights::Linear;
use std::fmt::Debug;

/// A network that turns what pedestrians see, time step by time step, into features for the output layer. Rollout, output
/// layer, noise, dynamics and loss are shared by all. How one is added: the guide's chapter on extending.
pub trait Backbone<B: Backend>: Debug + Send + Sync {
    /// The output layer that it has declared: [`output_layer`](super::output_layer()).
    fn output(&self) -> Linear;

    /// What everybody makes of the scene in whole time steps, before its own way is looked at.
    ///
    /// # Shapes
    /// `centred` `[T, P, 2]`, positions (m) relative to the scene's mean so far; `seen` during one time step or T -> `[T, P, any
    /// width]`, the input `scene` of [`step`](Self::step).
    fn scene(&self, backend: &B, centred: &B::Tokens, seen: &B::Seen) -> B::Tokens;

    /// One time step: the features of everybody, and what is kept for later steps.
    ///
    /// # Shapes
    /// `relative` `[B, P, StarConfig::temporal_inputs]`: positions relative to the goal (or to the last observed position), in the pedestrian's own
    /// frame with its velocity; `scene` `[1 or B, P, any]`; `seen` during one time step -> `[B, P, StarConfig::output_inputs]`.
    fn step(
        &self,
        backend: &B,
        memory: &mut Memory<B>,
        relative: &B::Tokens,
        scene: &B::Tokens,
        seen: &B::Seen,
    ) -> B::Tokens;
}
