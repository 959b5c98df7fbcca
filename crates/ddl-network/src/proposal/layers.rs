//! The learned tensors of the proposal network.

use super::seen::NEIGHBOUR_FEATURES;
use crate::ProposalConfig;
use crate::weights::Layout;
use ddl_data::OBSERVED;
use std::ops::Range;

/// Positions between now and the end that are learned beside the end, as shares of the horizon.
pub const WAYPOINTS: [f64; 3] = [0.25, 0.5, 0.75];

/// An affine map of every member: y = x W + b, with W `[members, inputs, outputs]` and b `[members, 1, outputs]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemberAffine {
    tensor: usize,
    first: usize,
    members: usize,
    inputs: usize,
    outputs: usize,
}

impl MemberAffine {
    /// Declares it: uniform weights with the variance `gain`² · 2 / inputs (He et al. 2015), no bias.
    fn new(
        layout: &mut Layout,
        name: &str,
        members: usize,
        [inputs, outputs]: [usize; 2],
        gain: f64,
    ) -> Self {
        let first = layout.count();
        let bound = gain * (6.0 / inputs as f64).sqrt();
        let tensor = layout.uniform(format!("{name}.weight"), &[members, inputs, outputs], bound);
        layout.constant(format!("{name}.bias"), &[members, 1, outputs], 0.0);
        Self {
            tensor,
            first,
            members,
            inputs,
            outputs,
        }
    }

    /// The number of its weight among the tensors of the layout; its bias is the next one.
    pub fn tensor(self) -> usize {
        self.tensor
    }

    /// Inputs and outputs.
    pub(super) fn sizes(self) -> [usize; 2] {
        [self.inputs, self.outputs]
    }

    /// Where weight `[inputs, outputs]` and bias of a member stand among all learned numbers.
    pub(super) fn of_member(self, member: usize) -> [Range<usize>; 2] {
        let size = self.inputs * self.outputs;
        let weight = self.first + member * size;
        let bias = self.first + self.members * size + member * self.outputs;
        [weight..weight + size, bias..bias + self.outputs]
    }
}

/// All affine maps of the network.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposalLayers {
    /// Of a pedestrian's positions and velocities.
    pub own: MemberAffine,
    /// Of a neighbour's features.
    pub neighbour: [MemberAffine; 2],
    /// What a pedestrian asks its neighbours.
    pub query: MemberAffine,
    /// What a neighbour is compared by.
    pub key: MemberAffine,
    /// What a neighbour contributes.
    pub value: MemberAffine,
    /// Hidden layers with short cuts.
    pub hidden: Vec<MemberAffine>,
    /// To the ends.
    pub ends: MemberAffine,
    /// To the waypoints, which only training looks at.
    pub waypoints: MemberAffine,
    /// To the logarithms of the ends' probabilities.
    pub logits: MemberAffine,
}

impl ProposalLayers {
    /// Declares them.
    pub fn new(layout: &mut Layout, config: &ProposalConfig) -> Self {
        let [members, ends, width, near] = [
            config.members,
            config.ends,
            config.width,
            config.neighbour_width,
        ]
        .map(|n| n as usize);
        let mut affine = |name: &str, inputs: usize, outputs: usize, gain: f64| {
            MemberAffine::new(layout, name, members, [inputs, outputs], gain)
        };
        let own_features = OBSERVED * 2 + (OBSERVED - 1) * 2;
        Self {
            own: affine("own", own_features, width, 1.0),
            neighbour: [
                affine("neighbour.0", NEIGHBOUR_FEATURES, near, 1.0),
                affine("neighbour.1", near, near, 1.0),
            ],
            query: affine("query", width, near, 0.5),
            key: affine("key", near, near, 0.5),
            value: affine("value", near, near, 1.0),
            hidden: (0..config.layers)
                .map(|layer| {
                    let inputs = if layer == 0 { width + near + 1 } else { width };
                    affine(&format!("hidden.{layer}"), inputs, width, 1.0)
                })
                .collect(),
            ends: affine("ends", width, ends * 2, 0.3),
            waypoints: affine("waypoints", width, ends * WAYPOINTS.len() * 2, 0.3),
            logits: affine("logits", width, ends, 0.1),
        }
    }
}

impl ProposalConfig {
    /// Numbers learned in all.
    pub fn parameter_count(&self) -> usize {
        let mut layout = Layout::default();
        ProposalLayers::new(&mut layout, self);
        layout.count()
    }
}
