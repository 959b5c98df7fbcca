//! PLACEHOLDER: plain version with the interface of the fast one.

#[derive(Debug, Clone, Copy)]
pub(crate) struct Dropout {
    pub(crate) p: f64,
    pub(crate) seed: u64,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Gradients {
    pub(crate) w1: Vec<f32>,
    pub(crate) b1: Vec<f32>,
    pub(crate) w2: Vec<f32>,
    pub(crate) b2: Vec<f32>,
}

#[derive(Debug)]
pub(crate) struct FeedForward {
    w1: Vec<f32>,
    b1: Vec<f32>,
    w2: Vec<f32>,
    b2: Vec<f32>,
    width: usize,
    hidden: usize,
}

impl Gradients {
    /// The gradient of a weight, by its name within the layer.
    pub(crate) fn named(&self, name: &str) -> Option<&[f32]> {
        match name {
            ".linear1.weight" => Some(&self.w1),
            ".linear1.bias" => Some(&self.b1),
            ".linear2.weight" => Some(&self.w2),
            ".linear2.bias" => Some(&self.b2),
            _ => None,
        }
    }

    pub(crate) fn zeros(width: usize, hidden: usize) -> Self {
        Self {
            w1: vec![0.0; width * hidden],
            b1: vec![0.0; hidden],
            w2: vec![0.0; width * hidden],
            b2: vec![0.0; width],
        }
    }
}

impl FeedForward {
    pub(crate) fn pack(
        w1: &[f32],
        b1: &[f32],
        w2: &[f32],
        b2: &[f32],
        width: usize,
        hidden: usize,
    ) -> Self {
        Self {
            w1: w1.to_vec(),
            b1: b1.to_vec(),
            w2: w2.to_vec(),
            b2: b2.to_vec(),
            width,
            hidden,
        }
    }

    fn hidden(&self, x: &[f32], row: usize, j: usize, dropout: Option<Dropout>) -> (f32, f32) {
        let mut sum = self.b1[j];
        for k in 0..self.width {
            sum += x[k] * self.w1[j * self.width + k];
        }
        let keep = dropout.map_or(1.0, |d| {
            let mut z =
                d.seed ^ ((row as u64) << 32 | j as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            if ((z >> 40) as f64) < d.p * (1u64 << 24) as f64 {
                0.0
            } else {
                (1.0 / (1.0 - d.p)) as f32
            }
        });
        if sum > 0.0 {
            (sum * keep, keep)
        } else {
            (0.0, 0.0)
        }
    }

    pub(crate) fn forward(&self, x: &[f32], dropout: Option<Dropout>, y: &mut [f32]) {
        let rows = x
            .chunks_exact(self.width)
            .zip(y.chunks_exact_mut(self.width));
        for (row, (x, y)) in rows.enumerate() {
            y.copy_from_slice(&self.b2);
            for j in 0..self.hidden {
                let (h, _) = self.hidden(x, row, j, dropout);
                if h != 0.0 {
                    for o in 0..self.width {
                        y[o] += h * self.w2[o * self.hidden + j];
                    }
                }
            }
        }
    }

    pub(crate) fn backward(
        &self,
        x: &[f32],
        gy: &[f32],
        dropout: Option<Dropout>,
        gx: &mut [f32],
        grads: &mut Gradients,
    ) {
        gx.fill(0.0);
        let (w, n) = (self.width, self.hidden);
        for (row, ((x, g), gx)) in x
            .chunks_exact(w)
            .zip(gy.chunks_exact(w))
            .zip(gx.chunks_exact_mut(w))
            .enumerate()
        {
            for o in 0..w {
                grads.b2[o] += g[o];
            }
            for j in 0..n {
                let (h, slope) = self.hidden(x, row, j, dropout);
                let mut gh = 0.0;
                for o in 0..w {
                    grads.w2[o * n + j] += g[o] * h;
                    gh += g[o] * self.w2[o * n + j];
                }
                gh *= slope;
                if gh != 0.0 {
                    grads.b1[j] += gh;
                    for k in 0..w {
                        grads.w1[j * w + k] += gh * x[k];
                        gx[k] += gh * self.w1[j * w + k];
                    }
                }
            }
        }
    }
}
