//! The formula in double precision, term by term.

use crate::kernel::Dropout;
use crate::kernel::feed_forward::dropout::reference;
use crate::kernel::feed_forward::{FeedForward, Gradients};
use crate::kernel::tests::numbers::Numbers;

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
}

/// Sums, each with the sum of its terms' absolute values, and the possible difference from units whose activity is
/// ambiguous.
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

    fn add(&mut self, entry: usize, term: f64, size: f64, doubt: bool) {
        self.values[entry] += term;
        self.sizes[entry] += size;
        self.doubts[entry] += if doubt { size } else { 0.0 };
    }
}

pub(super) struct Exact {
    pub(super) y: Sums,
    /// Gradients of x, W1, b1, W2, b2.
    pub(super) gradients: [Sums; 5],
}

impl Case {
    pub(super) fn new(width: usize, hidden: usize, rows: usize, dropout: Option<Dropout>) -> Self {
        let mut numbers = Numbers::seeded((width * 1_000_003 + hidden * 1009 + rows) as u64);
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

    pub(super) fn run(&self, layer: &FeedForward) -> (Vec<f32>, Vec<f32>, Gradients) {
        // The passes overwrite both.
        let [mut y, mut gx] = [vec![f32::NAN; self.x.len()], vec![f32::NAN; self.x.len()]];
        let mut grads = Gradients::zeros(self.width, self.hidden);
        layer.forward(&self.x, self.dropout, &mut y);
        layer.backward(&self.x, &self.gy, self.dropout, &mut gx, &mut grads);
        (y, gx, grads)
    }

    /// The factor of a unit: 0 if it is dropped, otherwise 1 / (1 - p).
    pub(super) fn factor(&self, row: usize, unit: usize) -> f64 {
        self.dropout
            .map_or(1.0, |dropout| reference::factor(dropout, row, unit))
    }

    pub(super) fn exact(&self) -> Exact {
        let (width, hidden) = (self.width, self.hidden);
        let mut y = Sums::zeros(self.x.len());
        let counts = [self.x.len(), hidden * width, hidden, width * hidden, width];
        let [mut gx, mut w1, mut b1, mut w2, mut b2] = counts.map(Sums::zeros);
        for row in 0..self.x.len() / width {
            let x = |k: usize| f64::from(self.x[row * width + k]);
            let gy = |i: usize| f64::from(self.gy[row * width + i]);
            for i in 0..width {
                let b = f64::from(self.b2[i]);
                y.add(row * width + i, b, b.abs(), false);
                b2.add(i, gy(i), gy(i).abs(), false);
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
                let in_doubt = sum.abs() <= (width + 2) as f64 * super::UNIT * size;
                let active = if sum > 0.0 { factor } else { 0.0 };
                let (sum, size) = (active * sum, factor * size);
                let (back, back_size) = (active * back, factor * back_size);
                b1.add(j, back, back_size, in_doubt);
                for k in 0..width {
                    let w = f64::from(self.w2[k * hidden + j]);
                    y.add(row * width + k, w * sum, w.abs() * size, false);
                    let w = f64::from(self.w1[j * width + k]);
                    gx.add(row * width + k, w * back, w.abs() * back_size, in_doubt);
                    w1.add(j * width + k, x(k) * back, x(k).abs() * back_size, in_doubt);
                    w2.add(k * hidden + j, gy(k) * sum, gy(k).abs() * size, false);
                }
            }
        }
        Exact {
            y,
            gradients: [gx, w1, b1, w2, b2],
        }
    }
}
