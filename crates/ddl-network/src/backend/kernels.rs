//! The operations of a backbone, computed by the kernels of this crate on the CPU in `f32`.

use crate::backend::operations::{Backend, Mode};
use crate::backend::rows::{Rows, Tape};
use crate::kernel::{self, Buffer, CachedKeyValues, Dropout, Dropouts, Scenes};
use crate::weights::{EncoderLayer, Layout, Linear};
use std::cell::{Cell, RefCell};
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

/// The weights of a network in the layout that the kernels read.
#[derive(Debug, Clone)]
pub struct Kernels {
    layout: Arc<Layout>,
    linears: Vec<Arc<kernel::LinearKernel>>,
    encoder_layers: Vec<Arc<kernel::EncoderKernel>>,
}

impl Kernels {
    /// Kernels with these weights, in the order of the layout.
    ///
    /// # Panics
    /// If the count of `numbers` differs from the layout's.
    pub fn new(layout: &Arc<Layout>, numbers: &[f32]) -> Self {
        let linear = |layer: &Linear| Arc::new(kernel::LinearKernel::zeros(layer.inputs, layer.outputs));
        let encoder = |layer: &EncoderLayer| Arc::new(kernel::EncoderKernel::zeros(layer.sizes));
        let mut kernels = Self {
            layout: Arc::clone(layout),
            linears: layout.linears.iter().map(linear).collect(),
            encoder_layers: layout.encoder_layers.iter().map(encoder).collect(),
        };
        kernels.update(numbers);
        kernels
    }

    /// Replaces the weights. A backward pass that still refers to the earlier weights keeps them unchanged.
    ///
    /// # Panics
    /// If the count of `numbers` differs from the layout's.
    pub fn update(&mut self, numbers: &[f32]) {
        assert_eq!(numbers.len(), self.layout.count(), "number of weights");
        for (kernel, layer) in self.linears.iter_mut().zip(&self.layout.linears) {
            Arc::make_mut(kernel).update(&numbers[layer.span()]);
        }
        let layers = &self.layout.encoder_layers;
        for (kernel, layer) in self.encoder_layers.iter_mut().zip(layers) {
            Arc::make_mut(kernel).update(&numbers[layer.span()]);
        }
    }
}

/// One pass through a network. It computes no gradients unless it is made for training: with the feature `training`
/// a pass can also run backwards.
#[derive(Debug)]
pub struct KernelBackend {
    kernels: Arc<Kernels>,
    mode: Mode,
    seed: Cell<u64>,
    tape: Option<Tape>,
}

/// Keys and values, each `[B, P, width]`, and their gradient accumulated so far.
#[derive(Debug)]
pub struct RowKeyValues {
    rows: CachedKeyValues,
    gradient: RefCell<Option<CachedKeyValues>>,
}

/// The visibility masks of some time steps of scenes.
#[derive(Debug, Clone)]
pub struct VisibleScenes {
    /// The scenes, with all their time steps.
    pub scenes: Arc<Scenes>,
    /// A single time step for all batch entries, or one for each entry.
    pub steps: Range<usize>,
}

impl KernelBackend {
    /// A pass without gradients and without dropout.
    pub(crate) fn forward_only(kernels: Arc<Kernels>) -> Self {
        Self { kernels, mode: Mode::Evaluate, seed: Cell::new(0), tape: None }
    }

    /// A pass whose gradient [`backward`](Self::backward) computes. `seed` determines the dropout in [`Mode::Train`].
    #[cfg(feature = "training")]
    pub fn training(kernels: Arc<Kernels>, mode: Mode, seed: u64) -> Self {
        Self { kernels, mode, seed: Cell::new(seed), tape: Some(Tape::default()) }
    }

    /// Records a step of the backward pass. It runs after the steps recorded later, and may add to the gradients of the
    /// weights.
    pub fn record_backward(&self, step: impl FnOnce(&mut [f32]) + 'static) {
        #[cfg(feature = "training")]
        if let Some(tape) = &self.tape {
            tape.push(step);
        }
        // Without the feature, the backward kernels are never called, so the compiler leaves them out.
        #[cfg(not(feature = "training"))]
        drop(step);
    }

    /// Adds the gradients of all weights to `of_weights`, in the order of the layout. A second call adds nothing.
    #[cfg(feature = "training")]
    pub fn backward(&self, of_weights: &mut [f32]) {
        if let Some(tape) = &self.tape {
            tape.backward(of_weights);
        }
    }

    /// One batch entry of `x`, `[1, P, width]`.
    pub fn entry(&self, x: &Rc<Rows>, entry: usize) -> Rc<Rows> {
        let [_, pedestrians, width] = x.shape();
        let first = entry * pedestrians * width;
        let numbers = Buffer::copy(&x[first..][..pedestrians * width]);
        let x = Rc::clone(x);
        self.made([1, pedestrians, width], numbers, move |gradient, _| {
            x.add_gradient_at(first, gradient);
        })
    }

