//! Which tracks a full memory forgets.

use std::cmp::Reverse;
use std::collections::HashMap;

use crate::track::Track;

/// Sides of the squares of place (m) and of velocity (twice 0.4 m/s) in which two tracks are of one kind.
const PLACE: f64 = 2.0;
const VELOCITY: f32 = 2.0;

/// Where and how fast somebody was in the middle of the track.
type Kind = [i64; 4];

fn kind(track: &Track) -> Option<Kind> {
    let motion = track.pieces.get(track.pieces.len() / 2)?.motion();
    let [x, y] = motion.now.map(|place| (place / PLACE).floor() as i64);
    let [u, v, ..] = motion
        .velocities
        .map(|speed| (speed / VELOCITY).floor() as i64);
    Some([x, y, u, v])
}

/// Removes tracks of the older half until so many stretches are gone: first those with the most newer tracks of their
/// kind, of these the oldest. Returns how many stretches went: 0 only where there is no track.
pub(crate) fn forget(tracks: &mut Vec<Track>, wanted: usize) -> usize {
    let mut kinds: HashMap<Option<Kind>, usize> = HashMap::new();
    let mut newer_alike = vec![0_usize; tracks.len()];
    for (newer, track) in newer_alike.iter_mut().zip(tracks.iter()).rev() {
        let seen = kinds.entry(kind(track)).or_default();
        *newer = *seen;
        *seen += 1;
    }
    let mut order: Vec<usize> = (0..tracks.len().div_ceil(2)).collect();
    order.sort_by_key(|&index| Reverse(newer_alike[index]));
    let mut goes = vec![false; tracks.len()];
    let mut gone = 0;
    for index in order {
        if gone >= wanted {
            break;
        }
        goes[index] = true;
        gone += tracks[index].stretches();
    }
    let mut goes = goes.into_iter();
    tracks.retain(|_| !goes.next().unwrap_or(false));
    gone
}
