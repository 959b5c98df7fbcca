//! The backward pass of a layer, a few rows at a time. Each piece of rows has separate sums for the gradients of the
//! weights, which are then added in the order of the rows.

use crate::kernel::add_norm::{AddNorm, Decisions};
use crate::kernel::affine::Affine;
use crate::kernel::buffer::{Buffer, add_to};
use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut};
use crate::kernel::dropout::Dropout;
use crate::kernel::encoder_layer::forward::ROWS;
use crate::kernel::encoder_layer::forward_results::{ForwardResults, NormalisedRows};
use crate::kernel::encoder_layer::layer::{Dropouts, EncoderKernel};
use crate::kernel::feed_forward::LayerGradients;
use crate::kernel::threads::run_each;
use ddl_simd::{Simd, TiledKernel};

impl EncoderKernel {
    /// The backward pass of the part after attention: the gradient of x so far, and that of the mixed values.
    pub(super) fn before_attention(
        &self,
        forward_results: &ForwardResults,
        dropouts: Dropouts,
        gy: &[f32],
        of_weights: &mut [f32],
    ) -> (Buffer, Buffer) {
        assert_eq!(forward_results.normal2.numbers.len(), gy.len(), "numbers kept for the backward pass");
        let [_, _, wo, bo, w1, b1, w2, b2, n1, c1, n2, c2] = self.sizes.pieces_mut(of_weights);
        let count = gy.len();
        let [mut of_z, mut of_fed, mut through] = [0; 3].map(|_| Buffer::any(count));
        let second = Sublayer { norm: &self.norm2, map: None, normal: &forward_results.normal2, dropout: dropouts.fed };
        self.sublayer_backward(&second, gy, [&mut of_z, &mut of_fed], [n2, c2, &mut [], &mut []]);
        let mut grads = LayerGradients { w1, b1, w2, b2 };
        self.feed_forward.backward(&forward_results.z, &of_fed, dropouts.hidden, &mut through, &mut grads);
        add_to(&mut of_z, &through);
        // The buffers are reused; their contents are no longer needed.
        let (mut gx, mut of_mixed) = (through, of_fed);
        let first = Sublayer {
            norm: &self.norm1,
            map: Some((&self.out, &forward_results.attention.attended.mixed)),
            normal: &forward_results.normal1,
            dropout: dropouts.attended,
        };
        self.sublayer_backward(&first, &of_z, [&mut gx, &mut of_mixed], [n1, c1, wo, bo]);
        (gx, of_mixed)
    }

    /// The gradients of x and t of a [`Sublayer`]. Those of its weights are added to sums.
    fn sublayer_backward(
        &self,
        layer: &Sublayer<'_>,
        gy: &[f32],
        [of_x, of_t]: [&mut [f32]; 2],
        of_weights: [&mut [f32]; 4],
    ) {
        let width = self.sizes.width;
        let (piece, count) = (ROWS * width, of_weights.iter().map(|part| part.len()).sum());
        let decisions = layer.dropout.and_then(Decisions::new);
        let inputs = layer.normal.numbers.chunks(piece).zip(layer.normal.scales.chunks(ROWS)).zip(gy.chunks(piece));
        let outputs = of_x.chunks_mut(piece).zip(of_t.chunks_mut(piece));
        let mut sums = Buffer::many_zeros(gy.len().div_ceil(piece), count);
        let jobs = inputs.zip(outputs).zip(&mut sums).enumerate();
        let jobs = jobs.map(|(i, (((normal, gy), (of_x, of_t)), sums))| NormBackward {
            norm: layer.norm,
            map: layer.map.map(|(map, t)| (map, &t[i * piece..][..gy.len()])),
            width,
            normal: [normal.0, normal.1],
            gy,
            decisions: decisions.map(|decisions| (decisions, i * ROWS)),
            of_x,
            of_t,
            sums,
        });
        let work = gy.len() * layer.map.map_or(20, |_| 2 * width);
        run_each(self.dispatch, jobs, work);
        add_up(&sums, of_weights);
    }

