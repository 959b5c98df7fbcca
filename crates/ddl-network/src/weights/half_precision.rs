//! Learned tensors in half precision: how weights travel when they are handed on to be used, not to be trained further.

use super::layout::Layout;
use super::learned::Weights;
use crate::NetworkError;
use half::f16;
use std::sync::Arc;

/// A learned tensor in IEEE 754 binary16.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HalfTensor {
    /// Its name in the network.
    pub name: String,
    /// Its shape.
    pub shape: Vec<usize>,
    /// Its numbers, two bytes each, in row-major order.
    pub bytes: Vec<u8>,
}

impl Weights {
    /// The learned tensors that forecasts need, in order, rounded to half precision: all but those that
    /// [only training reads](crate::weights::TensorLayout::is_training_only).
    ///
    /// # Errors
    /// [`NetworkError::Weights`] for a number that half precision has no room for: NaN, or at least 65,520 in size.
    ///
    /// # Numerics
    /// A number is rounded to 11 significant bits: off by at most 2^-11 of its size, or by 2^-25 where it is smaller than 2^-14.
    pub fn to_half(&self) -> Result<Vec<HalfTensor>, NetworkError> {
        let needed = self.iter().filter(|(tensor, _)| !tensor.is_training_only());
        needed
            .map(|(tensor, numbers)| {
                let halves: Vec<f16> = numbers.iter().map(|&x| f16::from_f32(x)).collect();
                if !halves.iter().all(|half| half.is_finite()) {
                    let size = |largest: f32, x: &f32| if x.is_nan() { f32::NAN } else { largest.max(x.abs()) };
                    let largest = numbers.iter().fold(0.0, size);
                    let problem = format!(
                        "holds numbers as large as {largest}, and half precision ends at 65504; train it with a smaller step size"
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

    /// The learned tensors of a layout from what was rounded of those of another network of the same configuration. Those that only
    /// training reads are 0.
    ///
    /// # Errors
    /// [`NetworkError::Weights`] when there are other names, shapes or counts of tensors than the layout has, or one holds NaN or
    /// infinity.
    pub fn from_half(layout: &Arc<Layout>, tensors: &[HalfTensor]) -> Result<Self, NetworkError> {
        let needed = || {
            layout
                .tensors()
                .iter()
                .filter(|tensor| !tensor.is_training_only())
        };
        let known = |name: &str| needed().any(|tensor| tensor.name() == name);
        if let Some(other) = tensors.iter().find(|tensor| !known(&tensor.name)) {
            return Err(NetworkError::weights(
                &other.name,
                "is no tensor of this network",
            ));
        }
        let mut numbers = vec![0.0; layout.count()];
        for wanted in needed() {
            let name = wanted.name();
            let mut named = tensors.iter().filter(|tensor| tensor.name == name);
            let (Some(tensor), None) = (named.next(), named.next()) else {
                return Err(NetworkError::weights(name, "is missing, or there twice"));
            };
            if tensor.shape != wanted.shape() {
                let problem = format!(
                    "has shape {:?}, expected {:?}",
                    tensor.shape,
                    wanted.shape()
                );
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
    use crate::{MotionNetwork, StarConfig, Variant};
    use proptest::prelude::*;

    fn weights() -> Weights {
        let config = StarConfig {
            feed_forward_width: 8,
            ..StarConfig::published(Variant::Full)
        };
        MotionNetwork::new(config, 1).unwrap().weights().clone()
    }

    #[test]
    fn every_weight_comes_back_within_the_rounding() {
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
    fn numbers_without_room_are_refused() {
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
        fn what_does_not_fit_is_refused(index in any::<prop::sample::Index>(), kind in 0..7) {
            let learned = weights();
            let mut packed = learned.to_half().unwrap();
            let index = index.index(packed.len());
            match kind {
                0 => drop(packed.remove(index)),
                1 => packed.push(packed[index].clone()),
                2 => packed[index].name.push('x'),
                3 => packed[index].shape.push(1),
                4 => packed[index].bytes.truncate(1),
                5 => packed[index].bytes[..2].copy_from_slice(&[0, 0x7c]), // infinite
                _ => packed[index].bytes[..2].copy_from_slice(&[1, 0xfc]), // NaN
            }
            prop_assert!(Weights::from_half(learned.layout(), &packed).is_err());
        }
    }
}
