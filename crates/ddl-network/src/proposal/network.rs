//! The ensemble on the CPU: small perceptrons with attention over the neighbours.

use crate::proposal::endpoints::{ENDPOINT_UNIT, PedestrianView, ProposeEndpoints, ProposedEndpoints};
use crate::proposal::layers::ProposalLayers;
use crate::proposal::member::{MemberKernels, Readings};
use crate::proposal::remembered::RememberedRows;
use crate::proposal::seen::SeenRows;
use crate::seed::{Stage, stream};
use crate::weights::{Layout, Weights};
use crate::{NetworkError, ProposalConfig};
use rayon::prelude::*;
use std::sync::Arc;

/// Number of pedestrians in a batch.
const CHUNK: usize = 64;

/// The ensemble, computed by kernels on the CPU in `f32`.
///
/// # Numerics
/// The proposals of a pedestrian have the same bits alone and together with others, with any number of threads.
#[derive(Debug)]
pub struct ProposalNetwork {
    config: ProposalConfig,
    weights: Weights,
    members: Vec<MemberKernels>,
}

impl ProposalNetwork {
    /// A network with initial weights drawn from `seed`.
    ///
    /// # Errors
    /// [`NetworkError::Config`] if the configuration is out of range.
    pub fn new(config: ProposalConfig, seed: u64) -> Result<Self, NetworkError> {
        let rng = stream(seed, Stage::ProposalWeights, 0);
        Self::reading(config, |layout| Ok(Weights::initial(layout, rng)))
    }

    /// A network with the weights that `read` gives for its layout.
    ///
    /// # Errors
    /// [`NetworkError::Config`] if the configuration is out of range, [`NetworkError::Shape`] if the weights have
    /// another layout, and the errors of `read`.
    pub fn reading(
        config: ProposalConfig,
        read: impl FnOnce(&Arc<Layout>) -> Result<Weights, NetworkError>,
    ) -> Result<Self, NetworkError> {
        config.check()?;
        let mut layout = Layout::default();
        let layers = ProposalLayers::new(&mut layout, &config);
        let layout = Arc::new(layout);
        let weights = read(&layout)?;
        weights.check_layout(&layout)?;
        let members = 0..config.members as usize;
        let members = members.map(|member| MemberKernels::new(&config, &layers, &weights, member));
        Ok(Self { members: members.collect(), config, weights })
    }

    fn propose_chunk(&self, views: &[PedestrianView]) -> Vec<ProposedEndpoints> {
        let seen = SeenRows::of(views, &self.config);
        let memory = self.config.memory.as_ref();
        let remembered = memory
            .map_or_else(RememberedRows::default, |memory| RememberedRows::of(views, memory, self.config.time_step));
        let mut shares = vec![1.0; views.len()];
        for (&index, share) in remembered.of.iter().zip(&remembered.shares) {
            shares[index] -= share;
        }
        let none = ProposedEndpoints { endpoints: Vec::new(), weights: Vec::new() };
        let mut proposed = vec![none; views.len()];
        let mut add = |index: usize, share: f64, (ends, logits): (&[f32], &[f32])| {
            let onward = seen.onward[index];
            let (offsets, _) = ends.as_chunks::<2>();
            let places = offsets
                .iter()
                .map(|&[x, y]| [f64::from(x) * ENDPOINT_UNIT + onward[0], f64::from(y) * ENDPOINT_UNIT + onward[1]]);
            proposed[index].endpoints.extend(places);
            let largest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            let powers = logits.iter().map(|&logit| f64::from(logit - largest).exp());
            let sum: f64 = powers.clone().sum();
            let weights = powers.map(|power| power / sum / self.members.len() as f64 * share);
            proposed[index].weights.extend(weights);
        };
        let mut with_memory = Vec::new();
        for member in &self.members {
            let (alone, memory) = member.read(&seen, &remembered);
            for (index, reading) in self.each(&alone).enumerate() {
                add(index, shares[index], reading);
            }
            with_memory.extend(memory);
        }
        for readings in &with_memory {
            let of_each = remembered.of.iter().zip(&remembered.shares);
            for ((&index, &share), reading) in of_each.zip(self.each(readings)) {
                add(index, share, reading);
            }
        }
        proposed
    }

    fn each<'a>(&self, readings: &'a Readings) -> impl Iterator<Item = (&'a [f32], &'a [f32])> {
        let k = self.config.ends as usize;
        readings.ends.chunks_exact(2 * k).zip(readings.logits.chunks_exact(k))
    }
}

impl ProposeEndpoints for ProposalNetwork {
    fn config(&self) -> &ProposalConfig {
        &self.config
    }

    fn copy_weights(&self) -> Result<Weights, NetworkError> {
        Ok(self.weights.clone())
    }

    fn propose(&self, views: &[PedestrianView]) -> Result<Vec<ProposedEndpoints>, NetworkError> {
        Ok(views.par_chunks(CHUNK).flat_map_iter(|views| self.propose_chunk(views)).collect())
    }
}
