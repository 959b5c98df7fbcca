//! What a benchmark trains: variants, and other networks.

use ddl::Variant;
use ddl::network::BackboneKind;
use serde::{Deserialize, Serialize};

/// The published method, its ablations without one or both components, and the method on another network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub(crate) enum Method {
    /// On the paper's network.
    Of(Variant),
    /// The full method.
    On(BackboneKind),
}

impl Method {
    pub(crate) const FULL: Self = Self::Of(Variant::Full);
    pub(super) const PERCEPTRON: Self = Self::On(BackboneKind::Perceptron);

    pub(super) const ALL: [Self; 5] = [
        Self::FULL,
        Self::Of(Variant::NoGoalShift),
        Self::Of(Variant::NoDynamics),
        Self::Of(Variant::Star),
        Self::PERCEPTRON,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Of(variant) => variant.name(),
            Self::On(backbone) => backbone.name(),
        }
    }

    pub(super) fn option(self) -> &'static str {
        match self {
            Self::Of(_) => "--variant",
            Self::On(_) => "--backbone",
        }
    }
}
