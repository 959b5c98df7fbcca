//! One run through the network: whether dropout is on, who computes, and how gradients come back.

use std::cell::Cell;
use std::ops::Range;
use std::rc::Rc;

use tch::{Kind, TchError, Tensor};

use crate::kernel::{Buffer, Dropout};
use crate::layers::Mode;
use crate::numbers::numbers;
use crate::parameters::Parameters;
use crate::tape::Tape;
use crate::tokens::Rows;

/// What a forward pass carries along.
#[derive(Debug)]
pub(crate) struct Pass {
    mode: Mode,
    /// Seed of the next dropout.
    seed: Cell<u64>,
    /// For the kernels; `None` where libtorch computes all.
    weights: Option<Weights>,
    tape: Option<Tape>,
}

/// The learned numbers, as they are in a pass.
#[derive(Debug)]
pub(crate) struct Weights {
    flat: Tensor,
    /// See [`Parameters::version`].
    pub(crate) version: i64,
}

impl Weights {
    pub(crate) fn numbers(&self, span: Range<usize>) -> Buffer {
        let (first, count) = (span.start as i64, span.len() as i64);
        numbers(&self.flat.narrow(0, first, count))
    }
}

impl Pass {
    /// A pass of libtorch alone, on any device, in any precision; gradients are its own.
    pub(crate) fn plain(mode: Mode) -> Self {
        Self {
            mode,
            seed: Cell::new(0),
            weights: None,
            tape: None,
        }
    }

    /// A pass without gradients, by kernels of our own where they can: on the CPU, in `f32`.
    pub(crate) fn forward_only(mode: Mode, parameters: &Parameters) -> Self {
        let flat = parameters.flat();
        let kernels = flat.kind() == Kind::Float && flat.device() == tch::Device::Cpu;
        Self {
            weights: kernels.then(|| Weights {
                flat: flat.shallow_clone(),
                version: parameters.version(),
            }),
            ..Self::plain(mode)
        }
    }

    /// A pass of training, by kernels where they can: dropout by this seed, gradients by [`gradient`](Self::gradient).
    pub(crate) fn training(mode: Mode, seed: u64, parameters: &Parameters) -> Self {
        let pass = Self::forward_only(mode, parameters);
        Self {
            seed: Cell::new(seed),
            tape: pass.weights.is_some().then(Tape::default),
            ..pass
        }
    }

    pub(crate) fn mode(&self) -> Mode {
        self.mode
    }

    /// Whether kernels of our own compute.
    pub(crate) fn has_kernels(&self) -> bool {
        self.weights.is_some()
    }

    /// # Panics
    /// When no kernels compute.
    pub(crate) fn weights(&self) -> &Weights {
        self.weights.as_ref().expect("a pass with kernels")
    }

    /// What a kernel has computed; `backward` gets the gradient of it, and adds to those of the kernel's inputs and
    /// of all learned numbers.
    pub(crate) fn made(
        &self,
        shape: [usize; 3],
        numbers: Buffer,
        backward: impl FnOnce(&[f32], &mut [f32]) + 'static,
    ) -> Rc<Rows> {
        let rows = Rc::new(Rows::new(shape, numbers));
        let output = Rc::clone(&rows);
        self.on_the_way_back(move |of_weights| {
            // Otherwise nothing of the loss depends on it.
            if let Some(gradient) = output.take_gradient() {
                backward(&gradient, of_weights);
            }
        });
        rows
    }

    /// Runs `step` when the gradients of all that comes later are known.
    pub(crate) fn on_the_way_back(&self, step: impl FnOnce(&mut [f32]) + 'static) {
        if let Some(tape) = &self.tape {
            tape.push(step);
        }
    }

    /// Whether gradients will be asked for.
    pub(crate) fn is_taped(&self) -> bool {
        self.tape.is_some()
    }

    /// The dropout of a kernel with probability `p`, each with a seed of its own; none outside training.
    pub(crate) fn dropout(&self, p: f64) -> Option<Dropout> {
        if self.mode == Mode::Evaluate || p == 0.0 {
            return None;
        }
        let seed = self.seed.get();
        // An odd constant goes through all numbers before one comes back.
        self.seed.set(seed.wrapping_add(0x9e37_79b9_7f4a_7c15));
        Some(Dropout { p, seed })
    }

