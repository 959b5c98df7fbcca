//! What this machine can do at most, as far as libtorch shows it: a large product of matrices.

use crate::StarError;
use tch::{Device, Kind, Tensor};

/// A product of two square matrices in `f32` on the CPU, to be timed: the yardstick for everything else that is mostly
/// multiplications and additions.
#[derive(Debug)]
pub struct MatrixProduct {
    size: usize,
    factors: [Tensor; 2],
    product: Tensor,
}

impl MatrixProduct {
    /// Two matrices of `size` x `size` and room for their product. 1024 is large enough for the rate to be the machine's.
    ///
    /// # Errors
    /// [`StarError::Torch`] when there is no room.
    pub fn new(size: usize) -> Result<Self, StarError> {
        let shape = [size as i64, size as i64];
        // Any numbers will do that are neither zero nor denormal.
        let matrix = || Tensor::f_full(shape, 0.5, (Kind::Float, Device::Cpu));
        Ok(Self {
            size,
            factors: [matrix()?, matrix()?],
            product: matrix()?,
        })
    }

    /// Multiplies them, with as many threads as [`set_threads`](crate::set_threads) said on this thread.
    ///
    /// # Errors
    /// [`StarError::Torch`] when libtorch fails.
    pub fn multiply(&mut self) -> Result<(), StarError> {
        let _guard = tch::no_grad_guard();
        let [left, right] = &self.factors;
        // What it gives back is the product again.
        let _ = left.f_matmul_out(&self.product, right)?;
        Ok(())
    }

    /// Multiplications and additions of one product: 2 n³.
    #[must_use]
    pub fn operations(&self) -> u64 {
        2 * (self.size as u64).pow(3)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::MatrixProduct;

    /// It does multiply: every entry is 8 times a quarter.
    #[test]
    fn the_product_is_one() {
        let mut product = MatrixProduct::new(8).unwrap();
        product.multiply().unwrap();
        let entries: Vec<f32> = Vec::try_from(product.product.reshape([-1])).unwrap();
        assert_eq!(entries, [2.0; 64]);
    }
}
