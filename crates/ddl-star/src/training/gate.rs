//! Updates that stop at the first number that is none, without asking the device for it.

use tch::{Device, Kind, Tensor};

/// Open until it has seen a number that is not finite, then shut until it is reopened; decided on the device.
#[derive(Debug)]
pub(crate) struct FiniteGate {
    /// Scalar, 1 or 0.
    open: Tensor,
}

impl FiniteGate {
    pub(crate) fn new(device: Device, kind: Kind) -> Self {
        Self {
            open: Tensor::ones([], (kind, device)),
        }
    }

    /// Shuts it if any of the numbers is not finite.
    pub(crate) fn watch(&mut self, numbers: &Tensor) {
        let _guard = tch::no_grad_guard();
        // 0 x is 0 for every number and for nothing else.
        let finite = (numbers * 0.0).eq(0.0).all();
        self.open *= finite;
    }

    pub(crate) fn reopen(&mut self) {
        let _ = self.open.fill_(1.0);
    }

    /// 1 where it is open, 0 where it is shut; a scalar.
    pub(crate) fn open(&self) -> &Tensor {
        &self.open
    }

    /// Whether it is shut, a truth value on the device; a scalar.
    pub(crate) fn shut(&self) -> Tensor {
        self.open.eq(0.0)
    }
}
