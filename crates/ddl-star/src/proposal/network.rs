//! The network: an ensemble of small perceptrons with attention over the neighbours.

use crate::StarError;
use crate::device::ComputeDevice;
use crate::model::{Parameters, arrays};
use crate::proposal::data::Views;
use ddl_core::motion::RECENT_STEPS;
use ddl_core::{HORIZON, OBSERVED, Position, WINDOW};
use ddl_network::proposal::{
    AttentionLayers, ENDPOINT_UNIT, MemberAffine, ProposalLayers, ReadoutLayers, SIMILARITY_SCALES, WAYPOINTS,
};
use ddl_network::seed::{Stage, stream};
use ddl_network::weights::{Layout, Weights};
use ddl_network::{NetworkError, PedestrianView, ProposalConfig, ProposeEndpoints, ProposedEndpoints};
use std::sync::{Mutex, PoisonError};
use tch::{Kind, Tensor};

const CHUNK: usize = 2048;

/// The output of the network for a batch. Shapes: `ends` `[M, B, K, 2]`, `waypoints` `[M, B, K, 3, 2]` (metres),
/// `logits` `[M, B, K]`.
#[derive(Debug)]
pub(crate) struct Proposals {
    pub(crate) ends: Tensor,
    pub(crate) waypoints: Tensor,
    pub(crate) logits: Tensor,
}

/// The ensemble.
#[derive(Debug)]
pub struct TorchProposals {
    pub(crate) config: ProposalConfig,
    pub(crate) device: ComputeDevice,
    pub(crate) kind: Kind,
    parameters: Parameters,
    layers: ProposalLayers,
}

impl TorchProposals {
    /// A network with initial weights drawn from `seed`, in single precision.
    ///
    /// # Errors
    /// [`StarError::Network`] for a bad configuration.
    pub fn new(config: ProposalConfig, seed: u64, device: ComputeDevice) -> Result<Self, StarError> {
        config.check()?;
        let kind = Kind::Float;
        let mut layout = Layout::default();
        let layers = ProposalLayers::new(&mut layout, &config);
        let initial = layout.initial(stream(seed, Stage::ProposalWeights, 0));
        let parameters = Parameters::new(layout, &initial, device.0, kind);
        Ok(Self { config, device, kind, parameters, layers })
    }

    /// This network, computed by libtorch, as a `ProposeEndpoints`.
    #[must_use]
    pub fn into_proposer(self) -> Box<dyn ProposeEndpoints> {
        Box::new(TorchProposer { config: self.config.clone(), network: Mutex::new(self) })
    }

    /// y = x W + b of every member.
    /// Shapes: `x` `[M, B, inputs]` -> `[M, B, outputs]`.
    fn affine(&self, layer: MemberAffine, x: &Tensor) -> Tensor {
        let tensors = &self.parameters.tensors[layer.tensor..];
        tensors[1].baddbmm(x, &tensors[0], 1.0, 1.0)
    }

    /// The learned tensors, each with the ensemble's members along its first dimension.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Proposes endpoints for each of the pedestrians.
    ///
    /// # Shapes
    /// One [`ProposedEndpoints`] for each view, in their order: positions in metres ahead and to the left.
    ///
    /// # Errors
    /// [`StarError::Torch`] when libtorch fails, for example for lack of memory.
    fn propose(&self, views: &[PedestrianView]) -> Result<Vec<ProposedEndpoints>, StarError> {
        let _guard = tch::no_grad_guard();
        let mut proposed = Vec::with_capacity(views.len());
        for chunk in views.chunks(CHUNK) {
            let views =
                Views::new(chunk.iter(), &self.config, self.device.0, self.kind)?.for_each_of(self.config.members);
            let alone = self.forward(&views);
            // [M, B, K, ..] -> B times [M K, ..]
            let per_pedestrian = (self.config.members * self.config.ends) as usize;
            let members = self.config.members as f64;
            let listed = |proposals: &Proposals| -> Result<Vec<ProposedEndpoints>, StarError> {
                let weights = proposals.logits.softmax(-1, Kind::Double) / members;
                let ends: Vec<Position> = arrays(&proposals.ends.transpose(0, 1))?;
                let weights = arrays::<1>(&weights.transpose(0, 1))?.into_flattened();
                let pairs = ends.chunks_exact(per_pedestrian).zip(weights.chunks_exact(per_pedestrian));
                let pairs = pairs.map(|(endpoints, weights)| (endpoints.to_vec(), weights.to_vec()));
                Ok(pairs.map(|(endpoints, weights)| ProposedEndpoints { endpoints, weights }).collect())
            };
            let mut of_chunk = listed(&alone)?;
            let remembers = chunk.iter().any(|view| !view.remembered.is_empty());
            let branch = self.config.memory.as_ref().filter(|_| remembers);
            if let Some((memory, proposals)) = branch.zip(self.forward_remembering(&views)) {
                for ((view, proposed), other) in chunk.iter().zip(&mut of_chunk).zip(listed(&proposals)?) {
                    if !view.remembered.is_empty() {
                        let share = memory.share(&view.remembered);
                        for weight in &mut proposed.weights {
                            *weight *= 1.0 - share;
                        }
                        proposed.endpoints.extend(other.endpoints);
                        proposed.weights.extend(other.weights.iter().map(|weight| weight * share));
                    }
                }
            }
            proposed.extend(of_chunk);
        }
        Ok(proposed)
    }

