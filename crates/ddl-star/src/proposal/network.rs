//! The network: an ensemble of small perceptrons with attention over the neighbours.

use super::affine::Affine;
use super::config::ProposalConfig;
use super::data::{Views, WalkerView};
use crate::StarError;
use crate::device::ComputeDevice;
use crate::parameters::{Initializer, Parameters};
use crate::seed::{Stage, stream};
use ddl_data::{HORIZON, OBSERVED, Position};
use tch::{Kind, Tensor};

/// Steps over which the present velocity is taken.
const RECENT: i64 = 3;
/// Positions between now and the end that are learned beside the end, as shares of the horizon.
pub(crate) const WAYPOINTS: [f64; 3] = [0.25, 0.5, 0.75];
/// Inputs of a neighbour: direction, nearness twice, relative and own velocity, closing speed.
const NEIGHBOUR_FEATURES: i64 = 9;
/// Walkers that are pushed through the network together.
const CHUNK: usize = 2048;
/// Ends lie within a few metres of where the present velocity leads: the unit of the last layer (m).
const END_UNIT: f64 = 3.0;

/// Ends proposed for one walker, those of all members one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedEnds {
    /// Ends in the walker's frame (metres), members x K of them.
    pub ends: Vec<Position>,
    /// Probability of each to be the nearest to the true end; sums to 1.
    pub weights: Vec<f64>,
}

/// What the network says of a batch.
///
/// # Shapes
/// `ends` `[M, B, K, 2]`, `waypoints` `[M, B, K, 3, 2]` (metres), `logits` `[M, B, K]`.
#[derive(Debug)]
pub(crate) struct Proposals {
    pub(crate) ends: Tensor,
    pub(crate) waypoints: Tensor,
    pub(crate) logits: Tensor,
}

/// The ensemble.
///
/// A walker's positions and velocities pass one layer; its code then asks the codes of its
/// neighbours (attention, with the choice to look at none), and further layers with short cuts give
/// K ends relative to where the present velocity leads, and a probability for each.
#[derive(Debug)]
pub struct ProposalNetwork {
    config: ProposalConfig,
    device: ComputeDevice,
    kind: Kind,
    parameters: Parameters,
    own: Affine,
    neighbour: [Affine; 2],
    query: Affine,
    key: Affine,
    value: Affine,
    hidden: Vec<Affine>,
    ends: Affine,
    waypoints: Affine,
    logits: Affine,
}

