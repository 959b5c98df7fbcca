//! Learned tensors in half precision: how weights travel when they are handed on to be used, not to be trained further.

use crate::StarError;
use crate::checkpoint::plain;
use crate::parameters::Parameters;
use tch::{Kind, Tensor};

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

/// The learned tensors, in order, rounded to half precision.
///
/// # Errors
/// [`StarError::Weights`] for a number that half precision has no room for: NaN, or at least 65,520 in size.
///
/// # Numerics
/// A number is rounded to 11 significant bits: off by at most 2^-11 of its size, or by 2^-25 where it is smaller than 2^-14.
/// Rounding rounded numbers again changes nothing.
///
/// # Examples
/// ```
/// use ddl_star::{ComputeDevice, DeviceChoice, StarConfig, StarNetwork, Variant, from_half, to_half};
///
/// let device = ComputeDevice::open(DeviceChoice::Cpu)?;
/// let config = StarConfig { feed_forward_width: 16, ..StarConfig::published(Variant::Full) };
/// let learned = StarNetwork::new(config.clone(), 1, device)?;
/// let packed = to_half(learned.parameters())?;
///
/// let again = StarNetwork::new(config, 2, device)?; // other initial weights
/// from_half(again.parameters(), &packed)?;
/// assert_eq!(to_half(again.parameters())?, packed);
/// # Ok::<(), ddl_star::StarError>(())
/// ```
pub fn to_half(parameters: &Parameters) -> Result<Vec<HalfTensor>, StarError> {
    parameters
        .iter()
        .map(|(name, tensor)| {
            let half = plain(tensor).f_to_kind(Kind::Half)?;
            if !is_finite(&half)? {
                let largest = tensor.abs().max().double_value(&[]);
                let problem = format!(
                    "holds numbers as large as {largest}, and half precision ends at 65504; train it with a smaller step size"
                );
                return Err(wrong(name, problem));
            }
            let count = half.numel();
            let mut bytes = vec![0; count * Kind::Half.elt_size_in_bytes()];
            half.f_copy_data_u8(&mut bytes, count)?;
            Ok(HalfTensor {
                name: name.to_owned(),
                shape: half.size().iter().map(|&size| size as usize).collect(),
                bytes,
            })
        })
        .collect()
}

/// Sets the learned tensors of a network to what was rounded of those of another one of the same configuration.
///
/// # Errors
/// [`StarError::Weights`] when there are other names, shapes or counts of tensors than the network has, or one holds what is no
/// number; the parameters are then unchanged.
pub fn from_half(parameters: &Parameters, tensors: &[HalfTensor]) -> Result<(), StarError> {
    let known = |name: &str| parameters.get(name).is_some();
    if let Some(other) = tensors.iter().find(|tensor| !known(&tensor.name)) {
        return Err(wrong(
            &other.name,
            "is no tensor of this network".to_owned(),
        ));
    }
    let mut pairs = Vec::new();
    for (name, target) in parameters.iter() {
        let mut named = tensors.iter().filter(|tensor| tensor.name == name);
        let (Some(tensor), None) = (named.next(), named.next()) else {
            return Err(wrong(name, "is missing, or there twice".to_owned()));
        };
        let shape: Vec<i64> = tensor.shape.iter().map(|&size| size as i64).collect();
        if shape != target.size() {
            let problem = format!("has shape {shape:?}, expected {:?}", target.size());
            return Err(wrong(name, problem));
        }
        // libtorch takes the bytes at their word.
        let expected = target.numel() * Kind::Half.elt_size_in_bytes();
        if tensor.bytes.len() != expected {
            let problem = format!("has {} bytes, expected {expected}", tensor.bytes.len());
            return Err(wrong(name, problem));
        }
        let stored = Tensor::f_from_data_size(&tensor.bytes, &shape, Kind::Half)?;
        if !is_finite(&stored)? {
            return Err(wrong(name, "holds NaN or infinite numbers".to_owned()));
        }
        pairs.push((target.shallow_clone(), stored));
    }
    let _guard = tch::no_grad_guard();
    for (mut target, stored) in pairs {
        target.f_copy_(&stored)?;
    }
    Ok(())
}

fn is_finite(tensor: &Tensor) -> Result<bool, StarError> {
    Ok(tensor.f_isfinite()?.f_all()?.f_int64_value(&[])? != 0)
}

fn wrong(tensor: &str, problem: String) -> StarError {
    StarError::Weights {
        tensor: tensor.to_owned(),
        problem,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ComputeDevice, DeviceChoice, StarConfig, StarNetwork, Variant};
    use proptest::prelude::*;

    fn network(seed: u64) -> StarNetwork {
        let device = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
        let config = StarConfig {
            feed_forward_width: 8,
            ..StarConfig::published(Variant::Full)
        };
        StarNetwork::new(config, seed, device).unwrap()
    }

    /// The value of binary16 bits, from the definition of the format.
    fn value(bits: u16) -> f64 {
        let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
        let size = if exponent == 0 {
            fraction * f64::powi(2.0, -24)
        } else {
            (1.0 + fraction / 1024.0) * f64::powi(2.0, exponent - 15)
        };
        if bits >> 15 == 1 { -size } else { size }
    }

    #[test]
    fn every_weight_comes_back_within_the_rounding() {
        let (learned, again) = (network(1), network(2));
        let packed = to_half(learned.parameters()).unwrap();
        from_half(again.parameters(), &packed).unwrap();
        let mut count = 0;
        for (tensor, (name, now)) in packed.iter().zip(again.parameters().iter()) {
            let before = learned.parameters().get(name).unwrap();
            let [before, now] = [before, now].map(|tensor| {
                Vec::<f32>::try_from(tensor.detach().reshape([-1]).contiguous()).unwrap()
            });
            let bits = tensor.bytes.chunks_exact(2);
            let halves = bits.map(|two| value(u16::from_le_bytes([two[0], two[1]])));
            for ((before, now), half) in before.into_iter().zip(now).zip(halves) {
                let (before, now) = (f64::from(before), f64::from(now));
                assert!(now.to_bits() == half.to_bits(), "{name}: {now} of {half}");
                let allowed = (before.abs() / 2048.0).max(f64::powi(2.0, -25));
                assert!((now - before).abs() <= allowed, "{name}: {before} is {now}");
                count += 1;
            }
        }
        assert_eq!(count, learned.parameters().count());
        assert_eq!(to_half(again.parameters()).unwrap(), packed);
    }

    #[test]
    fn numbers_without_room_are_refused() {
        for large in [65_520.0, f64::INFINITY, f64::NAN] {
            let learned = network(1);
            let (_, tensor) = learned.parameters().iter().next().unwrap();
            let _ = tch::no_grad(|| tensor.detach().fill_(large));
            let error = to_half(learned.parameters()).unwrap_err().to_string();
            assert!(error.contains("65504"), "{error}");
        }
        let learned = network(1);
        let (_, tensor) = learned.parameters().iter().next().unwrap();
        let _ = tch::no_grad(|| tensor.detach().fill_(65_519.0));
        assert!(to_half(learned.parameters()).is_ok());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Whatever is wrong with one tensor is an error, and leaves the network as it was.
        #[test]
        fn what_does_not_fit_changes_nothing(index in any::<prop::sample::Index>(), kind in 0..7) {
            let mut packed = to_half(network(1).parameters()).unwrap();
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
            let other = network(2);
            let before = to_half(other.parameters()).unwrap();
            prop_assert!(from_half(other.parameters(), &packed).is_err());
            prop_assert_eq!(to_half(other.parameters()).unwrap(), before);
        }
    }
}
