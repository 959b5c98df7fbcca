//! The formula in double precision, term by term.

use crate::kernel::Dropout;
use crate::kernel::feed_forward::dropout::reference;
use crate::kernel::feed_forward::{FeedForward, LayerGradients};
use crate::kernel::tests::numbers::SeededNumbers;

/// The relative error of one rounding.
pub(super) const UNIT: f64 = 1.0 / 16_777_216.0;

/// A layer with its input and the gradient of its output.
pub(super) struct FeedForwardCase {
    pub(super) width: usize,
    pub(super) hidden: usize,
    pub(super) w1: Vec<f32>,
    pub(super) b1: Vec<f32>,
    pub(super) w2: Vec<f32>,
    pub(super) b2: Vec<f32>,
    pub(super) x: Vec<f32>,
    pub(super) gy: Vec<f32>,
    pub(super) dropout: Option<Dropout>,
}

/// A sum with the sum of its terms' absolute values, and the possible difference from units whose activity is
/// ambiguous.
#[derive(Clone, Default)]
pub(super) struct Sum {
    pub(super) value: f64,
    pub(super) size: f64,
    pub(super) doubt: f64,
}

impl Sum {
    fn add(&mut self, term: f64, size: f64, doubt: bool) {
        self.value += term;
        self.size += size;
        self.doubt += if doubt { size } else { 0.0 };
    }
}

impl FeedForwardCase {
    pub(super) fn new(width: usize, hidden: usize, rows: usize, dropout: Option<Dropout>) -> Self {
        let mut numbers = SeededNumbers::seeded((width * 1_000_003 + hidden * 1009 + rows) as u64);
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
        }
    }

    pub(super) fn weights(&self) -> [&[f32]; 4] {
        [&self.w1, &self.b1, &self.w2, &self.b2]
    }

    pub(super) fn layer(&self) -> FeedForward {
        let mut layer = FeedForward::zeros(self.width, self.hidden);
        layer.update(self.weights());
        layer
    }

    pub(super) fn run(&self, layer: &FeedForward) -> (Vec<f32>, Vec<f32>, LayerGradients) {
        // The passes overwrite both.
        let [mut y, mut gx] = [vec![f32::NAN; self.x.len()], vec![f32::NAN; self.x.len()]];
        let mut grads = LayerGradients::zeros(self.width, self.hidden);
        layer.forward(&self.x, self.dropout, &mut y);
        layer.backward(&self.x, &self.gy, self.dropout, &mut gx, &mut grads);
        (y, gx, grads)
    }

    /// The factor of a unit: 0 if it is dropped, otherwise 1 / (1 - p).
    pub(super) fn factor(&self, row: usize, unit: usize) -> f64 {
        self.dropout.map_or(1.0, |dropout| reference::factor(dropout, row, unit))
    }

    /// y, and the gradients of x, W1, b1, W2, b2.
    pub(super) fn exact(&self) -> [Vec<Sum>; 6] {
        let (width, hidden) = (self.width, self.hidden);
        let (rows, weights) = (self.x.len(), hidden * width);
        let counts = [rows, rows, weights, hidden, weights, width];
        let [mut y, mut gx, mut w1, mut b1, mut w2, mut b2] = counts.map(|count| vec![Sum::default(); count]);
        for row in 0..self.x.len() / width {
            let x = |k: usize| f64::from(self.x[row * width + k]);
            let gy = |i: usize| f64::from(self.gy[row * width + i]);
            for i in 0..width {
                let b = f64::from(self.b2[i]);
                y[row * width + i].add(b, b.abs(), false);
                b2[i].add(gy(i), gy(i).abs(), false);
            }
            for j in 0..hidden {
                let factor = self.factor(row, j);
                let b = f64::from(self.b1[j]);
                let [mut sum, mut size] = [b, b.abs()];
                let [mut back, mut back_size] = [0.0; 2];
                for k in 0..width {
                    let term = f64::from(self.w1[j * width + k]) * x(k);
                    sum += term;
                    size += term.abs();
                    let term = f64::from(self.w2[k * hidden + j]) * gy(k);
                    back += term;
                    back_size += term.abs();
                }
                let in_doubt = sum.abs() <= (width + 2) as f64 * UNIT * size;
                let active = if sum > 0.0 { factor } else { 0.0 };
                let (sum, size) = (active * sum, factor * size);
                let (back, back_size) = (active * back, factor * back_size);
                b1[j].add(back, back_size, in_doubt);
                for k in 0..width {
                    let w = f64::from(self.w2[k * hidden + j]);
                    y[row * width + k].add(w * sum, w.abs() * size, false);
                    let w = f64::from(self.w1[j * width + k]);
                    gx[row * width + k].add(w * back, w.abs() * back_size, in_doubt);
                    w1[j * width + k].add(x(k) * back, x(k).abs() * back_size, in_doubt);
                    w2[k * hidden + j].add(gy(k) * sum, gy(k).abs() * size, false);
                }
            }
        }
        [y, gx, w1, b1, w2, b2]
    }
}
