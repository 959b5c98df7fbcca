//! Updates that stop at the first number that is none, without asking the device for it.

use tch::{Device, Kind, Tensor};

/// Open until it has seen a number that is not finite, then shut until it is reopened.
///
/// It lives on the device: whether an update counts is decided there, so that nobody waits. What it lets
/// through is multiplied by 1; what comes after is as if it had not been.
#[derive(Debug)]
pub(crate) struct FiniteGate {
    /// Scalar, 1 or 0.
    open: Tensor,
}

impl FiniteGate {
    /// An open gate.
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

    /// Opens it again.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stays_shut_once_it_has_seen_what_is_no_number() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut gate = FiniteGate::new(Device::Cpu, Kind::Double);
            let open = |gate: &FiniteGate| gate.open().int64_value(&[]);
            gate.watch(&Tensor::from_slice(&[0.0, 1e308]));
            assert!(open(&gate) == 1 && gate.shut().int64_value(&[]) == 0);
            gate.watch(&Tensor::from_slice(&[1.0, bad]));
            gate.watch(&Tensor::from_slice(&[1.0]));
            assert!(open(&gate) == 0 && gate.shut().int64_value(&[]) == 1);
            gate.reopen();
            assert!(open(&gate) == 1);
        }
    }
}
