//! The ensemble on plain numbers: small perceptrons with attention over the neighbours.

use super::ends::{END_UNIT, PedestrianView, ProposeEnds, ProposedEnds};
use super::layers::{MemberAffine, ProposalLayers};
use super::seen::SeenRows;
use crate::kernel::{Buffer, LinearKernel, gelu};
use crate::seed::{Stage, stream};
use crate::weights::{Layout, Weights};
use crate::{NetworkError, ProposalConfig};
use rayon::prelude::*;
use std::sync::Arc;

/// Pedestrians that are pushed through the network together.
const CHUNK: usize = 64;

/// The ensemble, computed by kernels on the CPU in `f32`.
///
/// # Numerics
/// A pedestrian's proposals have the same bits alone and among others, and with every number of threads.
#[derive(Debug)]
pub struct ProposalNetwork {
    config: ProposalConfig,
    layers: ProposalLayers,
    weights: Weights,
    members: Vec<MemberKernels>,
}

#[derive(Debug)]
struct MemberKernels {
    own: LinearKernel,
    neighbour: [LinearKernel; 2],
    query: LinearKernel,
    key: LinearKernel,
    value: LinearKernel,
    hidden: Vec<LinearKernel>,
    ends: LinearKernel,
    logits: LinearKernel,
}

impl ProposalNetwork {
    /// A network with initial weights drawn from `seed`.
    ///
    /// # Errors
    /// [`NetworkError::Config`] for a bad configuration.
    pub fn new(config: ProposalConfig, seed: u64) -> Result<Self, NetworkError> {
        let rng = stream(seed, Stage::ProposalWeights, 0);
        Self::reading(config, |layout| Ok(Weights::initial(layout, rng)))
    }

    /// A network with the weights that `read` gives for its layout.
    ///
    /// # Errors
    /// [`NetworkError::Config`] for a bad configuration, [`NetworkError::Shape`] when the weights are of another layout, and those
    /// of `read`.
    pub fn reading(
        config: ProposalConfig,
        read: impl FnOnce(&Arc<Layout>) -> Result<Weights, NetworkError>,
    ) -> Result<Self, NetworkError> {
        config.check()?;
        let mut layout = Layout::default();
        let layers = ProposalLayers::new(&mut layout, &config);
        let layout = Arc::new(layout);
        let weights = read(&layout)?;
        weights.ensure_of(&layout)?;
        Ok(Self {
            members: members(&config, &layers, &weights),
            config,
            layers,
            weights,
        })
    }

    /// The same network with other learned numbers.
    ///
    /// # Errors
    /// [`NetworkError::Shape`] when they are of another layout.
    pub fn with_weights(self, weights: Weights) -> Result<Self, NetworkError> {
        weights.ensure_of(self.weights.layout())?;
        Ok(Self {
            members: members(&self.config, &self.layers, &weights),
            weights,
            ..self
        })
    }

    /// The learned numbers.
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    fn propose_chunk(&self, views: &[PedestrianView]) -> Vec<ProposedEnds> {
        let seen = SeenRows::of(views, &self.config);
        let (k, members) = (self.config.ends as usize, self.config.members as f64);
        let mut proposed: Vec<ProposedEnds> = Vec::new();
        proposed.resize_with(views.len(), || ProposedEnds {
            ends: Vec::new(),
            weights: Vec::new(),
        });
        for member in &self.members {
            let hidden = member.hidden_layer(&seen, self.config.heads as usize);
            let (ends, logits) = (member.ends.forward(&hidden), member.logits.forward(&hidden));
            let rows = ends.chunks_exact(2 * k).zip(logits.chunks_exact(k));
            for ((proposed, onward), (ends, logits)) in
                proposed.iter_mut().zip(&seen.onward).zip(rows)
            {
                let (offsets, _) = ends.as_chunks::<2>();
                proposed.ends.extend(offsets.iter().map(|&[x, y]| {
                    [
                        f64::from(x) * END_UNIT + onward[0],
                        f64::from(y) * END_UNIT + onward[1],
                    ]
                }));
                let largest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
                let powers = logits.iter().map(|&logit| f64::from(logit - largest).exp());
                let sum: f64 = powers.clone().sum();
                proposed
                    .weights
                    .extend(powers.map(|power| power / sum / members));
            }
        }
        proposed
    }
}

impl ProposeEnds for ProposalNetwork {
    fn config(&self) -> &ProposalConfig {
        &self.config
    }

    fn copy_weights(&self) -> Result<Weights, NetworkError> {
        Ok(self.weights.clone())
    }

