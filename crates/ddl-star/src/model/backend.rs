//! The operations of a backbone on libtorch: on any device, in any precision, with automatic gradients.

use crate::model::attention;
use crate::model::attention_blocks::AttentionBlocks;
use crate::model::parameters::Parameters;
use crate::model::shared_weights::{LearnedMap, SharedWeights};
use ddl_network::backend::{Backend, Mode};
use ddl_network::weights::{EncoderLayer, Linear};
use std::rc::Rc;
use tch::{TchError, Tensor};

/// One pass of libtorch through a network.
#[derive(Debug)]
pub struct TorchBackend {
    tensors: Vec<Tensor>,
    mode: Mode,
    /// Only in a pass of training.
    shared: Option<SharedWeights>,
}

impl TorchBackend {
    /// A pass with libtorch's own gradients, if any.
    pub(crate) fn new(parameters: &Parameters, mode: Mode) -> Self {
        let tensors = parameters.tensors.iter();
        Self { tensors: tensors.map(Tensor::shallow_clone).collect(), mode, shared: None }
    }

    /// A pass of training, with a [`gradient`](Self::gradient).
    pub(crate) fn training(parameters: &Parameters, mode: Mode) -> Self {
        Self { shared: Some(SharedWeights::default()), ..Self::new(parameters, mode) }
    }

    /// The gradient of a loss of this pass with respect to all learned numbers, as one vector.
    pub(crate) fn gradient(&self, loss: &Tensor, parameters: &Parameters) -> Result<Tensor, TchError> {
        match &self.shared {
            Some(shared) => shared.gradient(loss, parameters),
            None => parameters.gradient_of(loss),
        }
    }

    fn mapped(&self, map: LearnedMap, x: &Tensor, weight: usize) -> Tensor {
        let [of_weight, bias] = self.learned(weight);
        match &self.shared {
            Some(shared) => shared.used(map, x, &self.tensors, weight),
            None => map.apply(x, of_weight, bias),
        }
    }

    /// The weight of that index and the bias after it.
    pub(super) fn learned(&self, weight: usize) -> [&Tensor; 2] {
        [weight, weight + 1].map(|number| &self.tensors[number])
    }

    /// y = x W^T + b, with the weight of that index and the bias after it.
    /// Shapes: `x` `[.., inputs]` -> `[.., outputs]`.
    fn affine(&self, x: &Tensor, weight: usize) -> Tensor {
        self.mapped(LearnedMap::Affine, x, weight)
    }

    /// Queries, keys and values of the cached tokens and of a new one. Shapes: `x` `[B, P, width]`, `cached` `[t, B, P,
    /// 3 * width]` -> `[t + 1, B, P, 3 * width]`.
    fn with_newest(&self, layer: EncoderLayer, x: &Tensor, cached: Option<&Rc<Tensor>>) -> Tensor {
        let newest = self.affine(x, layer.tensor).unsqueeze(0);
        match cached {
            None => newest,
            Some(cached) => Tensor::cat(&[&**cached, &newest], 0),
        }
    }

    /// The part of an encoder layer after attention.
    fn after_attention(&self, layer: EncoderLayer, x: &Tensor, mixed: &Tensor) -> Rc<Tensor> {
        let (first, p, mode) = (layer.tensor, layer.dropout, self.mode);
        let attended = self.affine(mixed, first + 2);
        let train = mode == Mode::Train;
        let x = self.norm(&(x + attended.dropout(p, train)), first + 8);
        let hidden = self.affine(&x, first + 4).relu().dropout(p, train);
        let fed = self.affine(&hidden, first + 6).dropout(p, train);
        Rc::new(self.norm(&(x + fed), first + 10))
    }

    /// Layer normalisation over the last dimension.
    fn norm(&self, x: &Tensor, weight: usize) -> Tensor {
        self.mapped(LearnedMap::Norm, x, weight)
    }
}

impl Backend for TorchBackend {
    type Tokens = Rc<Tensor>;
    type KeyValues = Rc<Tensor>;
    type Seen = Rc<AttentionBlocks>;

    fn entries(&self, x: &Rc<Tensor>) -> usize {
        x.size()[0] as usize
    }

    fn linear(&self, layer: Linear, x: &Rc<Tensor>) -> Rc<Tensor> {
        Rc::new(self.affine(x, layer.tensor))
    }

    fn relu(&self, x: &Rc<Tensor>) -> Rc<Tensor> {
        Rc::new(x.relu())
    }

    fn concatenate(&self, x: &Rc<Tensor>, other: &Rc<Tensor>) -> Rc<Tensor> {
        Rc::new(Tensor::cat(&[&**x, &**other], -1))
    }

    fn repeated(&self, x: &Rc<Tensor>, batch: usize) -> Rc<Tensor> {
        if self.entries(x) == batch { Rc::clone(x) } else { Rc::new(x.expand([batch as i64, -1, -1], false)) }
    }

    fn spatial_attention(&self, layer: EncoderLayer, x: &Rc<Tensor>, seen: &Rc<AttentionBlocks>) -> Rc<Tensor> {
        let p = match self.mode {
            Mode::Train => layer.dropout,
            Mode::Evaluate => 0.0,
        };
        let qkv = self.affine(x, layer.tensor);
        let mixed = attention::spatial_attention(&qkv, layer.sizes.heads as i64, seen, p);
        self.after_attention(layer, x, &mixed)
    }

    fn temporal_attention(&self, layer: EncoderLayer, newest: &Rc<Tensor>, cache: &[Rc<Tensor>]) -> Rc<Tensor> {
        let tokens = self.with_newest(layer, newest, cache.first());
        let mixed = attention::temporal_attention(&tokens, layer.sizes.heads as i64);
        self.after_attention(layer, newest, &mixed)
    }

    fn remember(&self, layer: EncoderLayer, x: &Rc<Tensor>, cache: &mut Vec<Rc<Tensor>>) {
        // One tensor for all tokens: the gradient of each of several would be added at every later step.
        let tokens = self.with_newest(layer, x, cache.pop().as_ref());
        cache.push(Rc::new(tokens));
    }

    fn repeat_key_values(&self, cached: &Rc<Tensor>, batch: usize) -> Rc<Tensor> {
        Rc::new(cached.expand([-1, batch as i64, -1, -1], false))
    }
}
