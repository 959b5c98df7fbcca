//! Stars.

pub(crate) fn star([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    (0..10)
        .map(|corner| {
            let reach = if corner % 2 == 0 { radius } else { 0.42 * radius };
            let (sin, cos) = (f64::from(corner) * 36.0_f64).to_radians().sin_cos();
            [x + reach * sin, y - reach * cos]
        })
        .collect()
}

#[test]
fn a_star_points_up() {
    let points = star([10.0, 10.0], 5.0);
    assert_eq!((points.len(), points[0]), (10, [10.0, 5.0]));
}
