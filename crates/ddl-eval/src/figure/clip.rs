//! The parts of a path that lie within a rectangle.

use ddl_data::Position;

/// Cuts a path at the borders of a rectangle; a path that leaves and returns comes back in pieces.
///
/// Liang and Barsky, "A new concept and method for line clipping", ACM Transactions on Graphics 3(1),
/// 1984, one segment at a time.
pub(super) fn within(path: &[Position], low: Position, high: Position) -> Vec<Vec<Position>> {
    let mut pieces: Vec<Vec<Position>> = Vec::new();
    // Whether the path was inside where the segment before ended.
    let mut inside = false;
    for ends in path.windows(2) {
        let (a, b) = (ends[0], ends[1]);
        let Some((enter, leave)) = segment(a, b, low, high) else {
            inside = false;
            continue;
        };
        match pieces.last_mut() {
            Some(piece) if inside => piece.push(between(a, b, leave)),
            _ => pieces.push(vec![between(a, b, enter), between(a, b, leave)]),
        }
        inside = leave >= 1.0;
    }
    pieces
}

/// The part of a segment inside, as shares of its length; `None` when it stays outside.
fn segment(a: Position, b: Position, low: Position, high: Position) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let along = b[axis] - a[axis];
        if along == 0.0 {
            if !(low[axis]..=high[axis]).contains(&a[axis]) {
                return None;
            }
            continue;
        }
        let (s, t) = (
            (low[axis] - a[axis]) / along,
            (high[axis] - a[axis]) / along,
        );
        enter = enter.max(s.min(t));
        leave = leave.min(s.max(t));
    }
    (enter < leave).then_some((enter, leave))
}

fn between(a: Position, b: Position, share: f64) -> Position {
    if share >= 1.0 {
        return b;
    }
    [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]))
}

#[cfg(test)]
mod tests {
    use proptest::{collection::vec, prelude::*};

    use super::*;

    const LOW: Position = [0.0, 0.0];
    const HIGH: Position = [10.0, 4.0];

    #[test]
    fn a_path_that_leaves_and_returns_comes_in_two_pieces() {
        let path = [[2.0, 2.0], [4.0, 2.0], [4.0, 6.0], [6.0, 6.0], [6.0, 1.0]];
        let expected = vec![
            vec![[2.0, 2.0], [4.0, 2.0], [4.0, 4.0]],
            vec![[6.0, 4.0], [6.0, 1.0]],
        ];
        assert_eq!(within(&path, LOW, HIGH), expected);
    }

    #[test]
    fn a_segment_may_cross_the_whole_rectangle_or_miss_it() {
        assert_eq!(
            within(&[[-5.0, 1.0], [15.0, 1.0]], LOW, HIGH),
            vec![vec![[0.0, 1.0], [10.0, 1.0]]]
        );
        // Past the corner, though its box overlaps the rectangle.
        assert!(within(&[[8.0, 6.0], [12.0, 2.0]], LOW, [9.0, 4.0]).is_empty());
        assert!(within(&[[3.0, 3.0]], LOW, HIGH).is_empty());
    }

    #[test]
    fn somebody_who_stands_is_shown() {
        let path = [[3.0, 3.0]; 3];
        assert_eq!(within(&path, LOW, HIGH), vec![path.to_vec()]);
    }

    proptest! {
        #[test]
        fn nothing_lies_outside_and_nothing_inside_is_lost(
            path in vec((-15.0..25.0, -8.0..12.0_f64).prop_map(|(x, y)| [x, y]), 2..20)
        ) {
            let pieces = within(&path, LOW, HIGH);
            let inside = |p: &Position| (0..2).all(|d| (LOW[d] - 1e-9..=HIGH[d] + 1e-9).contains(&p[d]));
            prop_assert!(pieces.iter().flatten().all(inside));
            let strictly = |p: &&Position| (0..2).all(|d| LOW[d] < p[d] && p[d] < HIGH[d]);
            for point in path.iter().filter(strictly) {
                let near = |p: &Position| (p[0] - point[0]).hypot(p[1] - point[1]) < 1e-9;
                prop_assert!(pieces.iter().flatten().any(near));
            }
        }
    }
}