    /// The proposals from the observation only. Shapes: `views` `[M, B, ..]` -> `[M, B, K, ..]`.
    pub(crate) fn forward(&self, views: &Views) -> Proposals {
        self.placed(self.read(&self.layers.readout, &self.hidden_layer(views)), views)
    }

    /// The proposals of the memory branch; `None` without one. No gradient reaches the rest of the network. Shapes:
    /// `views` `[M, B, ..]` -> `[M, B, K, ..]`.
    pub(crate) fn forward_remembering(&self, views: &Views) -> Option<Proposals> {
        let (attention, readout) = self.layers.memory.as_ref()?;
        let memory = self.config.memory.as_ref()?;
        let (alone, code) = tch::no_grad(|| {
            let hidden = self.hidden_layer(views);
            (self.read(&self.layers.readout, &hidden), hidden)
        });
        let remembered = &views.remembered;
        let features = self.remembered_features(views);
        let context = self.attend(attention, &code, &features, &remembered.present, memory.heads);
        let alike = (&remembered.distances * (-1.0 / SIMILARITY_SCALES[0])).exp() * &remembered.present;
        let support = sum(&alike).log1p();
        let hidden = self.through(&readout.hidden, code, context, support);
        let more = self.read(readout, &hidden);
        let readings = Proposals {
            ends: alone.ends + more.ends,
            waypoints: alone.waypoints + more.waypoints,
            logits: alone.logits + more.logits,
        };
        Some(self.placed(readings, views))
    }

    /// The last hidden layer of the network without a memory branch. Shapes: -> `[M, B, width]`.
    fn hidden_layer(&self, views: &Views) -> Tensor {
        let size = views.own.size();
        let (m, b) = (size[0], size[1]);
        let own_velocity = self.velocities(&views.own);
        let features = Tensor::cat(&[views.own.reshape([m, b, -1]) * 0.5, own_velocity.reshape([m, b, -1])], -1);
        let code = self.affine(self.layers.own, &features).gelu("none");
        let (features, distance) = self.neighbour_features(views);
        let seen = &views.present * distance.lt(self.config.neighbour_range);
        let neighbours = &self.layers.neighbours;
        let context = self.attend(neighbours, &code, &features, &seen, self.config.heads);
        self.through(&self.layers.readout.hidden, code, context, sum(&seen) * 0.1)
    }

    /// Hidden layers, with residual connections between layers of equal width. Shapes: `code` `[M, B, width]`,
    /// `context` `[M, B, ..]`, `amount` `[M, B, 1]` -> `[M, B, width]`.
    fn through(&self, layers: &[MemberAffine], code: Tensor, context: Tensor, amount: Tensor) -> Tensor {
        let mut hidden = Tensor::cat(&[code.shallow_clone(), context, amount], -1);
        let mut short_cut = code;
        for &layer in layers {
            hidden = self.affine(layer, &hidden).gelu("none");
            if hidden.size() == short_cut.size() {
                hidden += &short_cut;
            }
            short_cut = hidden.shallow_clone();
        }
        hidden
    }

    /// The output of a readout before it is placed: endpoints relative to the straight path, waypoints relative to the
    /// paths to the endpoints.
    fn read(&self, layers: &ReadoutLayers, hidden: &Tensor) -> Proposals {
        let size = hidden.size();
        let (m, b, ends, points) = (size[0], size[1], self.config.ends, WAYPOINTS.len() as i64);
        let offsets = self.affine(layers.ends, hidden).reshape([m, b, ends, 2]) * ENDPOINT_UNIT;
        let waypoints = self.affine(layers.waypoints, hidden);
        Proposals {
            ends: offsets,
            waypoints: waypoints.reshape([m, b, ends, points, 2]),
            logits: self.affine(layers.logits, hidden),
        }
    }

    fn placed(&self, readings: Proposals, views: &Views) -> Proposals {
        let onward = self.velocity(&views.own, OBSERVED - 1) * (HORIZON as f64 * self.config.time_step);
        let ends = readings.ends + onward.unsqueeze(2);
        let shares = Tensor::from_slice(&WAYPOINTS)
            .to_kind(self.kind)
            .to_device(self.device.0)
            .reshape([WAYPOINTS.len() as i64, 1]);
        let on_the_way = ends.unsqueeze(3) * shares;
        Proposals { waypoints: readings.waypoints + on_the_way, ends, logits: readings.logits }
    }

