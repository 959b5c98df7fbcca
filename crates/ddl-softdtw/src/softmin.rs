//! The smoothed minimum of three numbers and its weights.

/// Smoothed minimum −γ ln(e^(−a/γ) + e^(−b/γ) + e^(−c/γ)); the plain minimum for γ = 0. It does not overflow, and
/// `+inf` entries contribute nothing. The order of the sum does not depend on the order of the arguments, so soft-DTW
/// is symmetric to the last bit.
pub(crate) fn softmin(a: f64, b: f64, c: f64, gamma: f64) -> f64 {
    let (low, middle, high) = sorted(a, b, c);
    if gamma == 0.0 || low == f64::INFINITY {
        return low;
    }
    low - gamma * (decay(low, middle, gamma) + decay(low, high, gamma)).ln_1p()
}

/// The smoothed minimum with its derivatives with respect to `values`: weights that are not negative and sum to 1. For
/// γ = 0 the whole weight goes to the first smallest value (a subgradient).
pub(crate) fn softmin_weights(values: [f64; 3], gamma: f64) -> (f64, [f64; 3]) {
    let [a, b, c] = values;
    let (low, ..) = sorted(a, b, c);
    if gamma == 0.0 || low == f64::INFINITY {
        let mut weights = [0.0; 3];
        if let Some(first) = values.iter().position(|&value| value <= low) {
            weights[first] = 1.0;
        }
        return (low, weights);
    }
    let weights = values.map(|value| decay(low, value, gamma));
    let total: f64 = weights.iter().sum();
    (softmin(a, b, c, gamma), weights.map(|weight| weight / total))
}

/// e^(−(value − low)/γ) for `value >= low`.
fn decay(low: f64, value: f64, gamma: f64) -> f64 {
    ((low - value) / gamma).exp()
}

fn sorted(a: f64, b: f64, c: f64) -> (f64, f64, f64) {
    let (a, b) = if b < a { (b, a) } else { (a, b) };
    let (b, c) = if c < b { (c, b) } else { (b, c) };
    let (a, b) = if b < a { (b, a) } else { (a, b) };
    (a, b, c)
}
