//! One run through the network: whether dropout is on, and how gradients come back.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;

use tch::{Kind, TchError, Tensor};

use crate::kernel::{Dropout, FeedForward, Gradients};
use crate::layers::Mode;
use crate::parameters::Parameters;
use crate::precision::Precision;
use crate::tape::Tape;

/// What a forward pass carries along.
///
/// Kernels of our own stand in for libtorch where they can: on the CPU, in `f32`, where nobody asks for a
/// gradient or the pass has a tape to bring it back.
#[derive(Debug)]
pub(crate) struct Pass {
    mode: Mode,
    precision: Precision,
    /// Seed of the next dropout.
    seed: Cell<u64>,
    tape: Option<Tape>,
    /// Weights as the kernels want them, by the name of their layer.
    packed: RefCell<BTreeMap<String, Rc<FeedForward>>>,
    /// Gradients of those weights, which libtorch does not see.
    gradients: Rc<RefCell<BTreeMap<String, Gradients>>>,
}

impl Pass {
    /// A pass whose gradients, if any, are libtorch's.
    pub(crate) fn plain(mode: Mode) -> Self {
        Self {
            mode,
            precision: Precision::F32,
            seed: Cell::new(0),
            tape: None,
            packed: RefCell::default(),
            gradients: Rc::default(),
        }
    }

    /// A pass of training: dropout by this seed, gradients by [`gradient`](Self::gradient).
    pub(crate) fn taped(mode: Mode, seed: u64) -> Self {
        Self {
            seed: Cell::new(seed),
            tape: Some(Tape::default()),
            ..Self::plain(mode)
        }
    }

    /// The same, whose kernels have that precision.
    pub(crate) fn in_precision(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }

    pub(crate) fn precision(&self) -> Precision {
        self.precision
    }

    pub(crate) fn mode(&self) -> Mode {
        self.mode
    }

    /// Whether kernels may compute what follows `x`.
    pub(crate) fn kernels_may_take(&self, x: &Tensor) -> bool {
        x.kind() == Kind::Float
            && x.device() == tch::Device::Cpu
            && (self.tape.is_some() || !x.requires_grad())
    }

    /// `x`, from which several later stretches of the network go on. Backwards, each stretch is gone through
    /// once, and what comes back to `x` is added up before it goes on. Where no kernel cuts the graph it stays
    /// whole.
    pub(crate) fn junction(&self, x: &Tensor) -> Tensor {
        match &self.tape {
            Some(tape) if self.kernels_may_take(x) && x.requires_grad() && !x.is_leaf() => tape
                .cut(&[x], &x.detach(), |gradient| {
                    Ok(vec![gradient.shallow_clone()])
                }),
            _ => x.shallow_clone(),
        }
    }

    /// `output`, which a kernel has made of `inputs`; `backward` gives the gradients of these.
    pub(crate) fn made_of(
        &self,
        inputs: &[&Tensor],
        output: Tensor,
        backward: impl FnOnce(&Tensor) -> Result<Vec<Tensor>, TchError> + 'static,
    ) -> Tensor {
        match &self.tape {
            Some(tape) => tape.cut(inputs, &output, backward),
            None => output,
        }
    }

    /// Ends the graph at `x`, from which kernels go on in ways of their own; `gradient` gives what came back to it
    /// from all of them, if anything did.
    pub(crate) fn joined(&self, x: &Tensor, gradient: impl FnOnce() -> Option<Tensor> + 'static) {
        if let Some(tape) = &self.tape {
            tape.end(x, gradient);
        }
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

    /// The packed weights of a layer, made at its first use in this pass.
    pub(crate) fn packed(
        &self,
        layer: &str,
        pack: impl FnOnce() -> FeedForward,
    ) -> Rc<FeedForward> {
        let mut packed = self.packed.borrow_mut();
        let entry = packed.entry(layer.to_owned());
        Rc::clone(entry.or_insert_with(|| Rc::new(pack())))
    }

    /// Where kernels add up the gradients of their weights.
    pub(crate) fn weight_gradients(&self) -> Rc<RefCell<BTreeMap<String, Gradients>>> {
        Rc::clone(&self.gradients)
    }

    /// The gradient of `loss` with respect to all learned numbers, as one vector.
    pub(crate) fn gradient(
        &self,
        loss: &Tensor,
        parameters: &Parameters,
    ) -> Result<Tensor, TchError> {
        parameters.zero_gradients();
        match &self.tape {
            Some(tape) => tape.backward(loss)?,
            None => loss.f_backward()?,
        }
        parameters.flat_gradient(&self.gradients.borrow())
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

    fn batch(kind: Kind) -> SceneBatch {
        let dataset = Dataset::simulated(1);
        let windows = dataset.recordings()[0].windows(WindowRule::Complete);
        let some: Vec<&Window> = windows.iter().step_by(9).take(4).collect();
        SceneBatch::new(&some, WINDOW, WINDOW - 1, 2.0, tch::Device::Cpu, kind).unwrap()
    }

    /// Loss and gradient of a whole teacher-forced pass: through kernels and tape as libtorch alone has them in
    /// double precision.
    #[test]
    fn kernels_and_tape_give_the_gradients_of_libtorch() {
        let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
        for variant in Variant::ALL {
            let config = StarConfig {
                feed_forward_width: 96,
                ..StarConfig::published(variant)
            };
            let gradient = |kind: Kind, pass: &Pass| {
                let network = StarNetwork::with_precision(config.clone(), 3, cpu, kind).unwrap();
                let batch = batch(kind);
                let noise =
                    NoiseInput::Draws(Tensor::ones([1, 16], (kind, tch::Device::Cpu)) * 0.3);
                let goals = batch.positions().get(WINDOW as i64 - 1);
                let forecast = network.teacher_forced_in(&batch, &goals, &noise, pass);
                let truth = batch.positions().narrow(0, 1, WINDOW as i64 - 1);
                let loss = mean_squared_distance(&forecast, &truth);
                let gradient = pass.gradient(&loss, network.parameters()).unwrap();
                (loss.double_value(&[]), gradient.to_kind(Kind::Double))
            };
            let taped = Pass::taped(Mode::Evaluate, 0);
            let (loss, ours) = gradient(Kind::Float, &taped);
            assert!(!taped.packed.borrow().is_empty(), "no kernel was used");
            let (known_loss, known) = gradient(Kind::Double, &Pass::plain(Mode::Evaluate));
            assert!(
                (loss / known_loss - 1.0).abs() < 1e-5,
                "{loss} {known_loss}"
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
        let pass = Pass::taped(Mode::Train, 7);
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