    /// Attention of a pedestrian over others, with an additional empty entry of score 0. Shapes: `code` `[M, B,
    /// width]`, `features` `[M, B, J, ..]`, `present` `[M, B, J]` (1 or 0) -> `[M, B, code width]`.
    fn attend(
        &self,
        layers: &AttentionLayers,
        code: &Tensor,
        features: &Tensor,
        present: &Tensor,
        heads: i64,
    ) -> Tensor {
        let size = features.size();
        let (m, b, slots) = (size[0], size[1], size[2]);
        let flat = features.reshape([m, b * slots, size[3]]);
        let codes = self.affine(layers.code[0], &flat).gelu("none");
        let codes = self.affine(layers.code[1], &codes).gelu("none");
        let near = codes.size()[2];
        let per_head = |x: Tensor, others: i64| x.reshape([m, b, others, heads, near / heads]);
        let query = per_head(self.affine(layers.query, code), 1);
        let key = per_head(self.affine(layers.key, &codes), slots);
        let value = per_head(self.affine(layers.value, &codes), slots);
        let scores =
            (query * key).sum_dim_intlist([-1i64].as_slice(), false, None::<Kind>) / ((near / heads) as f64).sqrt();
        let hidden = present.eq(0.0).unsqueeze(-1);
        let scores = scores.masked_fill(&hidden, f64::NEG_INFINITY);
        // The additional entry of score 0.
        let empty = Tensor::zeros([m, b, 1, heads], (self.kind, self.device.0));
        let attention = Tensor::cat(&[scores, empty], 2).softmax(2, None::<Kind>).narrow(2, 0, slots);
        (attention.unsqueeze(-1) * value).sum_dim_intlist([2i64].as_slice(), false, None::<Kind>).reshape([m, b, near])
    }

    /// Shapes: -> `[M, B, G, 17]`.
    fn remembered_features(&self, views: &Views) -> Tensor {
        let tracks = &views.remembered.tracks;
        let observed = views.own.unsqueeze(2);
        let position = |track: &Tensor, step: usize| track.select(-2, step as i64);
        let here = position(&observed, OBSERVED - 1);
        let [now, halfway, end] =
            [OBSERVED - 1, OBSERVED + HORIZON / 2 - 1, WINDOW - 1].map(|step| position(tracks, step));
        let seconds = HORIZON as f64 * self.config.time_step;
        let late = self.velocity(&observed, OBSERVED - 1);
        let its_late = self.velocity(tracks, OBSERVED - 1);
        let its_early = self.velocity(tracks, RECENT_STEPS);
        let pairs = [
            &now - &here,
            &its_late - &late,
            its_early - self.velocity(&observed, RECENT_STEPS),
            (&end - &now - &late * seconds) / ENDPOINT_UNIT,
            (&end - &here - &late * seconds) / ENDPOINT_UNIT,
            (&halfway - &now - &late * (seconds / 2.0)) / ENDPOINT_UNIT,
            its_late,
        ];
        let axis = |axis: i64| pairs.iter().map(move |pair| pair.select(-1, axis));
        let likenesses = SIMILARITY_SCALES.iter().map(|scale: &f64| (&views.remembered.distances / -*scale).exp());
        let features: Vec<Tensor> = axis(0).chain(axis(1)).chain(likenesses).collect();
        Tensor::stack(&features, -1)
    }

    /// Shapes: -> `[M, B, J, 9]` and distances `[M, B, J]` (metres) at the last observed step.
    fn neighbour_features(&self, views: &Views) -> (Tensor, Tensor) {
        let last = views.neighbours.select(-2, OBSERVED as i64 - 1);
        let here = views.own.select(-2, OBSERVED as i64 - 1).unsqueeze(2);
        let offset = last - here;
        let distance = (sum(&offset.square()) + 1e-6).sqrt();
        let velocity = self.velocity(&views.neighbours, OBSERVED - 1);
        let relative = &velocity - self.velocity(&views.own, OBSERVED - 1).unsqueeze(2);
        let closing = sum(&(&offset * &relative)) / &distance;
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

    /// Mean velocity over the [`RECENT_STEPS`] steps that end at a step (m/s): `[.., T, 2]` -> `[.., 2]`.
    fn velocity(&self, track: &Tensor, until: usize) -> Tensor {
        let seconds = RECENT_STEPS as f64 * self.config.time_step;
        let position = |step: usize| track.select(-2, step as i64);
        (position(until) - position(until - RECENT_STEPS)) / seconds
    }
}

/// Sum over the last dimension, which is kept.
fn sum(x: &Tensor) -> Tensor {
    x.sum_dim_intlist([-1i64].as_slice(), true, None::<Kind>)
}

/// Proposals by libtorch. Tensors can move between threads but not be shared, so one call runs at a time.
#[derive(Debug)]
struct TorchProposer {
    config: ProposalConfig,
    network: Mutex<TorchProposals>,
}

impl ProposeEndpoints for TorchProposer {
    fn config(&self) -> &ProposalConfig {
        &self.config
    }

    fn copy_weights(&self) -> Result<Weights, NetworkError> {
        Ok(self.network.lock().unwrap_or_else(PoisonError::into_inner).parameters.to_weights()?)
    }

    fn propose(&self, views: &[PedestrianView]) -> Result<Vec<ProposedEndpoints>, NetworkError> {
        Ok(self.network.lock().unwrap_or_else(PoisonError::into_inner).propose(views)?)
    }
}
