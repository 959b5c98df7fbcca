//! The leak test: whether a forecast changes with the future.

use ddl_core::{Forecast, ForecastError, Forecaster, HORIZON, OBSERVED, Position, WINDOW, Window};

/// Looks for a leak: forecasts the window as it is, without its future, and with futures changed one frame of one
/// pedestrian at a time and all together. `None` when every forecast is bit-identical, else the change that a forecast
/// revealed. Bystanders, which have no future, are left out.
///
/// # Errors
/// The forecaster failed, for instance because it needs the future, which is also a leak.
pub fn find(forecaster: &(impl Forecaster + ?Sized), window: &Window) -> Result<Option<String>, ForecastError> {
    let window = &window.clone().with_bystanders(None);
    let reference = bits(&forecaster.forecast(&window.without_future())?);
    let leaks =
        |changed: &Window| -> Result<bool, ForecastError> { Ok(bits(&forecaster.forecast(changed)?) != reference) };
    if !window.has_future() {
        return Ok(None);
    }
    if leaks(window)? {
        return Ok(Some("the future was shown at all".to_owned()));
    }
    let everything = window.map_positions(|_, frame, p| if frame < OBSERVED { p } else { moved(p) });
    if leaks(&everything)? {
        return Ok(Some("every future position was moved".to_owned()));
    }
    for pedestrian in 0..window.len() {
        for frame in OBSERVED..WINDOW {
            let one = window.map_positions(|i, t, p| if (i, t) == (pedestrian, frame) { moved(p) } else { p });
            if leaks(&one)? {
                let frame = frame + 1;
                return Ok(Some(format!("pedestrian {pedestrian} was moved at frame {frame}")));
            }
        }
    }
    Ok(None)
}

/// A displacement that changes everything that depends on the position, m.
fn moved(p: Position) -> Position {
    [17.0 - 3.0 * p[1], 5.0 + 2.0 * p[0]]
}

/// Every number of a forecast as bits, because `==` on floats does not distinguish 0.0 and -0.0.
pub fn bits(forecast: &Forecast) -> Vec<u64> {
    let mut bits = vec![forecast.pedestrians() as u64, forecast.hypotheses() as u64];
    for i in 0..forecast.pedestrians() {
        for k in 0..forecast.hypotheses() {
            bits.push(forecast.weight(i, k).to_bits());
            let goal = forecast.goal(i, k);
            bits.push(forecast.certified(i, k).map_or(2, u64::from));
            for p in forecast.hypothesis(i, k).iter().chain(&goal) {
                bits.extend(p.map(f64::to_bits));
            }
        }
        let spread = (0..HORIZON).map(|t| forecast.scale(i, t));
        bits.extend(spread.chain([forecast.familiarity(i)]).map(|number| number.map_or(2, f64::to_bits)));
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baseline::{ConstantAcceleration, SocialForce};
    use crate::fixture::{forecast, walk, walking, window};
    use ddl_core::{Pace, RegionTable, Spread};

    struct Peeks {
        frame: usize,
    }

    /// Reveals whether the last pedestrian is apart from the one before at one future frame: not if both are moved
    /// alike.
    struct Compares {
        frame: usize,
    }

    impl Forecaster for Compares {
        fn name(&self) -> String {
            "compares".to_owned()
        }

        fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
            let [first, last] = [window.len() - 2, window.len() - 1].map(|i| window.track(i).get(self.frame));
            Ok(forecast(window.len(), &vec![walk([f64::from(u8::from(first != last)), 0.0], [0.0, 0.0]); window.len()]))
        }
    }

    #[test]
    fn what_is_revealed_is_named_and_every_number_counts() {
        let still = [0.0, 0.0];
        let three = window(&[still; 3], &[still; 3]);
        for frame in [OBSERVED, WINDOW - 1] {
            let named = find(&Compares { frame }, &three).unwrap().unwrap();
            assert_eq!(named, format!("pedestrian 1 was moved at frame {}", frame + 1));
            assert_eq!(find(&Peeks { frame }, &three).unwrap().unwrap(), "every future position was moved");
        }
        let apart = window(&[still, still], &[still, [0.1, 0.0]]);
        let shown = find(&Compares { frame: OBSERVED }, &apart).unwrap().unwrap();
        assert_eq!(shown, "the future was shown at all");
        let spread = |scale: f64| Spread {
            scales: [vec![1.0; HORIZON - 1], vec![scale]].concat(),
            paces: vec![Pace::Slow],
            regions: RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5]).unwrap().into(),
        };
        let with = |weight: f64, goal: f64, held: bool, familiarity: f64, scale: f64| {
            let walks = [walk(still, still), walk(still, still)].concat();
            let goals = vec![[0.0, 0.0], [0.0, goal]];
            let forecast = Forecast::new(1, 2, walks, vec![weight, 1.0 - weight], Some(goals)).unwrap();
            let forecast = forecast.with_certified(vec![true, held]).unwrap();
            bits(&forecast.with_familiarity(vec![familiarity]).unwrap().with_spread(spread(scale)).unwrap())
        };
        let all = [
            with(0.5, 1.0, true, 0.5, 1.0),
            with(0.25, 1.0, true, 0.5, 1.0),
            with(0.5, 2.0, true, 0.5, 1.0),
            with(0.5, 1.0, false, 0.5, 1.0),
            with(0.5, 1.0, true, 0.25, 1.0),
            with(0.5, 1.0, true, 0.5, 2.0),
        ];
        assert_eq!(all.iter().collect::<std::collections::BTreeSet<_>>().len(), 6);
    }

    impl Forecaster for Peeks {
        fn name(&self) -> String {
            "peeks".to_owned()
        }

        fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
            let last = window.track(window.len() - 1);
            // For this forecaster, the unchanged future has the same effect as no future: only a changed future reveals
            // the leak.
            let seen = last.get(self.frame).map_or(0.0, |p| p[1]);
            let step = [0.0, if seen > 0.0 { 1e-9 } else { 0.0 }];
            Ok(forecast(window.len(), &vec![walk([0.0, 0.0], step); window.len()]))
        }
    }

    #[test]
    fn a_glimpse_of_one_frame_is_found() {
        let still = [0.0, 0.0];
        let window = window(&[still; 3], &[still; 3]);
        for frame in OBSERVED..WINDOW {
            assert!(find(&Peeks { frame }, &window).unwrap().is_some());
        }
        // Bystanders are no leak, and hide none.
        let crowd = walking(&[([0.5, 0.0], [0.4, 0.0]), ([1.0, 0.5], [-0.4, 0.0])], OBSERVED);
        let window = window.with_bystanders(Some(crowd));
        assert!(find(&Peeks { frame: OBSERVED }, &window).unwrap().is_some());
        let frame = OBSERVED - 1;
        assert_eq!(find(&Peeks { frame }, &window).unwrap(), None);
        assert_eq!(find(&SocialForce, &window).unwrap(), None);
        assert_eq!(find(&ConstantAcceleration, &window).unwrap(), None);
    }
}
