//! The training losses: squared distances (paper eq. 13), and distances.

use tch::{Kind, Tensor};

/// Squared distance between forecast and true positions, summed over x and y, averaged over pedestrians and steps.
///
/// # Shapes
/// Both `[T, P, 2]` -> scalar, in square metres.
pub(crate) fn mean_squared_distance(forecast: &Tensor, truth: &Tensor) -> Tensor {
    (forecast - truth).square().sum_dim_intlist([-1i64].as_slice(), false, None::<Kind>).mean(None::<Kind>)
}

/// Distance between forecast and true positions, averaged over pedestrians and steps: the average displacement error.
///
/// # Shapes
/// Both `[T, P, 2]` -> scalar, in metres.
///
/// # Numerics
/// The derivative is 0 where both are equal.
pub(crate) fn mean_distance(forecast: &Tensor, truth: &Tensor) -> Tensor {
    (forecast - truth).norm_scalaropt_dim(2, [-1i64].as_slice(), false).mean(None::<Kind>)
}
