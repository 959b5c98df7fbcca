//! The formula in double precision, term by term; of numbers rounded to bf16 where the layer takes these.

use crate::Precision;
use crate::kernel::feed_forward::dropout::reference;
use crate::kernel::tests::numbers::Numbers;
use crate::kernel::{Dropout, FeedForward, Gradients};

/// A layer and what it is applied to.
#[derive(Clone)]
pub(super) struct Case {
    pub(super) width: usize,
    pub(super) hidden: usize,
    pub(super) w1: Vec<f32>,
    pub(super) b1: Vec<f32>,
    pub(super) w2: Vec<f32>,
    pub(super) b2: Vec<f32>,
    pub(super) x: Vec<f32>,
    pub(super) gy: Vec<f32>,
    pub(super) dropout: Option<Dropout>,
    pub(super) precision: Precision,
}

/// Sums, each with the sum of its terms' absolute values, and what it may differ by because a unit may count as active
/// or not, or a number may be rounded to bf16 up or down.
pub(super) struct Sums {
    pub(super) values: Vec<f64>,
    pub(super) sizes: Vec<f64>,
    pub(super) doubts: Vec<f64>,
}

impl Sums {
    fn zeros(count: usize) -> Self {
        let zeros = || vec![0.0; count];
        Self {
            values: zeros(),
            sizes: zeros(),
            doubts: zeros(),
        }
    }

    fn add(&mut self, at: usize, term: f64, size: f64, doubt: f64) {
        self.values[at] += term;
        self.sizes[at] += size;
        self.doubts[at] += doubt;
    }
}

/// A computed number: its exact value, the sum of its terms' absolute values, and the doubt about it beyond `f32`.
#[derive(Clone, Copy)]
struct Computed {
    value: f64,
    size: f64,
    doubt: f64,
}

impl Computed {
    /// Rounded to bf16, when it may be off by `steps` roundings of `f32`: the doubt is how far apart the ends of that
    /// range are rounded.
    fn stored(self, precision: Precision, steps: usize) -> Self {
        if precision == Precision::F32 {
            return self;
        }
        let off = self.doubt + steps as f64 * super::UNIT * self.size;
        let value = bf16(self.value);
        let ends = [self.value - off, self.value + off].map(|end| (bf16(end) - value).abs());
        Self {
            value,
            // No farther than the computed one, and 2^-8 of that.
            size: 1.01 * self.size,
            doubt: ends[0].max(ends[1]),
        }
    }
}

/// The nearest number with 8 significant bits, ties to even.
fn bf16(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let step = 2_f64.powi(value.abs().log2().floor() as i32 - 7);
    (value / step).round_ties_even() * step
}

pub(super) struct Exact {
    pub(super) y: Sums,
    /// With respect to x, W1, b1, W2, b2.
    pub(super) gradients: [Sums; 5],
}

impl Case {
    pub(super) fn new(width: usize, hidden: usize, rows: usize, dropout: Option<Dropout>) -> Self {
        let mut numbers = Numbers((width * 1_000_003 + hidden * 1009 + rows) as u64);
        let (inner, outer) = (1.0 / (width as f32).sqrt(), 1.0 / (hidden as f32).sqrt());
        Self {
            width,
            hidden,
            w1: numbers.even(hidden * width, inner),
            b1: numbers.even(hidden, inner),
            w2: numbers.even(width * hidden, outer),
            b2: numbers.even(width, outer),
            x: numbers.even(rows * width, 1.5),
            gy: numbers.even(rows * width, 1.0),
            dropout,
            precision: Precision::F32,
        }
    }

    /// The same in bf16.
    pub(super) fn in_bf16(self) -> Self {
        Self {
            precision: Precision::Bf16,
            ..self
        }
    }

    pub(super) fn layer(&self) -> FeedForward {
        let Self {
            w1,
            b1,
            w2,
            b2,
            width,
            hidden,
            ..
        } = self;
        FeedForward::pack(self.precision, w1, b1, w2, b2, *width, *hidden)
    }

    /// y, gx and the derivatives of the weights.
    pub(super) fn run(&self, layer: &FeedForward) -> (Vec<f32>, Vec<f32>, Gradients) {
        // Both are overwritten.
        let [mut y, mut gx] = [vec![f32::NAN; self.x.len()], vec![f32::NAN; self.x.len()]];
        let mut grads = Gradients::zeros(self.width, self.hidden);
        layer.forward(&self.x, self.dropout, &mut y);
        layer.backward(&self.x, &self.gy, self.dropout, &mut gx, &mut grads);
        (y, gx, grads)
    }

