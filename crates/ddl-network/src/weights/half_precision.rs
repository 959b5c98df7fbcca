//! Weights in half precision, the format of packed models. They are for forecasts only, not for further training.

use crate::NetworkError;
use crate::weights::layout::Layout;
use crate::weights::learned::Weights;
use half::f16;
use std::sync::Arc;

/// A tensor of weights in IEEE 754 binary16.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HalfTensor {
    /// Its name in the network.
    pub name: String,
    /// Its shape.
    pub shape: Vec<usize>,
    /// Its numbers, two bytes each (little-endian), in row-major order.
    pub bytes: Vec<u8>,
}

impl Weights {
    /// The tensors that forecasts need, in order and rounded to half precision. Tensors that only training
    /// reads are left out.
    ///
    /// # Errors
    /// [`NetworkError::Weights`] for a number that half precision cannot hold: NaN, or an absolute value of 65,520 or
    /// more.
    ///
    /// # Numerics
    /// Numbers are rounded to 11 significant bits. The relative error is at most 2^-11; numbers below 2^-14 have an
    /// absolute error of at most 2^-25.
    pub fn to_half(&self) -> Result<Vec<HalfTensor>, NetworkError> {
        let needed = self.iter().filter(|(tensor, _)| !tensor.training_only);
        needed
            .map(|(tensor, numbers)| {
                let halves: Vec<f16> = numbers.iter().map(|&x| f16::from_f32(x)).collect();
                if !halves.iter().all(|half| half.is_finite()) {
                    let size = |largest: f32, x: &f32| if x.is_nan() { f32::NAN } else { largest.max(x.abs()) };
                    let largest = numbers.iter().fold(0.0, size);
                    let problem = format!(
                        "has a weight of size {largest}, but half precision holds at most 65504; train with a smaller \
                         step size"
                    );
                    return Err(NetworkError::weights(tensor.name(), problem));
                }
                Ok(HalfTensor {
                    name: tensor.name().to_owned(),
                    shape: tensor.shape().to_vec(),
                    bytes: halves.iter().flat_map(|half| half.to_le_bytes()).collect(),
                })
            })
            .collect()
    }

    /// Weights from the rounded tensors of a network of the same configuration. Tensors that only training reads are 0.
    ///
    /// # Errors
    /// [`NetworkError::Weights`] if names, shapes or counts of the tensors differ from the layout's, or if a tensor
    /// holds NaN or infinity.
    pub fn from_half(layout: &Arc<Layout>, tensors: &[HalfTensor]) -> Result<Self, NetworkError> {
        let needed = || layout.tensors().iter().filter(|tensor| !tensor.training_only);
        let is_needed = |name: &str| needed().any(|tensor| tensor.name() == name);
        if let Some(other) = tensors.iter().find(|tensor| !is_needed(&tensor.name)) {
            return Err(NetworkError::weights(&other.name, "does not belong to this network"));
        }
        let mut numbers = vec![0.0; layout.count()];
        for wanted in needed() {
            let name = wanted.name();
            let mut named = tensors.iter().filter(|tensor| tensor.name == name);
            let (Some(tensor), None) = (named.next(), named.next()) else {
                return Err(NetworkError::weights(name, "is missing or duplicate"));
            };
            if tensor.shape != wanted.shape() {
                let problem = format!("has shape {:?}, expected {:?}", tensor.shape, wanted.shape());
                return Err(NetworkError::weights(name, problem));
            }
            let expected = wanted.span().len() * size_of::<f16>();
            if tensor.bytes.len() != expected {
                let problem = format!("has {} bytes, expected {expected}", tensor.bytes.len());
                return Err(NetworkError::weights(name, problem));
            }
            let (halves, _) = tensor.bytes.as_chunks();
            let numbers = &mut numbers[wanted.span()];
            for (number, &half) in numbers.iter_mut().zip(halves) {
                *number = f16::from_le_bytes(half).to_f32();
            }
            if !numbers.iter().all(|number| number.is_finite()) {
                return Err(NetworkError::weights(name, "holds NaN or infinite numbers"));
            }
        }
        Ok(Self::new(Arc::clone(layout), numbers))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ForecastWindows as _, MotionNetwork, StarConfig, Variant};
    use proptest::prelude::*;

    fn weights() -> Weights {
        let config = StarConfig { feed_forward_width: 8, ..StarConfig::published(Variant::Full) };
        MotionNetwork::new(config, 1).unwrap().copy_weights().unwrap()
    }

    #[test]
    fn every_weight_is_restored_up_to_rounding() {
        let learned = weights();
        let packed = learned.to_half().unwrap();
        let again = Weights::from_half(learned.layout(), &packed).unwrap();
        for (&before, &now) in learned.numbers().iter().zip(again.numbers()) {
            let (before, now) = (f64::from(before), f64::from(now));
            let allowed = (before.abs() / 2048.0).max(f64::powi(2.0, -25));
            assert!((now - before).abs() <= allowed, "{before} is {now}");
        }
        assert_eq!(again.to_half().unwrap(), packed);
    }

    #[test]
    fn numbers_beyond_half_precision_are_refused() {
        for (large, fits) in [(65_519.0, true), (65_520.0, false), (f32::NAN, false)] {
            let learned = weights();
            let mut numbers = learned.numbers().to_vec();
            numbers[0] = large;
            let large_one = Weights::new(Arc::clone(learned.layout()), numbers);
            let packed = large_one.to_half().map_err(|error| error.to_string());
            assert_eq!(packed.is_ok(), fits, "{large}");
            assert!(packed.is_ok() || packed.unwrap_err().contains("65504"));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn tensors_that_do_not_fit_are_refused(index in any::<prop::sample::Index>(), kind in 0..7) {
            let learned = weights();
            let mut packed = learned.to_half().unwrap();
            let index = index.index(packed.len());
            match kind {
                0 => drop(packed.remove(index)),
                1 => packed.push(packed[index].clone()),
                2 => packed[index].name.push('x'),
                3 => packed[index].shape.push(1),
                4 => packed[index].bytes.truncate(1),
                5 => packed[index].bytes[..2].copy_from_slice(&[0, 0x7c]), // infinity
                _ => packed[index].bytes[..2].copy_from_slice(&[1, 0xfc]), // NaN
            }
            prop_assert!(Weights::from_half(learned.layout(), &packed).is_err());
        }
    }
}
