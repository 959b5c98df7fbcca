//! The geometric median: the point with the least weighted mean distance to given points.

use crate::points::squared_distance;

/// The iteration ends after a step shorter than this (m).
const LAST_STEP: f64 = 1e-4;
const MOST_STEPS: usize = 100;
/// A given point is returned only if it is better than the iterated point by more than this share. If the median is not
/// unique, as between two equal points, rounding must not decide.
const ROUNDING: f64 = 1e-9;

/// The point with the least weighted mean distance to `points` (m): one of them, or a point between them.
///
/// # Shapes
/// `points`: at least one; `weights`: one per point, not negative, with a positive sum.
///
/// # Numerics
/// A given point is the median if its weight exceeds the pull of all others; it is then returned exactly. Otherwise
/// Weiszfeld's iteration starts at the weighted mean, and ends when a step is below 0.1 mm or after 100 steps. A given
/// point is returned instead if it is better.
///
/// # References
/// E. Weiszfeld, "Sur le point pour lequel la somme des distances de n points donnés est minimum", 1937; H. W. Kuhn, "A
/// note on Fermat's problem", 1973 (when a point is the median); Y. Vardi, C.-H. Zhang, "The multivariate L1-median and
/// associated data depth", 2000 (the step from a point).
pub(crate) fn geometric_median(points: &[[f64; 2]], weights: &[f64]) -> [f64; 2] {
    let outweighs = |&&point: &&[f64; 2]| {
        let pull = Pull::at(point, points, weights);
        pull.strength() < (1.0 - ROUNDING) * pull.here
    };
    if let Some(&point) = points.iter().find(outweighs) {
        return point;
    }
    debug_assert!(weights.iter().sum::<f64>() > 0.0, "the weights must have a positive sum");
    let mut centre = mean(points, weights);
    for _ in 0..MOST_STEPS {
        let [x, y] = Pull::at(centre, points, weights).step();
        centre = [centre[0] + x, centre[1] + y];
        if x.hypot(y) < LAST_STEP {
            break;
        }
    }
    let least = (1.0 - ROUNDING) * total_distance(centre, points, weights);
    let distances = points.iter().map(|&point| (total_distance(point, points, weights), point));
    match distances.min_by(|(a, _), (b, _)| a.total_cmp(b)) {
        Some((distance, point)) if distance < least => point,
        _ => centre,
    }
}

fn mean(points: &[[f64; 2]], weights: &[f64]) -> [f64; 2] {
    let total: f64 = weights.iter().sum();
    std::array::from_fn(|axis| {
        points.iter().zip(weights).map(|(point, weight)| weight * point[axis]).sum::<f64>() / total
    })
}

fn total_distance(centre: [f64; 2], points: &[[f64; 2]], weights: &[f64]) -> f64 {
    points.iter().zip(weights).map(|(&point, weight)| weight * squared_distance(point, centre).sqrt()).sum()
}

#[derive(Debug, Clone, Copy, Default)]
struct Pull {
    /// Total weight of the points at this place.
    here: f64,
    /// Sum of weight x direction over the others.
    sum: [f64; 2],
    /// Sum of weight / distance over the others.
    shares: f64,
}

impl Pull {
    fn at(place: [f64; 2], points: &[[f64; 2]], weights: &[f64]) -> Self {
        let mut pull = Self::default();
        for (point, weight) in points.iter().zip(weights) {
            let (x, y) = (point[0] - place[0], point[1] - place[1]);
            let share = weight / x.hypot(y);
            if share.is_finite() {
                pull.sum = [pull.sum[0] + share * x, pull.sum[1] + share * y];
                pull.shares += share;
            } else {
                pull.here += weight;
            }
        }
        pull
    }

    fn strength(&self) -> f64 {
        self.sum[0].hypot(self.sum[1])
    }

    /// Step to the mean with weights weight / distance; shortened at a place that has weight itself.
    fn step(&self) -> [f64; 2] {
        let strength = self.strength();
        if strength <= self.here {
            return [0.0; 2];
        }
        let length = (1.0 - self.here / strength) / self.shares;
        self.sum.map(|pull| length * pull)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_core::distance;
    use proptest::prelude::*;

    /// Found with scipy's Nelder-Mead search to 1e-10 m, outside this project.
    #[test]
    fn the_median_agrees_with_a_numerical_search() {
        let five = [[0.0, 0.0], [4.0, 1.0], [1.0, 5.0], [-2.0, 3.0], [2.5, 2.0]];
        let median = geometric_median(&five, &[1.0, 2.0, 0.5, 1.5, 0.7]);
        assert!(distance(median, [2.181_201_52, 1.726_761_91]) < 1e-3);
        let six = [[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [1.0, 9.0], [4.0, 3.0], [6.0, 5.0]];
        let weights = [0.1, 0.2, 0.15, 0.25, 0.2, 0.1];
        let median = geometric_median(&six, &weights);
        assert!(distance(median, [4.870_987_64, 4.120_806_82]) < 1e-3);
        let total = total_distance(median, &six, &weights);
        assert!((total - 4.902_558_409_6).abs() < 1e-7, "{total}");
    }

    /// A corner with an angle of 120 degrees is the median of its triangle; the iteration converges slowly there.
    #[test]
    fn a_corner_with_120_degrees_is_the_median() {
        let wide = [[0.0, 0.0], [1.0, 0.0], [-0.5, 0.75_f64.sqrt()]];
        for weight in [0.999, 1.0, 1.001] {
            let median = geometric_median(&wide, &[weight, 1.0, 1.0]);
            assert!(distance(median, [0.0; 2]) < 1e-2, "{weight}: {median:?}");
            // A weighted distance not larger than at the corner itself.
            assert!(weight < 1.0 || distance(median, [0.0; 2]) <= 0.0);
        }
    }

    /// Every point between them is equally good; the result is the midpoint, independent of rounding.
    #[test]
    fn two_equal_points_meet_half_way() {
        let median = geometric_median(&[[0.1, 0.2], [3.1, 4.2]], &[0.5; 2]);
        assert!(distance(median, [1.6, 2.2]) < 1e-9, "{median:?}");
        // A point of weight 0 changes nothing.
        let three = [[-1.0, 0.0], [1.0, 0.0], [0.5, 0.0]];
        let median = geometric_median(&three, &[0.5, 0.5, 0.0]);
        assert!(distance(median, [0.0, 0.0]) < 1e-9, "{median:?}");
    }

    proptest! {
        #[test]
        fn nothing_is_more_central(
            points in prop::collection::vec(
                (prop::array::uniform2(-9.0..9.0_f64), prop_oneof![Just(0.0), 0.001..1.0_f64]),
                1..20,
            ),
            (angle, way) in (0.0..6.3_f64, 0.01..1.0_f64),
        ) {
            let (points, mut weights): (Vec<_>, Vec<_>) = points.into_iter().unzip();
            weights[0] += 0.1;
            let median = geometric_median(&points, &weights);
            let cost = |point| total_distance(point, &points, &weights);
            let least = cost(median);
            let total: f64 = weights.iter().sum();
            for &point in &points {
                prop_assert!(least <= cost(point) * (1.0 + 1e-8), "{median:?} {point:?}");
            }
            let aside = [median[0] + way * angle.cos(), median[1] + way * angle.sin()];
            prop_assert!(least <= cost(aside) + 0.02 * total, "{median:?} {aside:?}");
        }
    }
}