    /// 0 for a unit that is dropped, else what it is scaled by.
    fn factor(&self, row: usize, unit: usize) -> f64 {
        self.dropout
            .map_or(1.0, |dropout| reference::factor(dropout, row, unit))
    }

    pub(super) fn exact(&self) -> Exact {
        let (width, hidden, precision) = (self.width, self.hidden, self.precision);
        let taken = |values: &[f32]| -> Vec<f64> {
            let wide = values.iter().map(|value| f64::from(*value));
            match precision {
                Precision::F32 => wide.collect(),
                Precision::Bf16 => wide.map(bf16).collect(),
            }
        };
        let [all_x, all_gy, w1, w2] = [&self.x, &self.gy, &self.w1, &self.w2].map(|v| taken(v));
        let mut y = Sums::zeros(self.x.len());
        let counts = [self.x.len(), hidden * width, hidden, width * hidden, width];
        let [mut gx, mut of_w1, mut of_b1, mut of_w2, mut of_b2] = counts.map(Sums::zeros);
        for row in 0..self.x.len() / width {
            let (x, gy) = (&all_x[row * width..], &all_gy[row * width..]);
            for i in 0..width {
                let b = f64::from(self.b2[i]);
                y.add(row * width + i, b, b.abs(), 0.0);
                let gy = f64::from(self.gy[row * width + i]);
                of_b2.add(i, gy, gy.abs(), 0.0);
            }
            for j in 0..hidden {
                let factor = self.factor(row, j);
                let b = f64::from(self.b1[j]);
                let [mut sum, mut size] = [b, b.abs()];
                let [mut back, mut back_size] = [0.0; 2];
                for k in 0..width {
                    let term = w1[j * width + k] * x[k];
                    sum += term;
                    size += term.abs();
                    let term = w2[k * hidden + j] * gy[k];
                    back += term;
                    back_size += term.abs();
                }
                let in_doubt = sum.abs() <= (width + 2) as f64 * super::UNIT * size;
                let active = if sum > 0.0 { factor } else { 0.0 };
                let activation = Computed {
                    value: active * sum,
                    size: factor * size,
                    doubt: 0.0,
                }
                .stored(precision, width + 4);
                let back = Computed {
                    value: active * back,
                    size: factor * back_size,
                    doubt: if in_doubt { factor * back_size } else { 0.0 },
                };
                of_b1.add(j, back.value, back.size, back.doubt);
                let back = back.stored(precision, width + 4);
                let add = |sums: &mut Sums, at: usize, factor: f64, number: Computed| {
                    let Computed { value, size, doubt } = number;
                    let of = factor.abs();
                    sums.add(at, factor * value, of * size, of * doubt);
                };
                for k in 0..width {
                    add(&mut y, row * width + k, w2[k * hidden + j], activation);
                    add(&mut gx, row * width + k, w1[j * width + k], back);
                    add(&mut of_w1, j * width + k, x[k], back);
                    add(&mut of_w2, k * hidden + j, gy[k], activation);
                }
            }
        }
        Exact {
            y,
            gradients: [gx, of_w1, of_b1, of_w2, of_b2],
        }
    }

    /// The sum of gy y with one number of x, W1, b1, W2 or b2 changed.
    pub(super) fn loss_with(&self, which: usize, at: usize, change: f64) -> f64 {
        let wide = |values: &[f32]| -> Vec<f64> { values.iter().map(|v| f64::from(*v)).collect() };
        let mut inputs = [&self.x, &self.w1, &self.b1, &self.w2, &self.b2].map(|v| wide(v));
        inputs[which][at] += change;
        let [x, w1, b1, w2, b2] = inputs;
        let (width, hidden) = (self.width, self.hidden);
        let mut loss = 0.0;
        for row in 0..self.x.len() / width {
            let x = &x[row * width..][..width];
            for i in 0..width {
                let mut y = b2[i];
                for j in 0..hidden {
                    let terms = w1[j * width..][..width].iter().zip(x).map(|(w, x)| w * x);
                    let sum = b1[j] + terms.sum::<f64>();
                    y += w2[i * hidden + j] * sum.max(0.0) * self.factor(row, j);
                }
                loss += f64::from(self.gy[row * width + i]) * y;
            }
        }
        loss
    }
}
