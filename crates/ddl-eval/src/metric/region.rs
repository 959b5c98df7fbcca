//! The log loss of the weights, and the coverage of regions.

use ddl_core::{Disc, HORIZON};

use crate::metric::displacement::final_displacement;
use crate::scored_window::ScoredWindow;

/// Probabilities of the regions that are measured.
pub const LEVELS: [f64; 2] = [0.5, 0.9];
/// Smallest weight in the log loss.
const SMALLEST_WEIGHT: f64 = 1e-6;

/// Cells along each side of the grid on which the area of a region is measured.
const CELLS: usize = 24;

/// Coverage and size for one pedestrian, for each of the [`LEVELS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RegionScores {
    /// Share of the 12 true positions inside their regions, in [0, 1].
    pub coverage: [f64; LEVELS.len()],
    /// Radius of a disc with the area of the region at the last step, metres.
    pub end_radius: [f64; LEVELS.len()],
}

impl RegionScores {
    /// The scores of pedestrian `i`; `None` for forecasts without regions.
    pub(crate) fn of(scene: &ScoredWindow<'_>, i: usize) -> Option<Self> {
        let forecast = scene.forecast();
        forecast.regions()?;
        let region = |t: usize, level: f64| forecast.region(i, t, level).unwrap_or_default();
        Some(Self {
            coverage: LEVELS.map(|level| {
                let truth = scene.truth(i).iter().enumerate();
                let inside = truth.filter(|&(t, &at)| region(t, level).iter().any(|disc| disc.contains(at)));
                inside.count() as f64 / HORIZON as f64
            }),
            end_radius: LEVELS.map(|level| equivalent_radius(&region(HORIZON - 1, level))),
        })
    }
}

/// -ln of the weight of the hypothesis whose goal is nearest to the true endpoint (without goals: whose last position
/// is nearest), nats. `None` for forecasts of one hypothesis. For equal weights it is ln K.
pub(crate) fn weight_log_loss(scene: &ScoredWindow<'_>, i: usize) -> Option<f64> {
    let forecast = scene.forecast();
    let truth = scene.truth(i);
    let off = |k: usize| match (forecast.goal(i, k), truth.last()) {
        (Some(goal), Some(end)) => (goal[0] - end[0]).hypot(goal[1] - end[1]),
        _ => final_displacement(forecast.hypothesis(i, k), truth),
    };
    let nearest = (0..scene.hypotheses()).min_by(|&a, &b| off(a).total_cmp(&off(b)))?;
    let weight = forecast.weight(i, nearest).max(SMALLEST_WEIGHT);
    (scene.hypotheses() > 1).then(|| -weight.ln())
}

/// The radius (m) of a disc with the area of the region, measured on a grid.
pub(crate) fn equivalent_radius(region: &[Disc]) -> f64 {
    let bound = |axis: usize, side: f64| {
        let ends = region.iter().map(|disc| disc.centre[axis] + side * disc.radius);
        ends.reduce(if side < 0.0 { f64::min } else { f64::max }).unwrap_or_default()
    };
    let [left, right, low, high] = [bound(0, -1.0), bound(0, 1.0), bound(1, -1.0), bound(1, 1.0)];
    let middle = |from: f64, to: f64, cell: usize| from + (to - from) * (cell as f64 + 0.5) / CELLS as f64;
    let inside = (0..CELLS * CELLS)
        .filter(|&cell| {
            let centre = [middle(left, right, cell % CELLS), middle(low, high, cell / CELLS)];
            region.iter().any(|disc| disc.contains(centre))
        })
        .count();
    let area = (right - left) * (high - low) * inside as f64 / (CELLS * CELLS) as f64;
    (area / std::f64::consts::PI).sqrt()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::fixture::{walk, window};
    use crate::metric::amd::DistributionErrors;
    use crate::metric::kde::kde_nll;
    use ddl_core::{Forecast, Pace, RegionTable, Spread};

    /// Standing hypotheses at (0, 0) and (10, 0), weights 0.8 and 0.2; the truth stands 0.5 m from the second. With a
    /// spread of 0.5 m its score is 0.5 - ln(0.2 / 0.8) = 1.89: inside where the quantile is 3, outside where it is
    /// 1.5.
    #[test]
    fn by_hand() {
        let still = [0.0, 0.0];
        let window = window(&[[10.5, 0.0]], &[still]);
        let walks = [walk(still, still), walk([10.0, 0.0], still)].concat();
        let bare = Forecast::new(1, 2, walks.clone(), vec![0.8, 0.2], None).unwrap();
        let scores = [vec![[1.5; HORIZON]; 10], vec![[3.0; HORIZON]; 9]].concat();
        let regions = RegionTable::of(&[&scores; 3], &[0.5, 0.9]).unwrap().into();
        let scene = ScoredWindow::new(&window, &bare).unwrap();
        assert_relative_eq!(weight_log_loss(&scene, 0).unwrap(), -(0.2_f64.ln()), epsilon = 1e-12);
        assert_eq!(RegionScores::of(&scene, 0), None);
        let certain = Forecast::new(1, 2, walks, vec![1.0, 0.0], None).unwrap();
        let loss = weight_log_loss(&ScoredWindow::new(&window, &certain).unwrap(), 0);
        assert_relative_eq!(loss.unwrap(), -(1e-6_f64.ln()), epsilon = 1e-12);
        let (scales, paces) = (vec![0.5; HORIZON], vec![Pace::Standing]);
        let forecast = bare.with_spread(Spread { scales, paces, regions }).unwrap();
        let scene = ScoredWindow::new(&window, &forecast).unwrap();
        let scores = RegionScores::of(&scene, 0).unwrap();
        assert_relative_eq!(scores.coverage[0], 0.0);
        assert_relative_eq!(scores.coverage[1], 1.0);
        let area = 2.0 * 0.25 * (3.0 + (3.0 + 0.25_f64.ln()));
        assert_relative_eq!(scores.end_radius[1], area.sqrt(), epsilon = 0.1);
        // The likelihood is that of Student's t of this scale, one scale from the second and 21 from the first. Its
        // variance of 0.75 adds to that around the mean (2, 0), 0.8 * 4 + 0.2 * 64 = 16 along x.
        let density = |off: f64| (1.0 + off * off / 3.0).powf(-2.5) / (std::f64::consts::TAU * 0.25);
        let nll = -(0.8 * density(21.0) + 0.2 * density(1.0)).ln();
        assert_relative_eq!(kde_nll(&scene, 0).unwrap(), nll, epsilon = 1e-12);
        let errors = DistributionErrors::of(&scene, 0).unwrap();
        assert_relative_eq!(errors.mahalanobis, 8.5 / 16.75_f64.sqrt(), epsilon = 1e-12);
        assert_relative_eq!(errors.covariance.yy, 0.75, epsilon = 1e-12);
    }
}
