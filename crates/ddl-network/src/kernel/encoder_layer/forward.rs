//! The forward pass of a layer, a few rows at a time.

use super::forward_results::{AttentionResults, ForwardResults, NormalisedRows};
use super::layer::{Dropouts, EncoderKernel};
use crate::kernel::add_norm::{AddNorm, Decisions, Normal};
use crate::kernel::affine::Affine;
use crate::kernel::buffer::Buffer;
use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut};
use crate::kernel::dropout::Dropout;
use crate::kernel::threads::run_each;
use ddl_simd::{Simd, TiledKernel};

/// Rows that are computed together. The constant number makes sums over rows independent of the threads.
pub(super) const ROWS: usize = 256;

pub(super) enum Targets<'a> {
    /// Concatenated in every row.
    Together(&'a mut [f32]),
    /// Separate matrices.
    Apart(Vec<&'a mut [f32]>),
}

impl<'a> Targets<'a> {
    /// Splits off the first rows, `numbers` numbers of each matrix.
    fn split_off(&mut self, projections: usize, numbers: usize) -> Targets<'a> {
        match self {
            Self::Together(matrix) => {
                let count = matrix.len().min(projections * numbers);
                Targets::Together(matrix.split_off_mut(..count).unwrap_or_default())
            }
            Self::Apart(matrices) => {
                let parts = matrices.iter_mut().map(|part| {
                    let count = part.len().min(numbers);
                    part.split_off_mut(..count).unwrap_or_default()
                });
                Targets::Apart(parts.collect())
            }
        }
    }

    #[inline(always)]
    fn columns(&mut self, index: usize, projections: usize, width: usize) -> MatrixColumnsMut<'_> {
        match self {
            Self::Together(matrix) => MatrixColumnsMut::part(matrix, projections * width, index * width, width),
            Self::Apart(matrices) => MatrixColumnsMut::whole(matrices[index], width),
        }
    }
}

impl EncoderKernel {
    /// Computes queries, keys and values, beginning with projection `first`.
    pub(super) fn project(&self, first: usize, x: &[f32], mut targets: Targets<'_>) {
        let width = self.sizes.width;
        assert_eq!(x.len() % width, 0, "x is not made of rows of {width}");
        let projections = &self.projections[first..];
        let jobs = x.chunks(ROWS * width).map(|x| Project {
            projections,
            width,
            x,
            targets: targets.split_off(projections.len(), x.len()),
        });
        let work = x.len() * width * projections.len();
        run_each(self.dispatch, jobs, work);
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
        let mixed = attention.mixed();
        let (norm1, norm2) = (&self.norm1, &self.norm2);
        let normal1 = self.add_norm(norm1, Some(&self.out), [x, mixed], dropouts.attended, &mut z, keep);
        self.feed_forward.forward(&z, dropouts.hidden, &mut fed);
        let normal2 = self.add_norm(norm2, None, [&z, &fed], dropouts.fed, &mut y, keep);
        let forward_results = ForwardResults {
            attention,
            normal1,
            z,
            normal2,
        };
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
            normal: Normal {
                numbers: numbers.next().unwrap_or_default(),
                scales: scales.next().unwrap_or_default(),
            },
            y,
        });
        let work = x.len() * map.map_or(10, |_| width);
        run_each(self.dispatch, jobs, work);
        normal
    }
}

struct Project<'a> {
    projections: &'a [Affine],
    width: usize,
    x: &'a [f32],
    targets: Targets<'a>,
}

impl TiledKernel for Project<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(mut self, simd: S) {
        let x = MatrixColumns::whole(self.x, self.width);
        let count = self.projections.len();
        for (i, projection) in self.projections.iter().enumerate() {
            let mut target = self.targets.columns(i, count, self.width);
            projection.forward::<S, R, V>(simd, x, &mut target);
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
        self.norm
            .forward(simd, [self.x, t], self.decisions, &mut self.normal, self.y);
        drop(mapped);
    }
}
