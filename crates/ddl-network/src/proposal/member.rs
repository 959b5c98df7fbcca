//! One member of the ensemble on the CPU.

use crate::ProposalConfig;
use crate::kernel::{Buffer, LinearKernel, gelu};
use crate::proposal::layers::{AttentionLayers, MemberAffine, ProposalLayers, ReadoutLayers};
use crate::proposal::remembered::RememberedRows;
use crate::proposal::seen::{OthersRows, SeenRows};
use crate::weights::Weights;

/// The output of a readout for B pedestrians: endpoints `[B, K * 2]` and logits `[B, K]`.
pub(super) struct Readings {
    pub(super) ends: Buffer,
    pub(super) logits: Buffer,
}

#[derive(Debug)]
pub(super) struct MemberKernels {
    own: LinearKernel,
    neighbours: AttentionKernels,
    readout: ReadoutKernels,
    memory: Option<(AttentionKernels, ReadoutKernels)>,
}

#[derive(Debug)]
struct AttentionKernels {
    code: [LinearKernel; 2],
    query: LinearKernel,
    key: LinearKernel,
    value: LinearKernel,
    heads: usize,
}

#[derive(Debug)]
struct ReadoutKernels {
    hidden: Vec<LinearKernel>,
    ends: LinearKernel,
    logits: LinearKernel,
}

impl MemberKernels {
    pub(super) fn new(config: &ProposalConfig, layers: &ProposalLayers, weights: &Weights, member: usize) -> Self {
        let of_member = |layer: MemberAffine| kernel(layer, member, weights);
        let attention = |layers: &AttentionLayers, heads: i64| AttentionKernels {
            code: layers.code.map(of_member),
            query: of_member(layers.query),
            key: of_member(layers.key),
            value: of_member(layers.value),
            heads: heads as usize,
        };
        let readout = |layers: &ReadoutLayers| ReadoutKernels {
            hidden: layers.hidden.iter().map(|&layer| of_member(layer)).collect(),
            ends: of_member(layers.ends),
            logits: of_member(layers.logits),
        };
        let memory = layers.memory.as_ref().zip(config.memory.as_ref());
        Self {
            own: of_member(layers.own),
            neighbours: attention(&layers.neighbours, config.heads),
            readout: readout(&layers.readout),
            memory: memory.map(|((over, from), config)| (attention(over, config.heads), readout(from))),
        }
    }

    /// Endpoints from the observation alone and, for the pedestrians with `remembered` ones, those of the memory
    /// branch.
    pub(super) fn read(&self, seen: &SeenRows, remembered: &RememberedRows) -> (Readings, Option<Readings>) {
        let mut code = self.own.forward(&seen.own);
        gelu(&mut code);
        let context = self.neighbours.attend(&code, &seen.neighbours);
        let counts = seen.neighbours.counts.iter();
        let hidden = (self.readout).hidden_layer(code, &context, counts.map(|&n| n as f32 * 0.1));
        let readings = self.readout.read(&hidden);
        let memory = self.memory.as_ref().filter(|_| !remembered.of.is_empty());
        let with_memory = memory.map(|(attention, readout)| {
            let hidden = rows_of(&hidden, &remembered.of, seen.onward.len());
            let context = attention.attend(&hidden, &remembered.others);
            let support = remembered.support.iter().copied();
            let mut offsets = readout.read(&readout.hidden_layer(hidden, &context, support));
            for (offsets, base) in [(&mut offsets.ends, &readings.ends), (&mut offsets.logits, &readings.logits)] {
                let base = rows_of(base, &remembered.of, seen.onward.len());
                for (offset, base) in offsets.iter_mut().zip(base.iter()) {
                    *offset += base;
                }
            }
            offsets
        });
        (readings, with_memory)
    }
}

