//! The network: an ensemble of small perceptrons with attention over the neighbours.

use super::data::Views;
use crate::StarError;
use crate::device::ComputeDevice;
use crate::model::{Parameters, numbers};
use ddl_data::{HORIZON, OBSERVED};
use ddl_network::proposal::{
    END_UNIT, MemberAffine, NEIGHBOUR_FEATURES, ProposalLayers, RECENT, WAYPOINTS,
};
use ddl_network::seed::{Stage, stream};
use ddl_network::weights::{Layout, Weights};
use ddl_network::{NetworkError, PedestrianView, ProposalConfig, ProposeEnds, ProposedEnds};
use std::sync::{Mutex, PoisonError};
use tch::{Kind, Tensor};

const CHUNK: usize = 2048;

/// What the network says of a batch.
/// Shapes: `ends` `[M, B, K, 2]`, `waypoints` `[M, B, K, 3, 2]` (metres), `logits` `[M, B, K]`.
#[derive(Debug)]
pub(crate) struct Proposals {
    pub(crate) ends: Tensor,
    pub(crate) waypoints: Tensor,
    pub(crate) logits: Tensor,
}

/// The ensemble.
#[derive(Debug)]
pub struct TorchProposals {
    config: ProposalConfig,
    device: ComputeDevice,
    kind: Kind,
    parameters: Parameters,
    layers: ProposalLayers,
}

impl TorchProposals {
    /// A network with initial weights drawn from `seed`, in single precision.
    ///
    /// # Errors
    /// [`StarError::Network`] for a bad configuration.
    pub fn new(
        config: ProposalConfig,
        seed: u64,
        device: ComputeDevice,
    ) -> Result<Self, StarError> {
        config.check()?;
        let kind = Kind::Float;
        let mut layout = Layout::default();
        let layers = ProposalLayers::new(&mut layout, &config);
        let initial = layout.initial(stream(seed, Stage::ProposalWeights, 0));
        let parameters = Parameters::new(layout, &initial, device.torch(), kind);
        Ok(Self {
            config,
            device,
            kind,
            parameters,
            layers,
        })
    }

    /// This network behind the trait that proposals are asked of, computed by libtorch.
    #[must_use]
    pub fn into_proposer(self) -> Box<dyn ProposeEnds> {
        Box::new(TorchProposer {
            config: self.config.clone(),
            network: Mutex::new(self),
        })
    }

    /// y = x W + b of every member.
    /// Shapes: `x` `[M, B, inputs]` -> `[M, B, outputs]`.
    fn affine(&self, layer: MemberAffine, x: &Tensor) -> Tensor {
        let tensors = &self.parameters.tensors()[layer.tensor()..];
        tensors[1].baddbmm(x, &tensors[0], 1.0, 1.0)
    }

    /// Its shape.
    pub fn config(&self) -> &ProposalConfig {
        &self.config
    }

