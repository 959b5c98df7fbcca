//! Which learned tensors a network has, in which order, and how they begin.

use crate::kernel::Sizes;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// How a tensor begins.
#[derive(Debug, Clone, PartialEq)]
pub enum Initial {
    /// Uniform in ±`bound`, then multiplied by `scale`.
    Uniform {
        /// Largest number drawn.
        bound: f64,
        /// Multiplied in single precision afterwards.
        scale: f64,
    },
    /// Every number is this.
    Constant(f64),
    /// These numbers. As many are drawn and left, so that what is drawn afterwards does not depend on it.
    DrawnAway(Vec<f64>),
}

/// One learned tensor.
#[derive(Debug, Clone, PartialEq)]
pub struct TensorLayout {
    name: String,
    shape: Vec<usize>,
    initial: Initial,
    first: usize,
    training_only: bool,
}

impl TensorLayout {
    /// Its name in files.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its shape; numbers lie row by row.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Where its numbers stand among those of all tensors.
    pub fn span(&self) -> Range<usize> {
        self.first..self.first + self.shape.iter().product::<usize>()
    }

    /// Whether only the training loss reads it, so that a model that is handed on goes without it.
    pub fn is_training_only(&self) -> bool {
        self.training_only
    }
}

/// The learned tensors of a network, in order.
///
/// A network declares its layers when it is made, and finds their weights by the handles that it gets.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    tensors: Vec<TensorLayout>,
    count: usize,
    linears: Vec<Linear>,
    encoder_layers: Vec<EncoderLayer>,
}

/// An affine map y = x W^T + b of a layout: the weight `[outputs, inputs]`, then the bias `[outputs]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Linear {
    /// Its number among the affine maps of the layout.
    pub number: usize,
    /// The number of its weight among the tensors of the layout; its bias is the next one.
    pub tensor: usize,
    /// Where its numbers begin among all learned ones.
    pub first: usize,
    /// Numbers in a row of x.
    pub inputs: usize,
    /// Numbers in a row of y.
    pub outputs: usize,
}

impl Linear {
    /// Where its numbers stand among all learned ones.
    pub fn span(self) -> Range<usize> {
        self.first..self.first + self.outputs * (self.inputs + 1)
    }
}

/// A Transformer encoder layer of a layout: twelve tensors, from `self_attn.in_proj_weight` to `norm2.bias`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EncoderLayer {
    /// Its number among the encoder layers of the layout.
    pub number: usize,
    /// The number of its first tensor among those of the layout.
    pub tensor: usize,
    /// Where its numbers begin among all learned ones.
    pub first: usize,
    /// Width, heads and hidden width.
    pub sizes: Sizes,
    /// Probability of dropout in training.
    pub dropout: f64,
}

impl EncoderLayer {
    /// Where its numbers stand among all learned ones.
    pub fn span(self) -> Range<usize> {
        self.first..self.first + self.sizes.count()
    }
}

impl Layout {
    /// All tensors, in order.
    pub fn tensors(&self) -> &[TensorLayout] {
        &self.tensors
    }

    /// All affine maps outside encoder layers, in order.
    pub fn linears(&self) -> &[Linear] {
        &self.linears
    }

    /// All encoder layers, in order.
    pub fn encoder_layers(&self) -> &[EncoderLayer] {
        &self.encoder_layers
    }

