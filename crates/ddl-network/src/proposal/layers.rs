//! The tensors of the proposal network.

use crate::ProposalConfig;
use crate::proposal::remembered::REMEMBERED_FEATURES;
use crate::proposal::seen::NEIGHBOUR_FEATURES;
use crate::weights::Layout;
use ddl_core::OBSERVED;
use std::ops::Range;

/// Waypoints, the positions that are trained in addition to the endpoint, as shares of the horizon.
pub const WAYPOINTS: [f64; 3] = [0.25, 0.5, 0.75];

/// One affine map y = x W + b for each member, with W `[members, inputs, outputs]` and b `[members, 1, outputs]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemberAffine {
    /// Index of its weight among the tensors of the layout; its bias is the next tensor.
    pub tensor: usize,
    first: usize,
    members: usize,
    pub(super) inputs: usize,
    pub(super) outputs: usize,
}

impl MemberAffine {
    /// Declares the map. Initial weights are uniform with the variance `gain`² · 2 / inputs (He et al. 2015), biases 0.
    fn new(layout: &mut Layout, name: &str, members: usize, [inputs, outputs]: [usize; 2], gain: f64) -> Self {
        let first = layout.count();
        let bound = gain * (6.0 / inputs as f64).sqrt();
        let tensor = layout.uniform(format!("{name}.weight"), &[members, inputs, outputs], bound);
        layout.constant(format!("{name}.bias"), &[members, 1, outputs], 0.0);
        Self { tensor, first, members, inputs, outputs }
    }

    /// The ranges of a member's weight `[inputs, outputs]` and bias among all weights.
    pub(super) fn of_member(self, member: usize) -> [Range<usize>; 2] {
        let size = self.inputs * self.outputs;
        let weight = self.first + member * size;
        let bias = self.first + self.members * size + member * self.outputs;
        [weight..weight + size, bias..bias + self.outputs]
    }
}

/// Affine maps of an attention over other pedestrians: neighbours, or earlier pedestrians of the place.
#[derive(Debug, Clone, PartialEq)]
pub struct AttentionLayers {
    /// From the features of another pedestrian to its encoding.
    pub code: [MemberAffine; 2],
    /// To the query of the pedestrian.
    pub query: MemberAffine,
    /// From the encoding to the key.
    pub key: MemberAffine,
    /// From the encoding to the value.
    pub value: MemberAffine,
}

/// Affine maps from a pedestrian's encoding and attention to its endpoints.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadoutLayers {
    /// Hidden layers, with residual connections between layers of the same width.
    pub hidden: Vec<MemberAffine>,
    /// To the endpoints.
    pub ends: MemberAffine,
    /// To the waypoints, which only training reads.
    pub waypoints: MemberAffine,
    /// To the logits of the endpoints' probabilities.
    pub logits: MemberAffine,
}

/// All affine maps of the network.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposalLayers {
    /// From a pedestrian's positions and velocities to its encoding.
    pub own: MemberAffine,
    /// Attention over the neighbours.
    pub neighbours: AttentionLayers,
    /// From both to the endpoints.
    pub readout: ReadoutLayers,
    /// The memory branch: attention over earlier pedestrians of the place, and a readout. Its input is the last hidden
    /// layer of [`readout`](Self::readout), and its outputs are added to the endpoints, waypoints and logits of that.
    pub memory: Option<(AttentionLayers, ReadoutLayers)>,
}

/// Declares the layers one after the other.
struct Declaring<'a> {
    layout: &'a mut Layout,
    members: usize,
    ends: usize,
    width: usize,
}

impl Declaring<'_> {
    fn affine(&mut self, name: &str, sizes: [usize; 2], gain: f64) -> MemberAffine {
        MemberAffine::new(self.layout, name, self.members, sizes, gain)
    }

    fn attention(&mut self, names: [&str; 2], features: usize, near: usize) -> AttentionLayers {
        let [code, whole] = names;
        let width = self.width;
        AttentionLayers {
            code: [
                self.affine(&format!("{code}.0"), [features, near], 1.0),
                self.affine(&format!("{code}.1"), [near, near], 1.0),
            ],
            query: self.affine(&format!("{whole}query"), [width, near], 0.5),
            key: self.affine(&format!("{whole}key"), [near, near], 0.5),
            value: self.affine(&format!("{whole}value"), [near, near], 1.0),
        }
    }

    /// `gains`: for endpoints and waypoints, and for logits.
    fn readout(&mut self, name: &str, (layers, width, near): (usize, usize, usize), gains: [f64; 2]) -> ReadoutLayers {
        let ends = self.ends;
        let first = self.width + near + 1;
        let hidden = (0..layers)
            .map(|layer| {
                let inputs = if layer == 0 { first } else { width };
                self.affine(&format!("{name}hidden.{layer}"), [inputs, width], 1.0)
            })
            .collect();
        let points = ends * WAYPOINTS.len() * 2;
        let [of_positions, of_logits] = gains;
        let to_ends = self.affine(&format!("{name}ends"), [width, ends * 2], of_positions);
        let waypoints = self.affine(&format!("{name}waypoints"), [width, points], of_positions);
        for tensor in [waypoints.tensor, waypoints.tensor + 1] {
            self.layout.mark_training_only(tensor);
        }
        ReadoutLayers {
            hidden,
            ends: to_ends,
            waypoints,
            logits: self.affine(&format!("{name}logits"), [width, ends], of_logits),
        }
    }
}

impl ProposalLayers {
    /// Declares the layers.
    pub fn new(layout: &mut Layout, config: &ProposalConfig) -> Self {
        let [members, ends, width, near] =
            [config.members, config.ends, config.width, config.neighbour_width].map(|n| n as usize);
        let mut declaring = Declaring { layout, members, ends, width };
        let own_features = OBSERVED * 2 + (OBSERVED - 1) * 2;
        Self {
            own: declaring.affine("own", [own_features, width], 1.0),
            neighbours: declaring.attention(["neighbour", ""], NEIGHBOUR_FEATURES, near),
            readout: declaring.readout("", (config.layers, width, near), [0.3, 0.1]),
            memory: config.memory.as_ref().map(|memory| {
                let [near, hidden] = [memory.width, memory.hidden].map(|n| n as usize);
                let names = ["memory.code", "memory."];
                // With small gains the initial endpoints are close to those of the main readout.
                (
                    declaring.attention(names, REMEMBERED_FEATURES, near),
                    declaring.readout("memory.", (memory.layers, hidden, near), [0.03, 0.03]),
                )
            }),
        }
    }
}

impl ProposalConfig {
    /// Number of weights of the network.
    pub fn parameter_count(&self) -> usize {
        let mut layout = Layout::default();
        ProposalLayers::new(&mut layout, self);
        layout.count()
    }
}
