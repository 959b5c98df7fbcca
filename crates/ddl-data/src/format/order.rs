//! Which of two columns counts the frames: the one along which each pedestrian moves in small steps.

use ddl_core::Position;

/// Rows that are looked at.
pub(super) const MOST_ROWS: usize = 10_000;
/// If the steps of one reading are so many times as long as those of the other, it is wrong.
const LONGER: f64 = 1.5;
/// If they are so many times as long, no other sign is looked at.
const MUCH_LONGER: f64 = 5.0;
/// If the tracks of one reading have so many times as many rows as those of the other, it is right.
const MORE: f64 = 2.0;

/// If the tracks of both readings have fewer rows in the mean, neither is right, unless there are few rows.
const LEAST: f64 = 1.1;
const FEW_ROWS: usize = 20;

/// What the first two of four or more columns are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Order {
    FrameFirst,
    PedestrianFirst,
    /// Both readings give tracks alike, or what speaks for one of them is contradicted.
    Unclear,
    /// In both readings nearly all pedestrians have one row.
    Neither,
}

struct TrackSteps {
    /// Median distance between successive rows of a pedestrian.
    step: f64,
    /// Rows per pedestrian.
    rows: f64,
    /// The greatest number that divides all differences of frames.
    unit: u64,
}

/// Finds the order from rows of the first two columns with a position. It is clear if nothing speaks against it, or if
/// the steps of one reading are five times as long.
pub(super) fn order(rows: &[([f64; 2], Position)]) -> Order {
    let rows = &rows[..rows.len().min(MOST_ROWS)];
    // Only times have fractions.
    let fractions = [0, 1].map(|column| rows.iter().any(|(of, _)| of[column].fract() != 0.0));
    let read = [0, 1].map(|frame| track_steps(rows, frame));
    let are_few = |tracks: &Option<TrackSteps>| tracks.as_ref().is_none_or(|tracks| tracks.rows < LEAST);
    if rows.len() > FEW_ROWS && read.iter().all(are_few) {
        return Order::Neither;
    }
    let (first, second) = match read {
        [_, None] => return Order::FrameFirst,
        [None, Some(second)] if second.unit > 1 || fractions[1] => return Order::PedestrianFirst,
        // One pedestrian, or all pedestrians of one frame.
        [None, Some(_)] => return Order::Unclear,
        [Some(first), Some(second)] => (first, second),
    };
    let unlike = |a: f64, b: f64, ratio: f64| a.max(b) > ratio * a.min(b);
    if unlike(first.step, second.step, MUCH_LONGER) {
        return if first.step < second.step { Order::FrameFirst } else { Order::PedestrianFirst };
    }
    let votes = [
        (fractions[0] != fractions[1]).then_some(fractions[0]),
        unlike(first.step, second.step, LONGER).then_some(first.step < second.step),
        // Frames of a film have a step, pedestrians are counted one by one.
        ((first.unit > 1) != (second.unit > 1)).then_some(first.unit > 1),
        unlike(first.rows, second.rows, MORE).then_some(first.rows > second.rows),
    ];
    let mut votes = votes.into_iter().flatten();
    match votes.next() {
        Some(vote) if votes.all(|other| other == vote) => {
            if vote {
                Order::FrameFirst
            } else {
                Order::PedestrianFirst
            }
        }
        _ => Order::Unclear,
    }
}

/// The tracks, if this column is the frame and the other one the pedestrian; `None` if no pedestrian has two rows.
fn track_steps(rows: &[([f64; 2], Position)], frame: usize) -> Option<TrackSteps> {
    let mut sorted: Vec<(f64, f64, Position)> = rows.iter().map(|(of, at)| (of[1 - frame], of[frame], *at)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let of_pedestrians = sorted.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq());
    let pedestrians = of_pedestrians.clone().count();
    let mut steps = Vec::new();
    let mut unit = 0;
    for track in of_pedestrians {
        for [before, row] in track.array_windows() {
            let [x, y] = [0, 1].map(|axis| row.2[axis] - before.2[axis]);
            steps.push(x.hypot(y));
            unit = greatest_divisor(unit, (row.1 - before.1) as u64);
        }
    }
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    let (_, &mut step, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    Some(TrackSteps { step, rows: rows.len() as f64 / pedestrians as f64, unit })
}

fn greatest_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { greatest_divisor(b, a % b) }
}