    /// The gradient of `loss` with respect to all learned numbers, as one vector.
    pub(crate) fn gradient(
        &self,
        loss: &Tensor,
        parameters: &Parameters,
    ) -> Result<Tensor, TchError> {
        let Some(tape) = &self.tape else {
            return parameters.gradient_of(loss);
        };
        parameters.zero_gradients();
        loss.f_backward()?;
        let mut sums = vec![0.0; parameters.count()];
        tape.backward(&mut sums);
        parameters.add_gradients(&mut sums)?;
        Tensor::f_from_slice(&sums)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use crate::batch::SceneBatch;
    use crate::config::{StarConfig, Variant};
    use crate::device::{ComputeDevice, DeviceChoice};
    use crate::loss::mean_squared_distance;
    use crate::star::{NoiseInput, StarNetwork};
    use ddl_data::{Dataset, WINDOW, Window, WindowRule};

    /// Windows of very different numbers of walkers, a lone one among them, or that one alone.
    fn batches(kind: Kind) -> Vec<SceneBatch> {
        let dataset = Dataset::simulated(1);
        let windows = dataset.recordings()[0].windows(WindowRule::Complete);
        let some: Vec<&Window> = windows.iter().step_by(9).take(4).collect();
        let alone = Window::new(
            "alone",
            0,
            10,
            windows[0].pedestrians()[..1].to_vec(),
            vec![windows[0].track(0).to_vec()],
        )
        .unwrap();
        let many = some.iter().copied().chain([&alone]).collect();
        let batch = |windows: &Vec<&Window>| {
            SceneBatch::new(windows, WINDOW, WINDOW - 1, 2.0, tch::Device::Cpu, kind).unwrap()
        };
        [some, many, vec![&alone]].iter().map(batch).collect()
    }

    /// Loss and gradient of a whole teacher-forced pass: through kernels and tape as libtorch alone has them in
    /// double precision.
    #[test]
    fn kernels_and_tape_give_the_gradients_of_libtorch() {
        let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
        for (variant, scenes) in Variant::ALL
            .into_iter()
            .flat_map(|variant| [(variant, 0), (variant, 1), (variant, 2)])
        {
            let config = StarConfig {
                feed_forward_width: 96,
                ..StarConfig::published(variant)
            };
            let gradient = |kind: Kind| {
                let network = StarNetwork::with_precision(config.clone(), 3, cpu, kind).unwrap();
                let pass = Pass::training(Mode::Evaluate, 0, network.parameters());
                assert_eq!(pass.has_kernels(), kind == Kind::Float);
                let batch = &batches(kind)[scenes];
                let noise =
                    NoiseInput::Draws(Tensor::ones([1, 16], (kind, tch::Device::Cpu)) * 0.3);
                let goals = batch.positions().get(WINDOW as i64 - 1);
                let forecast = network.teacher_forced_in(batch, &goals, &noise, &pass);
                let truth = batch.positions().narrow(0, 1, WINDOW as i64 - 1);
                let loss = mean_squared_distance(&forecast, &truth);
                let gradient = pass.gradient(&loss, network.parameters()).unwrap();
                (loss.double_value(&[]), gradient.to_kind(Kind::Double))
            };
            let (loss, ours) = gradient(Kind::Float);
            let (known_loss, known) = gradient(Kind::Double);
            assert!(
                (loss / known_loss - 1.0).abs() < 1e-5,
                "{variant}: {loss} {known_loss}"
            );
            let difference = (&ours - &known).norm().double_value(&[]);
            let size = known.norm().double_value(&[]);
            assert!(
                difference < 1e-4 * size,
                "{variant}: {difference} of {size}"
            );
        }
    }

    #[test]
    fn every_dropout_has_a_seed_of_its_own() {
        let config = StarConfig::published(Variant::Full);
        let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
        let network = StarNetwork::new(config, 1, cpu).unwrap();
        let pass = Pass::training(Mode::Train, 7, network.parameters());
        let seeds: Vec<u64> = (0..100)
            .filter_map(|_| pass.dropout(0.1))
            .map(|dropout| dropout.seed)
            .collect();
        let mut distinct = seeds.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!((seeds.len(), distinct.len()), (100, 100));
        assert!(pass.dropout(0.0).is_none());
        assert!(Pass::plain(Mode::Evaluate).dropout(0.1).is_none());
    }
}
