//! The operations of a backbone on libtorch: on any device, in any precision, with automatic gradients.

use crate::model::attention;
use crate::model::parameters::Parameters;
use crate::model::scene_rows::SeenNeighbours;
use ddl_network::backend::{Backend, Mode};
use ddl_network::weights::{EncoderLayer, Linear};
use std::rc::Rc;
use tch::Tensor;

/// One pass of libtorch through a network.
#[derive(Debug)]
pub struct TorchBackend {
    tensors: Vec<Tensor>,
    mode: Mode,
}

impl TorchBackend {
    /// A pass with libtorch's own gradients.
    pub(crate) fn new(parameters: &Parameters, mode: Mode) -> Self {
        let tensors = parameters.tensors().iter();
        Self {
            tensors: tensors.map(Tensor::shallow_clone).collect(),
            mode,
        }
    }

    /// The weight of that index and the bias after it.
    pub(super) fn learned(&self, weight: usize) -> [&Tensor; 2] {
        [weight, weight + 1].map(|number| &self.tensors[number])
    }

    /// y = x W^T + b, with the weight of that index and the bias after it.
    /// Shapes: `x` `[.., inputs]` -> `[.., outputs]`.
    fn affine(&self, x: &Tensor, weight: usize) -> Tensor {
        let [weight, bias] = self.learned(weight);
        x.linear(weight, Some(bias))
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

    /// Layer normalisation over the last dimension (Ba et al. 2016), eps = 1e-5.
    fn norm(&self, x: &Tensor, weight: usize) -> Tensor {
        let [weight, bias] = self.learned(weight);
        x.layer_norm(weight.size(), Some(weight), Some(bias), 1e-5, true)
    }
}

impl Backend for TorchBackend {
    type Tokens = Rc<Tensor>;
    type KeyValues = Rc<Tensor>;
    type Seen = Rc<SeenNeighbours>;

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
        if self.entries(x) == batch {
            Rc::clone(x)
        } else {
            Rc::new(x.expand([batch as i64, -1, -1], false))
        }
    }

    fn spatial_attention(&self, layer: EncoderLayer, x: &Rc<Tensor>, seen: &Rc<SeenNeighbours>) -> Rc<Tensor> {
        let p = match self.mode {
            Mode::Train => layer.dropout,
            Mode::Evaluate => 0.0,
        };
        let qkv = self.affine(x, layer.tensor);
        let mixed = attention::spatial_attention(&qkv, layer.sizes.heads as i64, seen, p);
        self.after_attention(layer, x, &mixed)
    }

    fn temporal_attention(&self, layer: EncoderLayer, newest: &Rc<Tensor>, cache: &[Rc<Tensor>]) -> Rc<Tensor> {
        let qkv = self.affine(newest, layer.tensor);
        let mixed = attention::temporal_attention(&qkv, layer.sizes.heads as i64, cache);
        self.after_attention(layer, newest, &mixed)
    }

    fn key_values(&self, layer: EncoderLayer, x: &Rc<Tensor>) -> Rc<Tensor> {
        // The query is projected too, because the gradient of a slice of the weights would have the size of all weights
        // at every token.
        Rc::new(self.affine(x, layer.tensor))
    }

    fn repeat_key_values(&self, cached: &Rc<Tensor>, batch: usize) -> Rc<Tensor> {
        Rc::new(cached.expand([batch as i64, -1, -1], false))
    }
}