    /// How many numbers there are in all.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Declares a tensor and gives its number.
    pub fn tensor(&mut self, name: String, shape: &[usize], initial: Initial) -> usize {
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

    /// Declares a tensor that begins uniform in ±`bound`.
    pub fn uniform(&mut self, name: String, shape: &[usize], bound: f64) -> usize {
        self.tensor(name, shape, Initial::Uniform { bound, scale: 1.0 })
    }

    /// Declares a tensor of equal numbers.
    pub fn constant(&mut self, name: String, shape: &[usize], value: f64) -> usize {
        self.tensor(name, shape, Initial::Constant(value))
    }

    /// Says that only the training loss reads this tensor.
    ///
    /// # Panics
    /// When no tensor has this number.
    pub fn mark_training_only(&mut self, tensor: usize) {
        self.tensors[tensor].training_only = true;
    }

    /// Declares an affine map whose weight and bias begin uniform in ±1/sqrt(inputs).
    pub fn linear(&mut self, name: &str, inputs: usize, outputs: usize) -> Linear {
        let bound = 1.0 / (inputs as f64).sqrt();
        let begin = Initial::Uniform { bound, scale: 1.0 };
        self.linear_beginning(name, [inputs, outputs], begin.clone(), begin)
    }

    /// Declares an affine map that begins as said.
    pub fn linear_beginning(
        &mut self,
        name: &str,
        [inputs, outputs]: [usize; 2],
        weight: Initial,
        bias: Initial,
    ) -> Linear {
        let first = self.count;
        let tensor = self.tensor(format!("{name}.weight"), &[outputs, inputs], weight);
        self.tensor(format!("{name}.bias"), &[outputs], bias);
        let linear = Linear {
            number: self.linears.len(),
            tensor,
            first,
            inputs,
            outputs,
        };
        self.linears.push(linear);
        linear
    }

    /// Declares an encoder layer: a Xavier-uniform joint projection of query, key and value, biases of 0 there.
    pub fn encoder_layer(&mut self, name: &str, sizes: Sizes, dropout: f64) -> EncoderLayer {
        let Sizes { width, hidden, .. } = sizes;
        let (first, tensor) = (self.count, self.tensors.len());
        // In the order of `Sizes`.
        let bound = (6.0 / (4 * width) as f64).sqrt();
        self.uniform(
            format!("{name}.self_attn.in_proj_weight"),
            &[3 * width, width],
            bound,
        );
        self.constant(format!("{name}.self_attn.in_proj_bias"), &[3 * width], 0.0);
        let mut affine = |name: String, inputs: usize, outputs: usize, zero_bias: bool| {
            let bound = 1.0 / (inputs as f64).sqrt();
            self.uniform(format!("{name}.weight"), &[outputs, inputs], bound);
            let bias = if zero_bias {
                Initial::Constant(0.0)
            } else {
                Initial::Uniform { bound, scale: 1.0 }
            };
            self.tensor(format!("{name}.bias"), &[outputs], bias);
        };
        affine(format!("{name}.self_attn.out_proj"), width, width, true);
        affine(format!("{name}.linear1"), width, hidden, false);
        affine(format!("{name}.linear2"), hidden, width, false);
        for norm in ["norm1", "norm2"] {
            self.constant(format!("{name}.{norm}.weight"), &[width], 1.0);
            self.constant(format!("{name}.{norm}.bias"), &[width], 0.0);
        }
        let layer = EncoderLayer {
            number: self.encoder_layers.len(),
            tensor,
            first,
            sizes,
            dropout,
        };
        self.encoder_layers.push(layer);
        layer
    }

    /// Initial numbers, drawn in the order of the tensors; the same on every machine.
    pub fn initial(&self, mut rng: ChaCha8Rng) -> Vec<f64> {
        let mut numbers = Vec::with_capacity(self.count);
        for tensor in &self.tensors {
            let count = tensor.span().len();
            match &tensor.initial {
                Initial::Constant(value) => numbers.resize(numbers.len() + count, *value),
                Initial::DrawnAway(values) => {
                    numbers.extend(values);
                    for _ in 0..count {
                        let _: f64 = rng.random();
                    }
                }
                Initial::Uniform { bound, scale } => numbers.extend((0..count).map(|_| {
                    let drawn = bound * (2.0 * rng.random::<f64>() - 1.0);
                    if (scale - 1.0).abs() < f64::EPSILON {
                        drawn
                    } else {
                        f64::from(drawn as f32 * *scale as f32)
                    }
                })),
            }
        }
        numbers
    }
}
