//! Stars and arrows.

pub(crate) fn star([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    (0..10)
        .map(|corner| {
            let reach = if corner % 2 == 0 { radius } else { 0.42 * radius };
            let (sin, cos) = (f64::from(corner) * 36.0_f64).to_radians().sin_cos();
            [x + reach * sin, y - reach * cos]
        })
        .collect()
}

/// An arrow as two strokes, shaft and head; `None` when it is too short to be visible.
pub(crate) fn arrow(from: [f64; 2], to: [f64; 2]) -> Option<[Vec<[f64; 2]>; 2]> {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let length = dx.hypot(dy);
    if length < 2.0 {
        return None;
    }
    let head = (0.35 * length).clamp(2.5, 5.0);
    let [ux, uy] = [dx / length, dy / length];
    let side = |sign: f64| {
        [
            to[0] - head * ux - sign * 0.6 * head * uy,
            to[1] - head * uy + sign * 0.6 * head * ux,
        ]
    };
    Some([vec![from, to], vec![side(1.0), to, side(-1.0)]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_points_up_and_an_arrow_ahead() {
        let points = star([10.0, 10.0], 5.0);
        assert_eq!((points.len(), points[0]), (10, [10.0, 5.0]));
        let [shaft, head] = arrow([0.0, 0.0], [10.0, 0.0]).unwrap();
        assert_eq!((shaft[1], head[1]), ([10.0, 0.0], [10.0, 0.0]));
        assert!(head[0][0] < 10.0 && (head[0][1] + head[2][1]).abs() < 1e-12);
        assert_eq!(arrow([0.0, 0.0], [1.0, 1.0]), None);
    }
}
