//! A gate that stops updates at the first value that is not finite, without waiting for the device.

use tch::{Device, Kind, Tensor};

/// It is open until it sees a value that is not finite, then shut until it is reopened. It is evaluated on the device.
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

    /// Shuts the gate if a value is not finite.
    pub(crate) fn watch(&mut self, numbers: &Tensor) {
        let _guard = tch::no_grad_guard();
        // 0 x is 0 only for finite x.
        let finite = (numbers * 0.0).eq(0.0).all();
        self.open *= finite;
    }

    pub(crate) fn reopen(&mut self) {
        let _ = self.open.fill_(1.0);
    }

    /// 1 if open, 0 if shut; a scalar.
    pub(crate) fn open(&self) -> &Tensor {
        &self.open
    }

    /// Whether it is shut, a boolean scalar on the device.
    pub(crate) fn shut(&self) -> Tensor {
        self.open.eq(0.0)
    }
}
