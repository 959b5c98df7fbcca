//! The training loss (paper eq. 13).

use tch::{Kind, Tensor};

/// Squared distance between forecast and true positions, summed over x and y, averaged over
/// walkers and steps.
///
/// # Shapes
/// Both `[T, P, 2]` -> scalar, in square metres.
pub fn mean_squared_distance(forecast: &Tensor, truth: &Tensor) -> Tensor {
    (forecast - truth)
        .square()
        .sum_dim_intlist([-1i64].as_slice(), false, None::<Kind>)
        .mean(None::<Kind>)
}
