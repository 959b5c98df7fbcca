//! Numbers to pixels along one axis, with round ticks.

/// A linear axis from 0, or a logarithmic one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    low: f64,
    high: f64,
    pub(crate) logarithmic: bool,
    pixels: [f64; 2],
}

impl Scale {
    /// From 0 to a round number not below `largest`, drawn from pixel to pixel.
    fn from_zero(largest: f64, pixels: [f64; 2]) -> Self {
        let largest = if largest > 0.0 { largest } else { 1.0 };
        let step = round_step(largest / 4.0);
        Self { low: 0.0, high: (largest / step - 1e-9).ceil() * step, logarithmic: false, pixels }
    }

    /// Linear from 0, or logarithmic when the values span more than a factor of 12.
    pub(crate) fn of(values: &[f64], pixels: [f64; 2]) -> Self {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = values.iter().copied().fold(0.0, f64::max);
        if least > 0.0 && largest > 12.0 * least && largest.is_finite() {
            return Self {
                low: 10.0_f64.powf((least.log10() * 2.0).floor() / 2.0),
                high: 10.0_f64.powf((largest.log10() * 2.0).ceil() / 2.0),
                logarithmic: true,
                pixels,
            };
        }
        Self::from_zero(largest, pixels)
    }

    pub(crate) fn at(&self, value: f64) -> f64 {
        let share = if self.logarithmic {
            (value.max(self.low) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.pixels[0] + share * (self.pixels[1] - self.pixels[0])
    }

    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        if self.logarithmic {
            let exponents = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
            return exponents
                .flat_map(|exponent| [1.0, 3.0].map(|digit| digit * 10.0_f64.powi(exponent)))
                .filter(|value| (self.low * 0.999..=self.high * 1.001).contains(value))
                .map(|value| (value, label(value, value)))
                .collect();
        }
        ticks(self.low, self.high, round_step((self.high - self.low) / 4.0)).collect()
    }
}

pub(crate) fn ticks(low: f64, high: f64, step: f64) -> impl Iterator<Item = (f64, String)> {
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(move |n| (n as f64 * step, label(n as f64 * step, step)))
}

/// 1, 2 or 5 times a power of ten, at least about `least`.
pub(crate) fn round_step(least: f64) -> f64 {
    let power = 10.0_f64.powf(least.log10().floor());
    let digit = [1.0, 2.0, 5.0, 10.0].into_iter().find(|digit| digit * power >= 0.999 * least).unwrap_or(10.0);
    digit * power
}

fn label(value: f64, size: f64) -> String {
    let decimals = (-(size.abs().log10() + 1e-9).floor()).max(0.0) as usize;
    if value == 0.0 {
        return "0".to_owned();
    }
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale) -> Vec<String> {
        scale.ticks().into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round() {
        let scale = Scale::from_zero(0.83, [0.0, 100.0]);
        assert_eq!(labels(scale), ["0", "0.5", "1.0"]);
        assert!((scale.at(0.5) - 50.0).abs() < 1e-9);
        let scale = Scale::of(&[0.02, 3.0], [0.0, 100.0]);
        assert_eq!(labels(scale), ["0.01", "0.03", "0.1", "0.3", "1", "3"]);
        assert!(scale.at(0.0).abs() < 1e-9);
        assert_eq!(labels(Scale::of(&[], [0.0, 1.0])).len(), 3);
        let around_zero: Vec<String> = ticks(-0.7, 1.0, 0.5).map(|(_, label)| label).collect();
        assert_eq!(around_zero, ["-0.5", "0", "0.5", "1.0"]);
    }
}
