//! Properties of any layer. `ddl-star` compares it with the layer of libtorch.

use crate::kernel::buffer::Buffer;
use crate::kernel::dropout::Dropout;
use crate::kernel::encoder_layer::{CachedKeyValues, Dropouts, EncoderKernel, Sizes};
use crate::kernel::scenes::Scenes;
use crate::kernel::tests::numbers::{SeededNumbers, bits, lists};
use ddl_simd::{Dispatch, InstructionSet};
use rayon::ThreadPoolBuilder;

fn star(hidden: usize) -> Sizes {
    Sizes { width: 32, heads: 8, hidden }
}

struct LayerCase {
    sizes: Sizes,
    scenes: Scenes,
    weights: Vec<f32>,
    x: Vec<f32>,
    gy: Vec<f32>,
    cache: Vec<[Vec<f32>; 2]>,
    dropouts: Dropouts,
}

/// Output, and gradients of the input, of the weights and of the cache.
type LayerResults = [Vec<f32>; 4];

impl LayerCase {
    fn new(seed: u64, sizes: Sizes, scenes: &[usize], p: f64) -> Self {
        let mut numbers = SeededNumbers::seeded(seed);
        let visible = numbers.visible(scenes, 1);
        let scenes = Scenes::new(scenes, lists(scenes, &visible));
        let count = 2 * scenes.pedestrians() * sizes.width;
        let dropout = |seed| Some(Dropout { p, seed });
        Self {
            sizes,
            scenes,
            weights: numbers.even(sizes.count(), 0.4),
            x: numbers.even(count, 1.0),
            gy: numbers.even(count, 1.0),
            cache: (0..3).map(|_| [0; 2].map(|_| numbers.even(count, 1.0))).collect(),
            dropouts: Dropouts {
                weights: dropout(seed),
                attended: dropout(seed ^ 1),
                hidden: dropout(seed ^ 2),
                fed: dropout(seed ^ 3),
            },
        }
    }

    fn layer(&self, set: InstructionSet) -> EncoderKernel {
        let mut layer = EncoderKernel::zeros(self.sizes);
        layer.dispatch = Dispatch::new(set).unwrap();
        (layer.feed_forward.dispatch, layer.attention.dispatch) = (layer.dispatch, layer.dispatch);
        layer.update(&self.weights);
        layer
    }

    fn spatial(&self, layer: &EncoderKernel) -> LayerResults {
        let frames = self.scenes.throughout();
        let (y, forward_results) = layer.spatial_attention(&self.x, frames, self.dropouts, true);
        let (alone, _) = layer.spatial_attention(&self.x, frames, self.dropouts, false);
        assert_eq!(*alone, *y);
        let mut of_weights = vec![0.0; self.weights.len()];
        let gx = layer.spatial_attention_backward(
            &self.x,
            frames,
            self.dropouts,
            &forward_results,
            &self.gy,
            &mut of_weights,
        );
        [y.to_vec(), gx.to_vec(), of_weights, Vec::new()]
    }

    /// The keys and values of x are also a token of the cache.
    fn temporal(&self, layer: &EncoderKernel) -> LayerResults {
        let mut cache = vec![layer.key_values(&self.x)];
        cache.extend(
            self.cache
                .iter()
                .map(|[key, value]| CachedKeyValues { key: Buffer::copy(key), value: Buffer::copy(value) }),
        );
        let cache: Vec<&CachedKeyValues> = cache.iter().collect();
        let (y, forward_results) = layer.temporal_attention(&self.x, &cache, self.dropouts, true);
        let (alone, _) = layer.temporal_attention(&self.x, &cache, self.dropouts, false);
        assert_eq!(*alone, *y);
        let mut of_weights = vec![0.0; self.weights.len()];
        let mut of_cache: Vec<_> = cache.iter().map(|_| CachedKeyValues::zeros(self.x.len())).collect();
        let gx = layer.temporal_attention_backward(
            &self.x,
            &cache,
            self.dropouts,
            &forward_results,
            &self.gy,
            &mut of_cache.iter_mut().collect::<Vec<_>>(),
            &mut of_weights,
        );
        let through = layer.key_values_backward(&self.x, &of_cache[0], &mut of_weights);
        let gx = gx.iter().zip(through.iter()).map(|(a, b)| a + b).collect();
        let given = of_cache[1..].iter();
        let of_cache = given.flat_map(|token| [&token.key[..], &token.value]).flatten();
        [y.to_vec(), gx, of_weights, of_cache.copied().collect()]
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let case = LayerCase::new(5, star(100), &[160, 3, 200, 1, 200], 0.1);
    for set in InstructionSet::available() {
        let layer = case.layer(set);
        let [first, others @ ..] = [1, 2, 3, 7].map(|threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            let run = || [case.spatial(&layer), case.temporal(&layer)];
            pool.unwrap().install(run).map(|results| results.map(|numbers| bits(&numbers)))
        });
        assert!(others.iter().all(|other| *other == first), "{set:?}");
    }
}

#[test]
fn gradients_are_slopes() {
    let scenes = [4, 1, 6];
    let moved = |numbers: &[f32], direction: &[f32], by: f64| -> Vec<f32> {
        numbers.iter().zip(direction).map(|(n, d)| (f64::from(*n) + by * f64::from(*d)) as f32).collect()
    };
    let times = |numbers: &[f32], factor: f32| -> Vec<f32> { numbers.iter().map(|number| number * factor).collect() };
    let dot = |a: &[f32], b: &[f32]| -> f64 { a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum() };
    for (over, p) in [(false, 0.0), (false, 0.2), (true, 0.0), (true, 0.2)] {
        let case = LayerCase::new(11, star(64), &scenes, p);
        let run = |case: &LayerCase| {
            let layer = case.layer(Dispatch::detect().instruction_set());
            if over { case.temporal(&layer) } else { case.spatial(&layer) }
        };
        let [_, gx, of_weights, _] = run(&case);
        for (of_x, of_weights_too) in [(1.0, 0.0), (0.0, 1.0)] {
            let (gx, of_weights) = (times(&gx, of_x), times(&of_weights, of_weights_too));
            let square = dot(&gx, &gx) + dot(&of_weights, &of_weights);
            let loss = |by: f64| {
                let case = LayerCase {
                    x: moved(&case.x, &gx, by),
                    weights: moved(&case.weights, &of_weights, by),
                    ..LayerCase::new(11, star(64), &scenes, p)
                };
                dot(&run(&case)[0], &case.gy)
            };
            // The scale makes the norm of the whole change equal to the step.
            let step = 0.005 / square.sqrt();
            let quotient = (loss(step) - loss(-step)) / (2.0 * step);
            let error = (quotient / square - 1.0).abs();
            assert!(error < 0.02);
        }
    }
}