impl ProposalNetwork {
    /// A network with initial weights drawn from `seed`, in single precision.
    ///
    /// # Errors
    /// [`StarError::Config`] for a bad configuration.
    pub fn new(
        config: ProposalConfig,
        seed: u64,
        device: ComputeDevice,
    ) -> Result<Self, StarError> {
        config.check()?;
        let kind = Kind::Float;
        let mut init = Initializer::new(
            stream(seed, Stage::ProposalWeights, 0),
            device.torch(),
            kind,
        );
        let (m, width, near) = (config.members, config.width, config.neighbour_width);
        let ends = config.ends;
        let own_features = (OBSERVED * 2 + (OBSERVED - 1) * 2) as i64;
        let own = Affine::new(&mut init, "own", (m, own_features, width), 1.0);
        let neighbour = [
            Affine::new(&mut init, "neighbour.0", (m, NEIGHBOUR_FEATURES, near), 1.0),
            Affine::new(&mut init, "neighbour.1", (m, near, near), 1.0),
        ];
        let query = Affine::new(&mut init, "query", (m, width, near), 0.5);
        let key = Affine::new(&mut init, "key", (m, near, near), 0.5);
        let value = Affine::new(&mut init, "value", (m, near, near), 1.0);
        let hidden = (0..config.layers)
            .map(|layer| {
                let inputs = if layer == 0 { width + near + 1 } else { width };
                Affine::new(
                    &mut init,
                    &format!("hidden.{layer}"),
                    (m, inputs, width),
                    1.0,
                )
            })
            .collect();
        let end_layer = Affine::new(&mut init, "ends", (m, width, ends * 2), 0.3);
        let waypoint_outputs = ends * WAYPOINTS.len() as i64 * 2;
        let waypoints = Affine::new(&mut init, "waypoints", (m, width, waypoint_outputs), 0.3);
        let logits = Affine::new(&mut init, "logits", (m, width, ends), 0.1);
        Ok(Self {
            config,
            device,
            kind,
            parameters: init.finish(),
            own,
            neighbour,
            query,
            key,
            value,
            hidden,
            ends: end_layer,
            waypoints,
            logits,
        })
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
    /// A walker's proposals do not depend on the other views of the call, beyond rounding.
    ///
    /// # Shapes
    /// One [`ProposedEnds`] a view, in their order: `members * ends` places, in metres ahead and to the left.
    ///
    /// # Errors
    /// [`StarError::Torch`] when libtorch fails, for want of memory for instance.
    pub fn propose(&self, views: &[WalkerView]) -> Result<Vec<ProposedEnds>, StarError> {
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

    /// # Shapes
    /// `views` `[M, B, ..]` -> `[M, B, K, ..]`.
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
        let code = self.own.forward(&features).gelu("none");
        let (context, seen) = self.look_around(&code, views);
        let mut hidden = Tensor::cat(&[code.shallow_clone(), context, seen * 0.1], -1);
        let mut short_cut = code;
        for layer in &self.hidden {
            hidden = layer.forward(&hidden).gelu("none") + &short_cut;
            short_cut = hidden.shallow_clone();
        }
        let (ends, points) = (self.config.ends, WAYPOINTS.len() as i64);
        let onward = self.recent_velocity(&views.own) * (HORIZON as f64 * self.config.time_step);
        let offsets = self.ends.forward(&hidden).reshape([m, b, ends, 2]) * END_UNIT;
        let ends_at = offsets + onward.unsqueeze(2);
        let shares = Tensor::from_slice(&WAYPOINTS)
            .to_kind(self.kind)
            .to_device(self.device.torch())
            .reshape([points, 1]);
        let on_the_way = ends_at.unsqueeze(3) * shares;
        let waypoints = self.waypoints.forward(&hidden);
        Proposals {
            waypoints: waypoints.reshape([m, b, ends, points, 2]) + on_the_way,
            ends: ends_at,
            logits: self.logits.forward(&hidden),
        }
    }

    /// What the walker makes of its neighbours, and how many there are.
    ///
    /// # Shapes
    /// `code` `[M, B, width]` -> `[M, B, neighbour_width]`, `[M, B, 1]`.
    fn look_around(&self, code: &Tensor, views: &Views) -> (Tensor, Tensor) {
        let size = views.present.size();
        let (m, b, slots) = (size[0], size[1], size[2]);
        let (heads, near) = (self.config.heads, self.config.neighbour_width);
        let (features, distance) = self.neighbour_features(views);
        let seen = &views.present * distance.lt(self.config.neighbour_range);
        let flat = features.reshape([m, b * slots, NEIGHBOUR_FEATURES]);
        let codes = self.neighbour[0].forward(&flat).gelu("none");
        let codes = self.neighbour[1].forward(&codes).gelu("none");
        let per_head = |x: Tensor| x.reshape([m, b, -1, heads, near / heads]);
        let query = per_head(self.query.forward(code));
        let key = per_head(self.key.forward(&codes));
        let value = per_head(self.value.forward(&codes));
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

    /// # Shapes
    /// -> `[M, B, J, 9]` and distances `[M, B, J]` (metres) at the last observed step.
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
        (track.select(-2, last) - track.select(-2, last - RECENT)) / seconds
    }
}

fn numbers(tensor: &Tensor) -> Result<Vec<f64>, StarError> {
    let flat = tensor.to_device(tch::Device::Cpu).to_kind(Kind::Double);
    Ok(Vec::try_from(flat.contiguous().reshape([-1]))?)
}
