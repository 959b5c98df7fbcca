//! A number over several seeds: mean and standard deviation.

use std::fmt;

/// Mean and spread of one number over the seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SeedSpread {
    pub(crate) mean: f64,
    /// Sample standard deviation (n - 1); `None` for one seed.
    deviation: Option<f64>,
}

impl SeedSpread {
    /// `None` when there are no values.
    pub(crate) fn of(values: &[f64]) -> Option<Self> {
        let n = values.len() as f64;
        if values.is_empty() {
            return None;
        }
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let deviation = (values.len() > 1).then(|| (squares / (n - 1.0)).sqrt());
        Some(Self { mean, deviation })
    }
}

impl fmt::Display for SeedSpread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let precision = f.precision().unwrap_or(3);
        write!(f, "{:.precision$}", self.mean)?;
        match self.deviation {
            Some(deviation) => write!(f, "±{deviation:.precision$}"),
            None => Ok(()),
        }
    }
}