    /// The learned tensors, each with the members along its first dimension.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    pub(crate) fn device(&self) -> ComputeDevice {
        self.device
    }

    pub(crate) fn kind(&self) -> Kind {
        self.kind
    }

    /// Proposes ends for each of the walkers.
    ///
    /// # Shapes
    /// One [`ProposedEnds`] a view, in their order: `members * ends` places, in metres ahead and to the left.
    ///
    /// # Errors
    /// [`StarError::Torch`] when libtorch fails, for want of memory for instance.
    pub fn propose(&self, views: &[PedestrianView]) -> Result<Vec<ProposedEnds>, StarError> {
        let _guard = tch::no_grad_guard();
        let mut proposed = Vec::with_capacity(views.len());
        for chunk in views.chunks(CHUNK) {
            let views = Views::new(chunk.iter(), &self.config, self.device.torch(), self.kind)?
                .for_each_of(self.config.members);
            let proposals = self.forward(&views);
            let members = self.config.members as f64;
            let weights = proposals.logits.softmax(-1, Kind::Double) / members;
            // [M, B, K, ..] -> [B, M K, ..]
            let ends = numbers(&proposals.ends.transpose(0, 1))?;
            let weights = numbers(&weights.transpose(0, 1))?;
            let each = (self.config.members * self.config.ends) as usize;
            proposed.extend(
                ends.chunks_exact(2 * each)
                    .zip(weights.chunks_exact(each))
                    .map(|(ends, weights)| ProposedEnds {
                        ends: ends.chunks_exact(2).map(|end| [end[0], end[1]]).collect(),
                        weights: weights.to_vec(),
                    }),
            );
        }
        Ok(proposed)
    }

    /// Shapes: `views` `[M, B, ..]` -> `[M, B, K, ..]`.
    pub(crate) fn forward(&self, views: &Views) -> Proposals {
        let size = views.own.size();
        let (m, b) = (size[0], size[1]);
        let own_velocity = self.velocities(&views.own);
        let features = Tensor::cat(
            &[
                views.own.reshape([m, b, -1]) * 0.5,
                own_velocity.reshape([m, b, -1]),
            ],
            -1,
        );
        let code = self.affine(self.layers.own, &features).gelu("none");
        let (context, seen) = self.look_around(&code, views);
        let mut hidden = Tensor::cat(&[code.shallow_clone(), context, seen * 0.1], -1);
        let mut short_cut = code;
        for &layer in &self.layers.hidden {
            hidden = self.affine(layer, &hidden).gelu("none") + &short_cut;
            short_cut = hidden.shallow_clone();
        }
        let (ends, points) = (self.config.ends, WAYPOINTS.len() as i64);
        let onward = self.recent_velocity(&views.own) * (HORIZON as f64 * self.config.time_step);
        let offsets = self
            .affine(self.layers.ends, &hidden)
            .reshape([m, b, ends, 2])
            * END_UNIT;
        let ends_at = offsets + onward.unsqueeze(2);
        let shares = Tensor::from_slice(&WAYPOINTS)
            .to_kind(self.kind)
            .to_device(self.device.torch())
            .reshape([points, 1]);
        let on_the_way = ends_at.unsqueeze(3) * shares;
        let waypoints = self.affine(self.layers.waypoints, &hidden);
        Proposals {
            waypoints: waypoints.reshape([m, b, ends, points, 2]) + on_the_way,
            ends: ends_at,
            logits: self.affine(self.layers.logits, &hidden),
        }
    }

    /// What the walker makes of its neighbours, and how many there are.
    /// Shapes: `code` `[M, B, width]` -> `[M, B, neighbour_width]`, `[M, B, 1]`.
    fn look_around(&self, code: &Tensor, views: &Views) -> (Tensor, Tensor) {
        let size = views.present.size();
        let (m, b, slots) = (size[0], size[1], size[2]);
        let (heads, near) = (self.config.heads, self.config.neighbour_width);
        let (features, distance) = self.neighbour_features(views);
        let seen = &views.present * distance.lt(self.config.neighbour_range);
        let flat = features.reshape([m, b * slots, NEIGHBOUR_FEATURES as i64]);
        let codes = self.affine(self.layers.neighbour[0], &flat).gelu("none");
        let codes = self.affine(self.layers.neighbour[1], &codes).gelu("none");
        let per_head = |x: Tensor| x.reshape([m, b, -1, heads, near / heads]);
        let query = per_head(self.affine(self.layers.query, code));
        let key = per_head(self.affine(self.layers.key, &codes));
        let value = per_head(self.affine(self.layers.value, &codes));
        let scores = (query * key).sum_dim_intlist([-1i64].as_slice(), false, None::<Kind>)
            / ((near / heads) as f64).sqrt();
        let hidden = seen.eq(0.0).unsqueeze(-1);
        let scores = scores.masked_fill(&hidden, f64::NEG_INFINITY);
        // One more choice of score 0: nobody.
        let nobody = Tensor::zeros([m, b, 1, heads], (self.kind, self.device.torch()));
        let attention = Tensor::cat(&[scores, nobody], 2)
            .softmax(2, None::<Kind>)
            .narrow(2, 0, slots);
        let context = (attention.unsqueeze(-1) * value)
            .sum_dim_intlist([2i64].as_slice(), false, None::<Kind>)
            .reshape([m, b, near]);
        let count = seen.sum_dim_intlist([-1i64].as_slice(), true, None::<Kind>);
        (context, count)
    }

    /// Shapes: -> `[M, B, J, 9]` and distances `[M, B, J]` (metres) at the last observed step.
    fn neighbour_features(&self, views: &Views) -> (Tensor, Tensor) {
        let last = views.neighbours.select(-2, OBSERVED as i64 - 1);
        let here = views.own.select(-2, OBSERVED as i64 - 1).unsqueeze(2);
        let offset = last - here;
        let sum = |x: Tensor| x.sum_dim_intlist([-1i64].as_slice(), true, None::<Kind>);
        let distance = (sum(offset.square()) + 1e-6).sqrt();
        let velocity = self.recent_velocity(&views.neighbours);
        let relative = &velocity - self.recent_velocity(&views.own).unsqueeze(2);
        let closing = sum(&offset * &relative) / &distance;
        let features = Tensor::cat(
            &[
                &offset / (&distance + 1.0),
                (&distance * -0.5).exp(),
                (&distance + 0.3).reciprocal(),
                relative,
                velocity,
                closing,
            ],
            -1,
        );
        (features, distance.squeeze_dim(-1))
    }

    /// Forward differences (m/s): `[.., T, 2]` -> `[.., T - 1, 2]`.
    fn velocities(&self, track: &Tensor) -> Tensor {
        let steps = OBSERVED as i64 - 1;
        (track.narrow(-2, 1, steps) - track.narrow(-2, 0, steps)) / self.config.time_step
    }

    /// Mean velocity over the last [`RECENT`] steps (m/s): `[.., T, 2]` -> `[.., 2]`.
    fn recent_velocity(&self, track: &Tensor) -> Tensor {
        let last = OBSERVED as i64 - 1;
        let seconds = RECENT as f64 * self.config.time_step;
        (track.select(-2, last) - track.select(-2, last - RECENT as i64)) / seconds
    }
}

/// Proposals by libtorch. Tensors may move between threads, but not be shared: one call at a time.
#[derive(Debug)]
struct TorchProposer {
    config: ProposalConfig,
    network: Mutex<TorchProposals>,
}

impl ProposeEnds for TorchProposer {
    fn config(&self) -> &ProposalConfig {
        &self.config
    }

    fn copy_weights(&self) -> Result<Weights, NetworkError> {
        let network = self.network.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(network.parameters.to_weights()?)
    }

    fn propose(&self, views: &[PedestrianView]) -> Result<Vec<ProposedEnds>, NetworkError> {
        let network = self.network.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(network.propose(views)?)
    }
}
