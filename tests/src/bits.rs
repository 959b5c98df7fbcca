//! Bitwise comparison of forecasts, because `==` on floats does not distinguish 0.0 and -0.0.

use ddl_core::Forecast;

/// Every number of a forecast as bits: shape, then weights, whether certificates hold, positions and goals.
pub fn of(forecast: &Forecast) -> Vec<u64> {
    let (pedestrians, hypotheses) = (forecast.pedestrians(), forecast.hypotheses());
    let mut bits = vec![pedestrians as u64, hypotheses as u64];
    for (i, k) in (0..pedestrians).flat_map(|i| (0..hypotheses).map(move |k| (i, k))) {
        bits.push(forecast.weight(i, k).to_bits());
        bits.push(forecast.certified(i, k).map_or(2, u64::from));
        let goal = forecast.goal(i, k);
        let positions = forecast.hypothesis(i, k).iter().chain(&goal);
        bits.extend(positions.flatten().map(|coordinate| coordinate.to_bits()));
    }
    bits
}

/// The bits of many forecasts, one entry per window.
pub fn of_all(forecasts: &[Forecast]) -> Vec<Vec<u64>> {
    forecasts.iter().map(of).collect()
}