    /// The output of a kernel. `backward` receives the gradient of the output, and adds to the gradients of the
    /// kernel's inputs and of all weights.
    fn made(
        &self,
        shape: [usize; 3],
        numbers: Buffer,
        backward: impl FnOnce(&[f32], &mut [f32]) + 'static,
    ) -> Rc<Rows> {
        let rows = Rc::new(Rows::new(shape, numbers));
        let output = Rc::clone(&rows);
        self.record_backward(move |of_weights| {
            // If there is no gradient, the loss does not depend on this output.
            if let Some(gradient) = output.gradient.take() {
                backward(&gradient, of_weights);
            }
        });
        rows
    }

    fn dropouts(&self, layer: EncoderLayer) -> Dropouts {
        let [weights, attended, hidden, fed] = [0; 4].map(|_| self.dropout(layer.dropout));
        Dropouts { weights, attended, hidden, fed }
    }

    fn dropout(&self, p: f64) -> Option<Dropout> {
        if self.mode == Mode::Evaluate || p == 0.0 {
            return None;
        }
        let seed = self.seed.get();
        // Steps of an odd constant reach all 2^64 seeds before one repeats.
        self.seed.set(seed.wrapping_add(0x9e37_79b9_7f4a_7c15));
        Some(Dropout { p, seed })
    }

    fn encoder(&self, layer: EncoderLayer) -> Arc<kernel::EncoderKernel> {
        Arc::clone(&self.kernels.encoder_layers[layer.number])
    }
}

impl Backend for KernelBackend {
    type Tokens = Rc<Rows>;
    type KeyValues = Rc<RowKeyValues>;
    type Seen = VisibleScenes;

    fn entries(&self, x: &Rc<Rows>) -> usize {
        x.shape()[0]
    }

    fn linear(&self, layer: Linear, x: &Rc<Rows>) -> Rc<Rows> {
        let [batch, pedestrians, _] = x.shape();
        let kernel = Arc::clone(&self.kernels.linears[layer.number]);
        let (y, x) = (kernel.forward(x), Rc::clone(x));
        let shape = [batch, pedestrians, layer.outputs];
        self.made(shape, y, move |gy, of_weights| {
            x.add_gradient(kernel.backward(&x, gy, &mut of_weights[layer.span()]));
        })
    }

    fn relu(&self, x: &Rc<Rows>) -> Rc<Rows> {
        let mut numbers = Buffer::any(x.len());
        for (y, x) in numbers.iter_mut().zip(x.iter()) {
            // NaN stays NaN.
            *y = if *x < 0.0 { 0.0 } else { *x };
        }
        let x = Rc::clone(x);
        self.made(x.shape(), numbers, move |gradient, _| {
            let mut of_x = Buffer::any(x.len());
            for ((of_x, x), gradient) in of_x.iter_mut().zip(x.iter()).zip(gradient) {
                *of_x = if *x <= 0.0 { 0.0 } else { *gradient };
            }
            x.add_gradient(of_x);
        })
    }

    fn concatenate(&self, x: &Rc<Rows>, other: &Rc<Rows>) -> Rc<Rows> {
        let (a, b) = (Rc::clone(x), Rc::clone(other));
        let [batch, pedestrians, width] = a.shape();
        let both = width + b.shape()[2];
        assert_eq!(b.shape()[..2], [batch, pedestrians], "rows to concatenate");
        let mut numbers = Buffer::any(batch * pedestrians * both);
        let rows = a.chunks_exact(width).zip(b.chunks_exact(both - width));
        for (row, (a, b)) in numbers.chunks_exact_mut(both).zip(rows) {
            row[..width].copy_from_slice(a);
            row[width..].copy_from_slice(b);
        }
        self.made([batch, pedestrians, both], numbers, move |gradient, _| {
            for (rows, columns) in [(&a, 0..width), (&b, width..both)] {
                let mut part = Buffer::any(rows.len());
                let parts = part.chunks_exact_mut(columns.len());
                for (part, gradient) in parts.zip(gradient.chunks_exact(both)) {
                    part.copy_from_slice(&gradient[columns.clone()]);
                }
                rows.add_gradient(part);
            }
        })
    }

    fn repeated(&self, x: &Rc<Rows>, batch: usize) -> Rc<Rows> {
        let x = Rc::clone(x);
        let [entries, pedestrians, width] = x.shape();
        if entries == batch {
            return x;
        }
        assert_eq!(entries, 1, "only a single batch entry can be repeated");
        let mut numbers = Buffer::any(batch * x.len());
        for entry in numbers.chunks_exact_mut(x.len()) {
            entry.copy_from_slice(&x);
        }
        self.made([batch, pedestrians, width], numbers, move |gradient, _| {
            for gradient in gradient.chunks_exact(x.len()) {
                x.add_gradient_at(0, gradient);
            }
        })
    }