    /// Adds the gradient of x through the projections from `first` on, and the gradients of their weights.
    /// `gradients` `[rows, width]` of each projection.
    pub(super) fn project_backward<const N: usize>(
        &self,
        first: usize,
        x: &[f32],
        gradients: [&[f32]; N],
        gx: &mut [f32],
        of_weights: &mut [f32],
    ) {
        let width = self.sizes.width;
        let [weight, bias, ..] = self.sizes.pieces_mut(of_weights);
        let (weight, bias) = (&mut weight[first * width * width..], &mut bias[first * width..]);
        let count = weight.len() + bias.len();
        let mut sums = Buffer::many_zeros(x.len().div_ceil(ROWS * width), count);
        let jobs = x.chunks(ROWS * width).zip(gx.chunks_mut(ROWS * width)).zip(&mut sums).enumerate();
        let jobs = jobs.map(|(i, ((x, gx), sums))| ProjectBackward {
            projections: &self.projections[first..],
            gradients: gradients.map(|gradient| &gradient[i * ROWS * width..][..x.len()]),
            width,
            x,
            gx,
            sums,
        });
        let work = 2 * x.len() * count / width;
        run_each(self.dispatch, jobs, work);
        add_up(&sums, [weight, bias]);
    }
}

fn add_up<const N: usize>(sums: &[Buffer], mut into: [&mut [f32]; N]) {
    for sums in sums {
        let mut terms = sums.iter();
        for into in &mut into {
            for (sum, term) in into.iter_mut().zip(terms.by_ref()) {
                *sum += term;
            }
        }
    }
}

/// y = norm(x + d(t)), where t can be the output of an affine map.
struct Sublayer<'a> {
    norm: &'a AddNorm,
    map: Option<(&'a Affine, &'a [f32])>,
    normal: &'a NormalisedRows,
    dropout: Option<Dropout>,
}

struct NormBackward<'a> {
    norm: &'a AddNorm,
    map: Option<(&'a Affine, &'a [f32])>,
    width: usize,
    normal: [&'a [f32]; 2],
    gy: &'a [f32],
    decisions: Option<(Decisions, usize)>,
    of_x: &'a mut [f32],
    of_t: &'a mut [f32],
    /// Gradients of weight and bias of the normalisation, and of the affine map.
    sums: &'a mut [f32],
}

impl TiledKernel for NormBackward<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) {
        let (norm, normal, width, gy, decisions) = (self.norm, self.normal, self.width, self.gy, self.decisions);
        let (of_norm, of_map) = self.sums.split_at_mut(2 * width);
        let of_norm: [&mut [f32]; 2] = of_norm.split_at_mut(width).into();
        let Some((map, t)) = self.map else {
            norm.backward(simd, normal, gy, decisions, [self.of_x, self.of_t], of_norm);
            return;
        };
        let mut of_mapped = Buffer::any(self.of_t.len());
        norm.backward(simd, normal, gy, decisions, [self.of_x, &mut of_mapped], of_norm);
        let of_mapped = MatrixColumns::whole(&of_mapped, width);
        let mut of_t = MatrixColumnsMut::whole(self.of_t, width);
        map.backward::<S, R, V>(simd, of_mapped, &mut of_t, false);
        let of_map = of_map.split_at_mut(width * width).into();
        map.add_gradients::<S, R, V>(simd, MatrixColumns::whole(t, width), of_mapped, of_map);
    }
}

struct ProjectBackward<'a, const N: usize> {
    projections: &'a [Affine],
    gradients: [&'a [f32]; N],
    width: usize,
    x: &'a [f32],
    gx: &'a mut [f32],
    /// Gradients of all matrices, then of all biases.
    sums: &'a mut [f32],
}

impl<const N: usize> TiledKernel for ProjectBackward<'_, N> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) {
        let width = self.width;
        let x = MatrixColumns::whole(self.x, width);
        let mut gx = MatrixColumnsMut::whole(self.gx, width);
        let (weights, biases) = self.sums.split_at_mut(N * width * width);
        let of_weights = weights.chunks_exact_mut(width * width).zip(biases.chunks_exact_mut(width));
        let parts = self.projections.iter().zip(self.gradients);
        for ((projection, gy), (weight, bias)) in parts.zip(of_weights) {
            let gy = MatrixColumns::whole(gy, width);
            projection.backward::<S, R, V>(simd, gy, &mut gx, true);
            projection.add_gradients::<S, R, V>(simd, x, gy, [weight, bias]);
        }
    }
}
