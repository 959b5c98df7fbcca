//! Weighted points in the plane; equal points are merged.

/// Limit of the coordinates (m), below which sums of squares are finite.
const LARGEST: f64 = 1e150;

/// Whether squared distances of such a point stay finite; false for NaN.
pub(crate) fn is_in_range(point: [f64; 2]) -> bool {
    point.iter().all(|value| value.abs() < LARGEST)
}

/// Points with weights; [`Points::distinct`] uses multiplicities as weights.
#[derive(Debug, Default)]
pub(crate) struct Points {
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) weight: Vec<f64>,
}

impl Points {
    /// The distinct points, sorted, with their multiplicities, and the index among them of each given point.
    pub(crate) fn distinct(points: &[[f64; 2]]) -> (Self, Vec<usize>) {
        // Adding 0 turns −0 into +0, so that they are one point.
        let clean = |index: usize| points[index].map(|value| value + 0.0);
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_unstable_by(|&a, &b| {
            let (a, b) = (clean(a), clean(b));
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
        });
        let mut distinct = Self::default();
        let mut place = vec![0; points.len()];
        for same in order.chunk_by(|&a, &b| clean(a).map(f64::to_bits) == clean(b).map(f64::to_bits)) {
            for &index in same {
                place[index] = distinct.len();
            }
            distinct.push(clean(same[0]), same.len() as f64);
        }
        (distinct, place)
    }

    pub(crate) fn push(&mut self, [x, y]: [f64; 2], weight: f64) {
        self.x.push(x);
        self.y.push(y);
        self.weight.push(weight);
    }

    pub(crate) fn len(&self) -> usize {
        self.x.len()
    }

    pub(crate) fn get(&self, index: usize) -> [f64; 2] {
        [self.x[index], self.y[index]]
    }

    pub(crate) fn mean_variance(&self) -> f64 {
        let total: f64 = self.weight.iter().sum();
        let weighted_sum = |values: &mut dyn Iterator<Item = f64>| -> f64 {
            values.zip(&self.weight).map(|(value, weight)| value * weight).sum()
        };
        let variances = [&self.x, &self.y].map(|values| {
            let mean = weighted_sum(&mut values.iter().copied()) / total;
            weighted_sum(&mut values.iter().map(|value| (value - mean).powi(2))) / total
        });
        f64::midpoint(variances[0], variances[1])
    }
}

#[inline]
pub(crate) fn squared_distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}
