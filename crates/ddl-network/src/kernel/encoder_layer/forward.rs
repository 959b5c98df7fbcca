//! The forward pass of a layer, a few rows at a time.

use crate::kernel::add_norm::{AddNorm, Decisions, Normal};
use crate::kernel::affine::Affine;
use crate::kernel::buffer::Buffer;
use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut};
use crate::kernel::dropout::Dropout;
use crate::kernel::encoder_layer::forward_results::{AttentionResults, ForwardResults, NormalisedRows};
use crate::kernel::encoder_layer::layer::{Dropouts, EncoderKernel};
use crate::kernel::threads::run_each;
use ddl_simd::{Simd, TiledKernel};

/// Rows that are computed together. The constant number makes sums over rows independent of the threads.
pub(super) const ROWS: usize = 256;

impl EncoderKernel {
    /// N projections of x, beginning with `first`: queries, keys and values, `[rows, width]` each.
    pub(super) fn project<const N: usize>(&self, first: usize, x: &[f32]) -> [Buffer; N] {
        let width = self.sizes.width;
        assert_eq!(x.len() % width, 0, "x is not made of rows of {width}");
        let projections = &self.projections[first..];
        let mut results = [0; N].map(|_| Buffer::any(x.len()));
        let mut rest = results.each_mut().map(|result| &mut result[..]);
        let jobs = x.chunks(ROWS * width).map(|x| Project {
            projections,
            width,
            x,
            targets: rest.each_mut().map(|rest| rest.split_off_mut(..x.len()).unwrap_or_default()),
        });
        run_each(self.dispatch, jobs, x.len() * width * N);
        results
    }

    /// Without `keep`, the result serves no backward pass.
    pub(super) fn after_attention(
        &self,
        x: &[f32],
        attention: AttentionResults,
        dropouts: Dropouts,
        keep: bool,
    ) -> (Buffer, ForwardResults) {
        let [mut z, mut fed, mut y] = [0; 3].map(|_| Buffer::any(x.len()));
        let mixed = &attention.attended.mixed;
        let (norm1, norm2) = (&self.norm1, &self.norm2);
        let normal1 = self.add_norm(norm1, Some(&self.out), [x, mixed], dropouts.attended, &mut z, keep);
        self.feed_forward.forward(&z, dropouts.hidden, &mut fed);
        let normal2 = self.add_norm(norm2, None, [&z, &fed], dropouts.fed, &mut y, keep);
        let forward_results = ForwardResults { attention, normal1, z, normal2 };
        (y, forward_results)
    }

    /// y = norm(x + d(t)), or with an affine map of t if there is one.
    fn add_norm(
        &self,
        norm: &AddNorm,
        map: Option<&Affine>,
        [x, t]: [&[f32]; 2],
        dropout: Option<Dropout>,
        y: &mut [f32],
        keep: bool,
    ) -> NormalisedRows {
        let width = self.sizes.width;
        let mut normal = NormalisedRows::default();
        if keep {
            normal.numbers = Buffer::any(x.len());
            normal.scales = Buffer::any(x.len() / width);
        }
        let decisions = dropout.and_then(Decisions::new);
        let inputs = x.chunks(ROWS * width).zip(t.chunks(ROWS * width));
        let mut numbers = normal.numbers.chunks_mut(ROWS * width);
        let mut scales = normal.scales.chunks_mut(ROWS);
        let jobs = inputs.zip(y.chunks_mut(ROWS * width)).enumerate();
        let jobs = jobs.map(|(i, ((x, t), y))| NormForward {
            norm,
            map,
            width,
            x,
            t,
            decisions: decisions.map(|decisions| (decisions, i * ROWS)),
            normal: Normal { numbers: numbers.next().unwrap_or_default(), scales: scales.next().unwrap_or_default() },
            y,
        });
        let work = x.len() * map.map_or(10, |_| width);
        run_each(self.dispatch, jobs, work);
        normal
    }
}

struct Project<'a, const N: usize> {
    projections: &'a [Affine],
    width: usize,
    x: &'a [f32],
    targets: [&'a mut [f32]; N],
}

impl<const N: usize> TiledKernel for Project<'_, N> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) {
        let x = MatrixColumns::whole(self.x, self.width);
        for (projection, target) in self.projections.iter().zip(self.targets) {
            projection.forward::<S, R, V>(simd, x, &mut MatrixColumnsMut::whole(target, self.width));
        }
    }
}

struct NormForward<'a> {
    norm: &'a AddNorm,
    map: Option<&'a Affine>,
    width: usize,
    x: &'a [f32],
    t: &'a [f32],
    decisions: Option<(Decisions, usize)>,
    normal: Normal<'a>,
    y: &'a mut [f32],
}

impl TiledKernel for NormForward<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(mut self, simd: S) {
        let mut mapped = Buffer::default();
        let t = match self.map {
            Some(map) => {
                mapped = Buffer::any(self.t.len());
                let t = MatrixColumns::whole(self.t, self.width);
                let mut into = MatrixColumnsMut::whole(&mut mapped, self.width);
                map.forward::<S, R, V>(simd, t, &mut into);
                &mapped
            }
            None => self.t,
        };
        self.norm.forward(simd, [self.x, t], self.decisions, &mut self.normal, self.y);
        drop(mapped);
    }
}