    fn propose(&self, views: &[PedestrianView]) -> Result<Vec<ProposedEnds>, NetworkError> {
        let chunks = views.par_chunks(CHUNK);
        Ok(chunks
            .flat_map_iter(|views| self.propose_chunk(views))
            .collect())
    }
}

fn members(
    config: &ProposalConfig,
    layers: &ProposalLayers,
    weights: &Weights,
) -> Vec<MemberKernels> {
    let of = |layer: MemberAffine, member: usize| {
        let [inputs, outputs] = layer.sizes();
        let [weight, bias] = layer.of_member(member).map(|span| &weights.numbers()[span]);
        // The kernel takes W by outputs.
        let by_outputs =
            (0..outputs).flat_map(|o| (0..inputs).map(move |i| weight[i * outputs + o]));
        let numbers: Vec<f32> = by_outputs.chain(bias.iter().copied()).collect();
        let mut kernel = LinearKernel::zeros(inputs, outputs);
        kernel.update(&numbers);
        kernel
    };
    (0..config.members as usize)
        .map(|member| MemberKernels {
            own: of(layers.own, member),
            neighbour: layers.neighbour.map(|layer| of(layer, member)),
            query: of(layers.query, member),
            key: of(layers.key, member),
            value: of(layers.value, member),
            hidden: layers
                .hidden
                .iter()
                .map(|&layer| of(layer, member))
                .collect(),
            ends: of(layers.ends, member),
            logits: of(layers.logits, member),
        })
        .collect()
}

impl MemberKernels {
    /// What ends and probabilities are read from, `[B, width]`.
    fn hidden_layer(&self, seen: &SeenRows, heads: usize) -> Buffer {
        let mut code = self.own.forward(&seen.own);
        gelu(&mut code);
        let context = self.look_around(&code, seen, heads);
        let pedestrians = seen.counts.len();
        let [width, near] = [&code, &context].map(|rows| rows.len() / pedestrians);
        let mut hidden = Buffer::any(pedestrians * (width + near + 1));
        let rows = hidden.chunks_exact_mut(width + near + 1).zip(&seen.counts);
        let inputs = code.chunks_exact(width).zip(context.chunks_exact(near));
        for ((row, &count), (code, context)) in rows.zip(inputs) {
            row[..width].copy_from_slice(code);
            row[width..width + near].copy_from_slice(context);
            row[width + near] = count as f32 * 0.1;
        }
        let mut short_cut = code;
        for layer in &self.hidden {
            hidden = layer.forward(&hidden);
            gelu(&mut hidden);
            for (number, short_cut) in hidden.iter_mut().zip(short_cut.iter()) {
                *number += short_cut;
            }
            short_cut = hidden.clone();
        }
        hidden
    }

    /// What the pedestrians make of their neighbours, `[B, neighbour width]`: attention with one more choice of score 0, nobody.
    fn look_around(&self, code: &Buffer, seen: &SeenRows, heads: usize) -> Buffer {
        let query = self.query.forward(code);
        let near = query.len() / seen.counts.len();
        let mut context = Buffer::zeros(query.len());
        if seen.neighbours.is_empty() {
            return context;
        }
        let mut codes = self.neighbour[0].forward(&seen.neighbours);
        gelu(&mut codes);
        codes = self.neighbour[1].forward(&codes);
        gelu(&mut codes);
        let (keys, values) = (self.key.forward(&codes), self.value.forward(&codes));
        let depth = near / heads;
        let scale = 1.0 / (depth as f32).sqrt();
        let mut first = 0;
        let rows = query.chunks_exact(near).zip(context.chunks_exact_mut(near));
        for ((query, context), &count) in rows.zip(&seen.counts) {
            let own = first * near..(first + count) * near;
            first += count;
            let (keys, values) = (&keys[own.clone()], &values[own]);
            for head in 0..heads {
                let part = head * depth..(head + 1) * depth;
                let dot = |key: &[f32]| -> f32 {
                    let pairs = query[part.clone()].iter().zip(&key[part.clone()]);
                    pairs.map(|(q, k)| q * k).sum()
                };
                let scores: Vec<f32> = keys
                    .chunks_exact(near)
                    .map(|key| dot(key) * scale)
                    .collect();
                let largest = scores.iter().copied().fold(0.0, f32::max);
                let powers: Vec<f32> = scores.iter().map(|score| (score - largest).exp()).collect();
                let sum = (-largest).exp() + powers.iter().sum::<f32>();
                for (power, value) in powers.iter().zip(values.chunks_exact(near)) {
                    let weight = power / sum;
                    let parts = context[part.clone()].iter_mut().zip(&value[part.clone()]);
                    for (sum, value) in parts {
                        *sum += weight * value;
                    }
                }
            }
        }
        context
    }
}