impl ReadoutKernels {
    /// The last hidden layer `[B, width]`, from the pedestrians' encodings `[B, width]`, their attention `[B, ..]`, and
    /// the amount of other pedestrians attended to `[B]`.
    fn hidden_layer(&self, code: Buffer, context: &Buffer, amounts: impl ExactSizeIterator<Item = f32>) -> Buffer {
        let pedestrians = amounts.len();
        let [width, near] = [&code, context].map(|rows| rows.len() / pedestrians);
        let mut hidden = Buffer::any(pedestrians * (width + near + 1));
        let rows = hidden.chunks_exact_mut(width + near + 1).zip(amounts);
        let inputs = code.chunks_exact(width).zip(context.chunks_exact(near));
        for ((row, amount), (code, context)) in rows.zip(inputs) {
            row[..width].copy_from_slice(code);
            row[width..width + near].copy_from_slice(context);
            row[width + near] = amount;
        }
        let mut residual = code;
        for layer in &self.hidden {
            hidden = layer.forward(&hidden);
            gelu(&mut hidden);
            if residual.len() == hidden.len() {
                for (number, residual) in hidden.iter_mut().zip(residual.iter()) {
                    *number += residual;
                }
            }
            residual = hidden.clone();
        }
        hidden
    }

    fn read(&self, hidden: &Buffer) -> Readings {
        Readings { ends: self.ends.forward(hidden), logits: self.logits.forward(hidden) }
    }
}

impl AttentionKernels {
    /// Attention of the pedestrians to the others, `[B, encoding width]`. The softmax has an additional score 0 with
    /// the value 0, so that a pedestrian can ignore the others.
    fn attend(&self, asking: &Buffer, others: &OthersRows) -> Buffer {
        let query = self.query.forward(asking);
        let near = query.len() / others.counts.len();
        let mut context = Buffer::zeros(query.len());
        if others.features.is_empty() {
            return context;
        }
        let mut codes = self.code[0].forward(&others.features);
        gelu(&mut codes);
        codes = self.code[1].forward(&codes);
        gelu(&mut codes);
        let (keys, values) = (self.key.forward(&codes), self.value.forward(&codes));
        let depth = near / self.heads;
        let scale = 1.0 / (depth as f32).sqrt();
        let mut first = 0;
        let pedestrians = query.chunks_exact(near).zip(context.chunks_exact_mut(near));
        for ((query, context), &count) in pedestrians.zip(&others.counts) {
            let rows = first * near..(first + count) * near;
            first += count;
            let (keys, values) = (&keys[rows.clone()], &values[rows]);
            for head in 0..self.heads {
                let part = head * depth..(head + 1) * depth;
                let dot = |key: &[f32]| -> f32 {
                    query[part.clone()].iter().zip(&key[part.clone()]).map(|(q, k)| q * k).sum()
                };
                let scores: Vec<f32> = keys.chunks_exact(near).map(|key| dot(key) * scale).collect();
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

/// Some of the `count` rows of `numbers`.
fn rows_of(numbers: &Buffer, rows: &[usize], count: usize) -> Buffer {
    let width = numbers.len() / count;
    let mut taken = Buffer::any(rows.len() * width);
    for (taken, &row) in taken.chunks_exact_mut(width).zip(rows) {
        taken.copy_from_slice(&numbers[row * width..(row + 1) * width]);
    }
    taken
}

fn kernel(layer: MemberAffine, member: usize, weights: &Weights) -> LinearKernel {
    let MemberAffine { inputs, outputs, .. } = layer;
    let [weight, bias] = layer.of_member(member).map(|span| &weights.numbers()[span]);
    // The kernel takes W as `[outputs, inputs]`.
    let by_outputs = (0..outputs).flat_map(|o| (0..inputs).map(move |i| weight[i * outputs + o]));
    let numbers: Vec<f32> = by_outputs.chain(bias.iter().copied()).collect();
    let mut kernel = LinearKernel::zeros(inputs, outputs);
    kernel.update(&numbers);
    kernel
}
