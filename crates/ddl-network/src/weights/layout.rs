//! The tensors of a network: names, order, shapes and initial values.

use crate::kernel::Sizes;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// The initial values of a tensor.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Initial {
    /// Uniform in ±`bound`, then multiplied by `scale`.
    Uniform {
        /// Largest absolute value drawn.
        bound: f64,
        /// Factor, multiplied in single precision.
        scale: f64,
    },
    /// All numbers have this value.
    Constant(f64),
    /// These numbers. As many random numbers are drawn and discarded, so that later draws are the same as with
    /// [`Uniform`](Self::Uniform).
    Fixed(Vec<f64>),
}

/// One tensor of weights.
#[derive(Debug, Clone, PartialEq)]
pub struct TensorLayout {
    name: String,
    shape: Vec<usize>,
    initial: Initial,
    first: usize,
    pub(crate) training_only: bool,
}

impl TensorLayout {
    /// Its name in files.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its shape; its numbers are in row-major order.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// The range of its numbers among those of all tensors.
    pub fn span(&self) -> Range<usize> {
        self.first..self.first + self.shape.iter().product::<usize>()
    }
}

/// The tensors of a network, in order.
///
/// A network declares its layers when it is built, and gets a handle for each, with which it finds the weights.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    tensors: Vec<TensorLayout>,
    count: usize,
    pub(crate) linears: Vec<Linear>,
    pub(crate) encoder_layers: Vec<EncoderLayer>,
}

/// An affine map y = x W^T + b of a layout: the weight `[outputs, inputs]`, then the bias `[outputs]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Linear {
    /// Index among the affine maps of the layout.
    pub number: usize,
    /// Index of its weight among the tensors of the layout; its bias is the next tensor.
    pub tensor: usize,
    /// Index of its first number among all weights.
    pub first: usize,
    /// Width of x.
    pub inputs: usize,
    /// Width of y.
    pub outputs: usize,
}

impl Linear {
    /// The range of its numbers among all weights.
    pub fn span(self) -> Range<usize> {
        self.first..self.first + self.outputs * (self.inputs + 1)
    }
}

/// A Transformer encoder layer of a layout: twelve tensors, from `self_attn.in_proj_weight` to `norm2.bias`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EncoderLayer {
    /// Index among the encoder layers of the layout.
    pub number: usize,
    /// Index of its first tensor among those of the layout.
    pub tensor: usize,
    /// Index of its first number among all weights.
    pub first: usize,
    /// Width, heads and hidden width.
    pub sizes: Sizes,
    /// Probability of dropout in training.
    pub dropout: f64,
}

impl EncoderLayer {
    /// The range of its numbers among all weights.
    pub(crate) fn span(self) -> Range<usize> {
        self.first..self.first + self.sizes.count()
    }
}

impl Layout {
    /// All tensors, in order.
    pub fn tensors(&self) -> &[TensorLayout] {
        &self.tensors
    }

    /// Number of weights in all tensors.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Declares a tensor and returns its index.
    pub(crate) fn tensor(&mut self, name: String, shape: &[usize], initial: Initial) -> usize {
        self.tensors.push(TensorLayout {
            name,
            shape: shape.to_vec(),
            initial,
            first: self.count,
            training_only: false,
        });
        self.count += shape.iter().product::<usize>();
        self.tensors.len() - 1
    }

    /// Declares a tensor with initial values uniform in ±`bound`.
    pub(crate) fn uniform(&mut self, name: String, shape: &[usize], bound: f64) -> usize {
        self.tensor(name, shape, Initial::Uniform { bound, scale: 1.0 })
    }

    /// Declares a tensor whose initial values are all `value`.
    pub(crate) fn constant(&mut self, name: String, shape: &[usize], value: f64) -> usize {
        self.tensor(name, shape, Initial::Constant(value))
    }

    /// Marks a tensor that only the training loss reads.
    ///
    /// # Panics
    /// If no tensor has this index.
    pub(crate) fn mark_training_only(&mut self, tensor: usize) {
        self.tensors[tensor].training_only = true;
    }

    /// Declares an affine map whose initial weight and bias are uniform in ±1/sqrt(inputs).
    pub fn linear(&mut self, name: &str, inputs: usize, outputs: usize) -> Linear {
        let bound = 1.0 / (inputs as f64).sqrt();
        let begin = Initial::Uniform { bound, scale: 1.0 };
        self.linear_with_initial(name, [inputs, outputs], begin.clone(), begin)
    }

    /// Declares an affine map with these initial values.
    pub(crate) fn linear_with_initial(
        &mut self,
        name: &str,
        [inputs, outputs]: [usize; 2],
        weight: Initial,
        bias: Initial,
    ) -> Linear {
        let first = self.count;
        let tensor = self.tensor(format!("{name}.weight"), &[outputs, inputs], weight);
        self.tensor(format!("{name}.bias"), &[outputs], bias);
        let linear = Linear { number: self.linears.len(), tensor, first, inputs, outputs };
        self.linears.push(linear);
        linear
    }

    /// Declares an encoder layer. The joint projection of query, key and value is initially Xavier-uniform with biases
    /// of 0. The feed-forward layers are as in [`linear`](Self::linear), and so is the output projection, but with zero
    /// bias.
    pub fn encoder_layer(&mut self, name: &str, sizes: Sizes, dropout: f64) -> EncoderLayer {
        let Sizes { width, hidden, .. } = sizes;
        let (first, tensor) = (self.count, self.tensors.len());
        // The same order as in `Sizes`.
        let bound = (6.0 / (4 * width) as f64).sqrt();
        self.uniform(format!("{name}.self_attn.in_proj_weight"), &[3 * width, width], bound);
        self.constant(format!("{name}.self_attn.in_proj_bias"), &[3 * width], 0.0);
        let mut affine = |name: String, inputs: usize, outputs: usize, zero_bias: bool| {
            let bound = 1.0 / (inputs as f64).sqrt();
            self.uniform(format!("{name}.weight"), &[outputs, inputs], bound);
            let bias = if zero_bias { Initial::Constant(0.0) } else { Initial::Uniform { bound, scale: 1.0 } };
            self.tensor(format!("{name}.bias"), &[outputs], bias);
        };
        affine(format!("{name}.self_attn.out_proj"), width, width, true);
        affine(format!("{name}.linear1"), width, hidden, false);
        affine(format!("{name}.linear2"), hidden, width, false);
        for norm in ["norm1", "norm2"] {
            self.constant(format!("{name}.{norm}.weight"), &[width], 1.0);
            self.constant(format!("{name}.{norm}.bias"), &[width], 0.0);
        }
        let layer = EncoderLayer { number: self.encoder_layers.len(), tensor, first, sizes, dropout };
        self.encoder_layers.push(layer);
        layer
    }

    /// Initial values, drawn in the order of the tensors; the same on every machine.
    pub fn initial(&self, mut rng: ChaCha8Rng) -> Vec<f64> {
        let mut numbers = Vec::with_capacity(self.count);
        for tensor in &self.tensors {
            let count = tensor.span().len();
            match &tensor.initial {
                Initial::Constant(value) => numbers.resize(numbers.len() + count, *value),
                Initial::Fixed(values) => {
                    numbers.extend(values);
                    for _ in 0..count {
                        let _: f64 = rng.random();
                    }
                }
                Initial::Uniform { bound, scale } => numbers.extend((0..count).map(|_| {
                    let drawn = bound * (2.0 * rng.random::<f64>() - 1.0);
                    if (scale - 1.0).abs() < f64::EPSILON { drawn } else { f64::from(drawn as f32 * *scale as f32) }
                })),
            }
        }
        numbers
    }
}