    fn spatial_attention(&self, layer: EncoderLayer, x: &Rc<Rows>, seen: &VisibleScenes) -> Rc<Rows> {
        let (kernel, dropouts) = (self.encoder(layer), self.dropouts(layer));
        let frames = seen.scenes.during(seen.steps.clone());
        let (y, results) = kernel.spatial_attention(x, frames, dropouts, self.tape.is_some());
        let (x, seen) = (Rc::clone(x), seen.clone());
        self.made(x.shape(), y, move |gy, of_weights| {
            let of_weights = &mut of_weights[layer.span()];
            let frames = seen.scenes.during(seen.steps.clone());
            let gx = kernel.spatial_attention_backward(&x, frames, dropouts, &results, gy, of_weights);
            x.add_gradient(gx);
        })
    }

    fn temporal_attention(&self, layer: EncoderLayer, newest: &Rc<Rows>, cache: &[Rc<RowKeyValues>]) -> Rc<Rows> {
        let (kernel, dropouts) = (self.encoder(layer), self.dropouts(layer));
        let (y, results) = kernel.temporal_attention(newest, &rows(cache), dropouts, self.tape.is_some());
        let (x, cache) = (Rc::clone(newest), cache.to_vec());
        self.made(x.shape(), y, move |gy, of_weights| {
            let mut shares: Vec<_> = cache.iter().map(|token| token.gradient.take()).collect();
            let mut of_cache: Vec<&mut CachedKeyValues> =
                shares.iter_mut().map(|share| share.get_or_insert_with(|| CachedKeyValues::zeros(x.len()))).collect();
            x.add_gradient(kernel.temporal_attention_backward(
                &x,
                &rows(&cache),
                dropouts,
                &results,
                gy,
                &mut of_cache,
                &mut of_weights[layer.span()],
            ));
            for (token, share) in cache.iter().zip(shares) {
                token.gradient.replace(share);
            }
        })
    }

    fn remember(&self, layer: EncoderLayer, x: &Rc<Rows>, cache: &mut Vec<Rc<RowKeyValues>>) {
        let kernel = self.encoder(layer);
        let cached = Rc::new(RowKeyValues { rows: kernel.key_values(x), gradient: RefCell::new(None) });
        let (token, x) = (Rc::clone(&cached), Rc::clone(x));
        self.record_backward(move |of_weights| {
            if let Some(gradient) = token.gradient.take() {
                let of_weights = &mut of_weights[layer.span()];
                x.add_gradient(kernel.key_values_backward(&x, &gradient, of_weights));
            }
        });
        cache.push(cached);
    }

    fn repeat_key_values(&self, cached: &Rc<RowKeyValues>, _: usize) -> Rc<RowKeyValues> {
        // The kernels repeat a single batch entry themselves.
        Rc::clone(cached)
    }
}

fn rows(cache: &[Rc<RowKeyValues>]) -> Vec<&CachedKeyValues> {
    cache.iter().map(|token| &token.rows).collect()
}

#[cfg(all(test, feature = "training"))]
mod tests {
    use super::*;
    use crate::kernel::Sizes;

    fn layer(dropout: f64) -> (Arc<Kernels>, EncoderLayer) {
        let mut layout = Layout::default();
        let sizes = Sizes { width: 8, heads: 2, hidden: 3 };
        let layer = layout.encoder_layer("layer", sizes, dropout);
        let numbers = vec![0.0; layout.count()];
        (Arc::new(Kernels::new(&Arc::new(layout), &numbers)), layer)
    }

    #[test]
    fn the_four_dropouts_of_a_layer_have_distinct_seeds() {
        let pass = |seed, dropout, mode| {
            let (kernels, layer) = layer(dropout);
            let backend = KernelBackend::training(kernels, mode, seed);
            let dropouts = (0..25).flat_map(|_| {
                let drawn = backend.dropouts(layer);
                [drawn.weights, drawn.attended, drawn.hidden, drawn.fed]
            });
            dropouts.flatten().map(|dropout| dropout.seed).collect::<Vec<u64>>()
        };
        let mut drawn = pass(7, 0.1, Mode::Train);
        assert_eq!(drawn, pass(7, 0.1, Mode::Train));
        assert_ne!(drawn, pass(8, 0.1, Mode::Train));
        drawn.sort_unstable();
        drawn.dedup();
        assert_eq!(drawn.len(), 4 * 25);
        assert!(pass(7, 0.0, Mode::Train).is_empty());
        assert!(pass(7, 0.1, Mode::Evaluate).is_empty());
    }
}
