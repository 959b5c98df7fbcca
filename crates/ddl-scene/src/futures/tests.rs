use crate::fixture::{futures, with_deviation};

/// One who goes (1, -2) m/s or (0.5, 0.25) m/s, and whose scale grows by 0.1 m a step from a deviation of 0.3 m.
#[test]
fn positions_and_scales_by_hand() {
    let crowd = futures(
        &[[3.0, 4.0], [-1.0, 0.0]],
        &[vec![[1.0, -2.0], [0.5, 0.25]], vec![[0.0; 2]; 2]],
        &[0.6, 0.4],
        &[1.2, 0.6],
    );
    let crowd = with_deviation(&crowd, 0.3);
    for (time, moved, scale) in [
        (-1.0, 0.0, 0.3),
        (0.0, 0.0, 0.3),
        (0.1, 0.1, 0.25),
        (0.4, 0.4, 0.1),
        (1.0, 1.0, 0.25),
        (4.8, 4.8, 1.2),
        (9.0, 4.8, 1.2),
    ] {
        for (k, [x, y]) in [(0, [1.0, -2.0]), (1, [0.5, 0.25])] {
            let found = crowd.position(0, k, time);
            let off = [found[0] - 3.0 - moved * x, found[1] - 4.0 - moved * y];
            assert!(off.iter().all(|off| off.abs() < 1e-9), "{time} {k}: {found:?}");
        }
        let found = crowd.scale(0, time).unwrap();
        assert!((found - scale).abs() < 1e-9, "{time}: {found}");
    }
    assert_eq!((crowd.pedestrians(), crowd.present(1)), (2, [-1.0, 0.0]));
}
