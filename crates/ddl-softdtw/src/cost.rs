//! The cost of matching one step of `x` with one step of `y`.

/// Distance between two steps, the entries of the cost matrix Δ(x, y).
///
/// For sequences in metres (or m/s) the squared cost is in m² (or m²/s²), and gamma has the unit of the cost.
///
/// # Examples
/// ```
/// use ddl_softdtw::Cost;
/// assert_eq!(Cost::SquaredEuclidean.between(&[0.0, 0.0], &[3.0, 4.0]), 25.0);
/// assert_eq!(Cost::Euclidean.between(&[0.0, 0.0], &[3.0, 4.0]), 5.0);
/// ```
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
    #[must_use]
    pub fn between<const D: usize>(self, a: &[f64; D], b: &[f64; D]) -> f64 {
        match self {
            Self::SquaredEuclidean => squared(a, b),
            Self::Euclidean => length(a, b),
        }
    }

    /// Derivative of the cost with respect to `a`, times `weight`, added to `into`.
    ///
    /// At `a == b` the Euclidean cost has no derivative; 0 is the subgradient of least norm.
    pub(crate) fn add_gradient<const D: usize>(
        self,
        a: &[f64; D],
        b: &[f64; D],
        weight: f64,
        into: &mut [f64; D],
    ) {
        let scale = match self {
            Self::SquaredEuclidean => 2.0 * weight,
            Self::Euclidean => {
                let length = length(a, b);
                if length == 0.0 {
                    return;
                }
                weight / length
            }
        };
        for (into, (a, b)) in into.iter_mut().zip(a.iter().zip(b)) {
            *into += scale * (a - b);
        }
    }
}

fn squared<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

fn length<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let squared = squared(a, b);
    // Squares overflow above 1e154 and lose digits below 1e-154: there the differences are scaled first.
    if (1e-280..=1e280).contains(&squared) {
        return squared.sqrt();
    }
    let largest = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    if largest == 0.0 || largest.is_infinite() {
        return largest;
    }
    let scaled: f64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| ((a - b) / largest).powi(2))
        .sum();
    largest * scaled.sqrt()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

    use super::Cost;

    #[test]
    fn the_euclidean_cost_neither_overflows_nor_underflows() {
        for scale in [1e-200, 1.0, 1e200] {
            let length = Cost::Euclidean.between(&[3.0 * scale, 0.0], &[0.0, 4.0 * scale]);
            assert!((length / (5.0 * scale) - 1.0).abs() < 1e-15, "{length}");
        }
        assert_eq!(Cost::Euclidean.between(&[1.0; 3], &[1.0; 3]), 0.0);
    }
}
