//! The cost of matching one step of `x` with one step of `y`.

/// Distance between two steps: an entry of the cost matrix Δ(x, y).
///
/// For sequences in metres (or m/s) the squared cost is in m² (or m²/s²), and gamma has the unit of the cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Cost {
    /// |a − b|², what Cuturi & Blondel (2017) use and what the published goal estimator computes.
    #[default]
    SquaredEuclidean,
    /// |a − b|, what the text of the DDL paper says.
    Euclidean,
}

impl Cost {
    /// Cost of matching step `a` with step `b`; never negative, infinite when it exceeds the range of `f64`.
    pub(crate) fn between<const D: usize>(self, a: &[f64; D], b: &[f64; D]) -> f64 {
        let squared = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        match self {
            Self::SquaredEuclidean => squared,
            // Squares overflow above 1e154 and lose digits below 1e-154.
            Self::Euclidean if (1e-280..=1e280).contains(&squared) => squared.sqrt(),
            Self::Euclidean => scaled_length(a, b),
        }
    }

    /// Derivative of the cost with respect to `a`; that with respect to `b` is its negative. Where the Euclidean cost
    /// has no derivative, at `a == b`, it is 0: the subgradient with the smallest norm.
    pub(crate) fn slope<const D: usize>(self, a: &[f64; D], b: &[f64; D]) -> [f64; D] {
        let length = match self {
            Self::SquaredEuclidean => 0.5,
            Self::Euclidean => self.between(a, b),
        };
        std::array::from_fn(|k| if length > 0.0 { (a[k] - b[k]) / length } else { 0.0 })
    }
}

/// The length of a − b, with the differences divided by the largest of them first.
#[cold]
fn scaled_length<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let differences = || a.iter().zip(b).map(|(a, b)| (a - b).abs());
    let largest = differences().fold(0.0, f64::max);
    if largest == 0.0 || largest.is_infinite() {
        return largest;
    }
    largest * differences().map(|d| (d / largest).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

    use super::Cost;

    #[test]
    fn the_euclidean_cost_neither_overflows_nor_underflows() {
        for scale in [1e-200_f64, 1.0, 1e200] {
            let length = Cost::Euclidean.between(&[3.0 * scale, 0.0], &[0.0, 4.0 * scale]);
            assert!((length / (5.0 * scale) - 1.0).abs() < 1e-15, "{length}");
        }
        let smallest = f64::from_bits(1);
        assert_eq!(Cost::Euclidean.between(&[smallest], &[0.0]), smallest);
        assert_eq!(Cost::Euclidean.slope(&[smallest], &[0.0]), [1.0]);
        assert_eq!(Cost::Euclidean.slope(&[2.0, 3.0], &[2.0, 3.0]), [0.0; 2]);
        assert_eq!(Cost::Euclidean.between(&[1.0; 3], &[1.0; 3]), 0.0);
        assert_eq!(Cost::SquaredEuclidean.slope(&[3.0], &[1.0]), [4.0]);
    }
}
