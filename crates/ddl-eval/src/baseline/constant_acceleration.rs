//! Constant acceleration: the change between the last two steps continues.

use ddl_core::{Forecast, ForecastError, Forecaster, HORIZON, OBSERVED, Position, Window};

use crate::metric::displacement::minus;

/// Constant acceleration: `p(8 + t) = p(8) + t v + t (t + 1)/2 a`, with `v = p(8) - p(7)` in metres per frame and
/// `a = v - (p(7) - p(6))` in metres per frame squared.
///
/// It is at most as fast as the fastest of the 7 observed steps, and stops where it would turn back.
///
/// # References
/// Schoeller et al., "What the constant velocity model can teach us about pedestrian motion prediction", RA-L 2020.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConstantAcceleration;

impl Forecaster for ConstantAcceleration {
    fn name(&self) -> String {
        "constant acceleration (bounded)".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let mut positions = Vec::with_capacity(window.len() * HORIZON);
        for i in 0..window.len() {
            let observed = window.observed(i);
            let steps: Vec<Position> = observed.windows(2).map(|p| minus(p[1], p[0])).collect();
            let last = steps[OBSERVED - 2];
            let acceleration = minus(last, steps[OBSERVED - 3]);
            let fastest = steps.iter().map(|s| length(*s)).fold(0.0, f64::max);
            let (mut here, mut step) = (observed[OBSERVED - 1], last);
            let mut stands = false;
            for _ in 0..HORIZON {
                step = [step[0] + acceleration[0], step[1] + acceleration[1]];
                stands |= step[0] * last[0] + step[1] * last[1] < 0.0;
                let speed = length(step);
                if stands {
                    step = [0.0, 0.0];
                } else if speed > fastest {
                    step = step.map(|c| c * fastest / speed);
                }
                here = [here[0] + step[0], here[1] + step[1]];
                positions.push(here);
            }
        }
        Ok(Forecast::with_equal_weights(window.len(), 1, positions)?)
    }
}

fn length(v: Position) -> f64 {
    v[0].hypot(v[1])
}
