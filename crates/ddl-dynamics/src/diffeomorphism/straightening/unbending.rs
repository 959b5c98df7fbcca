//! A curve that straightens gradually without stretching.

use nalgebra::{DMatrix, SMatrix, SVD, SVector};

use crate::polar::polar;

/// Two directions this close to opposite define no plane of rotation (approximately radians).
const OPPOSITE: f64 = 1e-6;

/// Iterations of the singular value decomposition allowed per dimension; a few are usual.
const ITERATIONS_PER_DIMENSION: usize = 1000;

/// A polygon, stored as the length of each side and the direction of the next side in the frame transported without
/// twist (Bishop's frame). Scaling all turns by the same factor unbends it like a wire.
pub(super) struct Unbending<const D: usize> {
    lengths: Vec<f64>,
    first: SVector<f64, D>,
    /// Direction of each further side in the frame of the side before it.
    turns: Vec<SVector<f64, D>>,
}

impl<const D: usize> Unbending<D> {
    /// The sides and turns of the polygon through `points`.
    ///
    /// # Errors
    /// The index of the first point at which the polygon turns by 180 degrees or repeats a point.
    pub(super) fn new(points: &[SVector<f64, D>]) -> Result<Self, usize> {
        let sides: Vec<_> = points.windows(2).map(|pair| polar(&(pair[1] - pair[0]))).collect();
        if let Some(point) = sides.iter().position(|(length, _)| *length == 0.0) {
            return Err(point);
        }
        let directions: Vec<_> = sides.iter().map(|(_, direction)| *direction).collect();
        let mut frame = SMatrix::<f64, D, D>::identity();
        let mut turns = Vec::with_capacity(directions.len());
        for (index, pair) in directions.windows(2).enumerate() {
            if (pair[0] + pair[1]).norm() < OPPOSITE {
                return Err(index + 1);
            }
            turns.push(frame.transpose() * pair[1]);
            frame = rotation(&pair[0], &pair[1], 1.0) * frame;
        }
        Ok(Self {
            lengths: sides.iter().map(|(length, _)| *length).collect(),
            first: directions[0],
            turns,
        })
    }

    /// The polygon with every turn scaled by `bend`, aligned to `over` by a rotation and a translation (in the sense of
    /// least squares).
    pub(super) fn placed(&self, bend: f64, over: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let mut frame = SMatrix::<f64, D, D>::identity();
        let mut end = self.first * self.lengths[0];
        let mut points = vec![SVector::zeros(), end];
        for (turn, length) in self.turns.iter().zip(&self.lengths[1..]) {
            frame *= rotation(&self.first, turn, bend);
            end += frame * self.first * *length;
            points.push(end);
        }
        let (from, to) = (centroid(&points), centroid(over));
        let mut covariance = SMatrix::<f64, D, D>::zeros();
        for (point, place) in points.iter().zip(over) {
            covariance += (place - to) * (point - from).transpose();
        }
        let turn = nearest_rotation(&covariance);
        for point in &mut points {
            *point = turn * (*point - from) + to;
        }
        points
    }
}

fn centroid<const D: usize>(points: &[SVector<f64, D>]) -> SVector<f64, D> {
    points.iter().sum::<SVector<f64, D>>() / points.len() as f64
}

/// The rotation, in the plane of two unit vectors, by `share` of the angle from one to the other.
fn rotation<const D: usize>(from: &SVector<f64, D>, to: &SVector<f64, D>, share: f64) -> SMatrix<f64, D, D> {
    let cosine = from.dot(to);
    let (sine, across) = polar(&(to - from * cosine));
    if sine == 0.0 {
        return SMatrix::identity();
    }
    let (sine, cosine) = (sine.atan2(cosine) * share).sin_cos();
    let plane = from * from.transpose() + across * across.transpose();
    let quarter = across * from.transpose() - from * across.transpose();
    SMatrix::identity() + plane * (cosine - 1.0) + quarter * sine
}

/// The rotation `R` that maximises `tr(R^T M)` (Kabsch): `U diag(1, .., 1, ±1) V^T` of the singular value decomposition
/// of `M`, the sign such that `det R = 1`.
fn nearest_rotation<const D: usize>(matrix: &SMatrix<f64, D, D>) -> SMatrix<f64, D, D> {
    // Negligible entries are set to 0, because the decomposition would divide by their squares, which underflow, and
    // return NaN.
    let counts = f64::EPSILON * f64::EPSILON * matrix.amax();
    let general = DMatrix::from_fn(D, D, |row, column| {
        let entry = matrix[(row, column)];
        if entry.abs() < counts { 0.0 } else { entry }
    });
    let decomposition = SVD::try_new(general, true, true, f64::EPSILON, ITERATIONS_PER_DIMENSION * D);
    let finite = |(u, v_t): &(DMatrix<f64>, DMatrix<f64>)| u.iter().chain(v_t).all(|entry| entry.is_finite());
    let factors = decomposition.and_then(|svd| svd.u.zip(svd.v_t));
    // This has not occurred since negligible entries are set to 0. The identity is a valid rotation, but farther from
    // the optimum.
    let Some((mut u, v_t)) = factors.filter(finite) else {
        return SMatrix::identity();
    };
    if (&u * &v_t).determinant() < 0.0 {
        // The singular values are sorted; the last one is the smallest.
        u.column_mut(D - 1).neg_mut();
    }
    let product = u * v_t;
    SMatrix::from_fn(|row, column| product[(row, column)])
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};

    use super::*;

    #[test]
    fn a_helix_unbends() {
        let points: Vec<_> = (0..40)
            .map(|i| {
                let t = f64::from(i) * 0.2;
                Vector3::new(t.cos(), t.sin(), 0.3 * t)
            })
            .collect();
        let unbending = Unbending::new(&points).unwrap();
        for (point, placed) in points.iter().zip(unbending.placed(1.0, &points)) {
            assert!((point - placed).norm() < 1e-13);
        }
        let placed = unbending.placed(0.0, &points);
        let sides = points.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        assert!(((placed[39] - placed[0]).norm() - sides.sum::<f64>()).abs() < 1e-12);
    }

    #[test]
    fn half_unbending_halves_a_right_angle() {
        // Sides along x and y: half unbent, the angle between them is 45 degrees.
        let corner = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(Vector2::from);
        let placed = Unbending::new(&corner).unwrap().placed(0.5, &corner);
        let cosine = (placed[1] - placed[0]).dot(&(placed[2] - placed[1]));
        assert!((cosine - 0.5_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn placing_never_mirrors() {
        let corner = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]].map(Vector2::from);
        let mirrored = corner.map(|p| Vector2::new(p.x, -p.y));
        let placed = Unbending::new(&corner).unwrap().placed(1.0, &mirrored);
        let (a, b) = (placed[1] - placed[0], placed[2] - placed[1]);
        assert!((a.perp(&b) - 2.0).abs() < 1e-14);
    }

    #[test]
    fn entries_too_small_to_square_are_handled() {
        for tiny in [2.68e-163, 1e-200, 5e-324] {
            let mut covariance = SMatrix::<f64, 3, 3>::zeros();
            covariance[(2, 2)] = 0.09;
            covariance[(0, 2)] = tiny;
            covariance[(2, 0)] = -tiny;
            let turn = nearest_rotation(&covariance);
            assert!((turn * turn.transpose() - SMatrix::identity()).norm() < 1e-12);
            assert!((turn[(2, 2)] - 1.0).abs() < 1e-12, "{turn}");
        }
    }
}
