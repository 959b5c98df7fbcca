//! Attention in rows against attention as one matrix over all pedestrians.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use crate::model::Parameters;
use crate::model::neighbours::Neighbours;
use ddl_network::seed::{Stage, stream};
use ddl_network::weights::{Layout, Sizes};
use proptest::prelude::*;
use tch::{Device, Kind};

const HEADS: i64 = 2;
const WIDTH: i64 = 6;
const CPU: (Kind, Device) = (Kind::Double, Device::Cpu);

/// An encoder layer, whose first four tensors are those of its attention.
fn encoder_layer(seed: u64) -> (EncoderLayer, Parameters) {
    let sizes = Sizes {
        width: WIDTH as usize,
        heads: HEADS as usize,
        hidden: 1,
    };
    let mut layout = Layout::default();
    let layer = layout.encoder_layer("layer", sizes, 0.0);
    let initial = layout.initial(stream(seed, Stage::Weights, 0));
    let parameters = Parameters::new(layout, &initial, Device::Cpu, Kind::Double);
    (layer, parameters)
}

/// Who sees whom, frame by frame and scene by scene, from a seed: everybody itself, others by chance.
fn visible(sizes: &[usize], frames: usize, seed: i64) -> Vec<bool> {
    tch::manual_seed(seed);
    let mut visible = Vec::new();
    for _ in 0..frames {
        for &size in sizes {
            let chance: Vec<f64> =
                Vec::try_from(Tensor::rand([(size * size) as i64], CPU)).unwrap();
            let sees = |(pair, chance): (usize, f64)| chance < 0.6 || pair % (size + 1) == 0;
            visible.extend(chance.into_iter().enumerate().map(sees));
        }
    }
    visible
}

/// `[frames, 1, P, P]`, 0 where a pedestrian sees another or itself, -inf elsewhere.
fn dense_mask(sizes: &[usize], visible: &[bool], frames: usize) -> Tensor {
    let pedestrians: usize = sizes.iter().sum();
    let mut mask = vec![f64::NEG_INFINITY; frames * pedestrians * pedestrians];
    let mut visible = visible.iter();
    for frame in 0..frames {
        let mut first = 0;
        for &size in sizes {
            for i in first..first + size {
                for j in first..first + size {
                    if *visible.next().unwrap() {
                        mask[(frame * pedestrians + i) * pedestrians + j] = 0.0;
                    }
                }
            }
            first += size;
        }
    }
    let pedestrians = pedestrians as i64;
    Tensor::from_slice(&mask).reshape([frames as i64, 1, pedestrians, pedestrians])
}

/// Softmax(q k^T / sqrt(d) + mask) v over all pedestrians at once, as the paper has it.
fn dense(parameters: &Parameters, x: &Tensor, mask: &Tensor) -> Tensor {
    let tensors = parameters.tensors();
    let (batch, pedestrians) = (x.size()[0], x.size()[1]);
    let qkv = x
        .linear(&tensors[0], Some(&tensors[1]))
        .view([batch, pedestrians, 3, HEADS, WIDTH / HEADS])
        .permute([2, 0, 3, 1, 4]);
    let (query, key, value) = (qkv.get(0), qkv.get(1), qkv.get(2));
    let width = (WIDTH / HEADS) as f64;
    let scores = query.matmul(&key.transpose(-1, -2)) / width.sqrt() + mask;
    let mixed = scores.softmax(-1, Kind::Double).matmul(&value);
    let mixed = mixed.transpose(1, 2).reshape([batch, pedestrians, WIDTH]);
    mixed.linear(&tensors[2], Some(&tensors[3]))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Values and the gradients of input and weights, with dropout off, where each frame has neighbours of its
    /// own and where all share those of one.
    #[test]
    fn rows_give_what_one_matrix_over_all_pedestrians_gives(
        sizes in prop::collection::vec(1_usize..12, 1..7),
        entries in 1_usize..4,
        shared in any::<bool>(),
        seed in 0_i64..1000,
    ) {
        let frames = if shared { 1 } else { entries };
        let visible = visible(&sizes, frames, seed);
        let mask = dense_mask(&sizes, &visible, frames);
        let (layer, parameters) = encoder_layer(seed as u64);
        let backend = TorchBackend::new(&parameters, Mode::Evaluate);
        let pedestrians: usize = sizes.iter().sum();
        let shape = [entries as i64, pedestrians as i64, WIDTH];
        let x = Tensor::randn(shape, CPU).set_requires_grad(true);
        let weight = Tensor::randn(shape, CPU);

        let neighbours = Rc::new(Neighbours::new(&sizes, visible, Device::Cpu, Kind::Double));
        let seen = neighbours.during(0..frames);
        let ours = Attention::new(&backend, layer).among_pedestrians(&x, &seen);
        let known = dense(&parameters, &x, &mask);
        let inputs: Vec<&Tensor> =
            std::iter::once(&x).chain(&parameters.tensors()[..4]).collect();
        let gradients = |output: &Tensor| {
            let loss = (output * &weight).sum(Kind::Double);
            Tensor::run_backward(&[loss], &inputs, true, false)
        };
        let largest = |difference: Tensor| difference.abs().max().double_value(&[]);
        prop_assert!(largest(&ours - &known) < 1e-12);
        for (one, other) in gradients(&ours).iter().zip(gradients(&known)) {
            let size = largest(other.shallow_clone()).max(1.0);
            prop_assert!(largest(one - other) < 1e-12 * size);
        }
    }
}

/// A pedestrian alone sees itself: what it attends to is its own value, and rows filled up to eight are no NaN.
#[test]
fn a_pedestrian_alone_attends_to_itself() {
    let (layer, parameters) = encoder_layer(3);
    let backend = TorchBackend::new(&parameters, Mode::Train);
    let x = Tensor::randn([1, 1, WIDTH], CPU);
    let seen = Rc::new(Neighbours::new(&[1], vec![true], Device::Cpu, Kind::Double)).during(0..1);
    let ours = Attention::new(&backend, layer).among_pedestrians(&x, &seen);
    let tensors = parameters.tensors();
    let value = x.linear(
        &tensors[0].narrow(0, 2 * WIDTH, WIDTH),
        Some(&tensors[1].narrow(0, 2 * WIDTH, WIDTH)),
    );
    let known = value.linear(&tensors[2], Some(&tensors[3]));
    assert!((&ours - known).abs().max().double_value(&[]) < 1e-14);
    let gradient = backend
        .gradient(&ours.sum(Kind::Double), &parameters)
        .unwrap();
    assert_eq!(gradient.isfinite().all().int64_value(&[]), 1);
}
