//! Which tracks a model was trained on, as hashes: they tell a recording again, and hold no positions.
//!
//! A track crosses the lines of a grid. Six crossings in a row, each with its place on the line to 10 cm, make a
//! hash. It is the same in another file of the recording: at other times or another rate, rounded to centimetres, with
//! other names, cut, with exchanged axes, or backwards. Of a recording in the files of two conventions 27 % (`eth`,
//! whose rows lie at other times there) to 99 % of the hashes agree (`tests/it/known_recordings.rs` demands 20 %). Of
//! other pedestrians at the same place 0.8 % agree: the second half of `bi_corr_400_b_03` of Jülich, 240 people in a
//! corridor, after the first; the share grows with their number. Who walks less than 5 m has no hash.

use ddl_core::Position;
use ddl_data::Recording;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeSet;

/// Crossings of a hash.
const CROSSINGS: usize = 6;
/// Distance of the lines, and length of a cell on them (m).
const LINES: f64 = 1.0;
const CELL: f64 = 0.1;
/// Lines and borders of cells lie here beside round numbers (m), where rounding to centimetres moves little across.
const OFF_LINE: f64 = 0.0049;
const OFF_CELL: f64 = 0.005;
/// A longer step (m) is no walk: another track begins.
const LONGEST_STEP: f64 = 5.0;
/// At most this many hashes are kept, 128 KiB.
const MOST: usize = 1 << 15;
/// A recording is known from this share of its hashes on.
const KNOWN: f64 = 0.15;
/// Fewer hashes than this agree by chance.
const FEWEST: usize = 3;

/// Hashes of the tracks that a model was trained on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TrackFingerprints {
    /// Only hashes that are a multiple of this power of two are kept.
    one_in: u32,
    /// In ascending order.
    hashes: Vec<u32>,
}

impl TrackFingerprints {
    /// The hashes of these tracks (m).
    pub(crate) fn of(tracks: impl IntoIterator<Item = impl IntoIterator<Item = Position>>) -> Self {
        Self::limited(1, tracks.into_iter().flat_map(hashes).collect())
    }

    /// The hashes of both.
    #[cfg(any(test, feature = "training"))]
    pub(crate) fn with(&self, other: &Self) -> Self {
        let hashes = self.hashes.iter().chain(&other.hashes).copied().collect();
        Self::limited(self.one_in.max(other.one_in), hashes)
    }

    fn limited(mut one_in: u32, mut hashes: BTreeSet<u32>) -> Self {
        hashes.retain(|hash| hash % one_in == 0);
        while hashes.len() > MOST {
            one_in *= 2;
            hashes.retain(|hash| hash % one_in == 0);
        }
        Self { one_in, hashes: hashes.into_iter().collect() }
    }

    /// The share of the hashes of recordings, which may be parts of one, that are known, if the model was trained on
    /// them.
    pub(crate) fn known(&self, recordings: &[&Recording]) -> Option<f64> {
        self.known_from(KNOWN, recordings)
    }

    /// Whether so few hashes are known that the model has not even been trained on a part of the recording.
    pub(crate) fn is_unknown(&self, recording: &Recording) -> bool {
        self.known_from(KNOWN / 5.0, &[recording]).is_none()
    }

    fn known_from(&self, least: f64, recordings: &[&Recording]) -> Option<f64> {
        let all = recordings.iter().flat_map(|recording| tracks_of(recording)).flat_map(hashes);
        let all: BTreeSet<u32> = all.filter(|hash| hash % self.one_in == 0).collect();
        let known = all.iter().filter(|hash| self.hashes.binary_search(hash).is_ok()).count();
        let share = known as f64 / all.len().max(1) as f64;
        (known >= FEWEST && share >= least).then_some(share)
    }

    /// Little-endian numbers of 32 bits: the divisor, then the hashes.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        std::iter::once(&self.one_in).chain(&self.hashes).flat_map(|number| number.to_le_bytes()).collect()
    }

    /// Reads what [`to_bytes`](Self::to_bytes) has written; `None` for anything else.
    pub(crate) fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (numbers, []) = bytes.as_chunks::<4>() else {
            return None;
        };
        let mut numbers = numbers.iter().copied().map(u32::from_le_bytes);
        let one_in = numbers.next()?;
        let hashes: Vec<u32> = numbers.collect();
        let fits = one_in.is_power_of_two() && hashes.len() <= MOST && hashes.is_sorted();
        fits.then_some(Self { one_in, hashes })
    }
}

/// The tracks of a recording.
pub(crate) fn tracks_of(recording: &Recording) -> Vec<Vec<Position>> {
    let mut rows: Vec<_> = recording.observations().iter().collect();
    rows.sort_by_key(|row| row.pedestrian);
    let tracks = rows.chunk_by(|a, b| a.pedestrian == b.pedestrian);
    tracks.map(|track| track.iter().map(|row| row.position).collect()).collect()
}

/// Where a track crosses a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Crossing {
    /// Of the line x = constant (0) or y = constant.
    axis: usize,
    line: i64,
    cell: i64,
}

fn hashes(track: impl IntoIterator<Item = Position>) -> Vec<u32> {
    let mut hashes = Vec::new();
    let mut crossings: Vec<Crossing> = Vec::new();
    let mut before: Option<Position> = None;
    for position in track {
        if let Some(before) = before.replace(position) {
            if (position[0] - before[0]).hypot(position[1] - before[1]) > LONGEST_STEP {
                crossings.clear();
                continue;
            }
            for crossing in crossings_of(before, position) {
                // Whoever stands on a line crosses it again and again.
                if crossings.last() != Some(&crossing) {
                    crossings.push(crossing);
                    hashes.extend(crossings.last_chunk().map(hash));
                }
            }
        }
    }
    hashes
}

/// The lines that a step crosses, in order.
fn crossings_of(from: Position, to: Position) -> Vec<Crossing> {
    let mut crossings: Vec<(f64, Crossing)> = Vec::new();
    for axis in [0, 1] {
        let number = |position: Position| ((position[axis] - OFF_LINE) / LINES).floor() as i64;
        let (start, end) = (number(from), number(to));
        for line in start.min(end) + 1..=start.max(end) {
            let share = (line as f64 * LINES + OFF_LINE - from[axis]) / (to[axis] - from[axis]);
            let along = from[1 - axis] + share * (to[1 - axis] - from[1 - axis]);
            let cell = ((along - OFF_CELL) / CELL).floor() as i64;
            crossings.push((share, Crossing { axis, line, cell }));
        }
    }
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
    crossings.into_iter().map(|(_, crossing)| crossing).collect()
}

/// The hash of these crossings, of both directions and with either name of the axes.
fn hash(crossings: &[Crossing; CROSSINGS]) -> u32 {
    let exchanged = crossings.map(|crossing| Crossing { axis: 1 - crossing.axis, ..crossing });
    let backwards = |mut crossings: [Crossing; CROSSINGS]| {
        crossings.reverse();
        crossings
    };
    let first = (*crossings).min(exchanged).min(backwards(*crossings)).min(backwards(exchanged));
    let mut hasher = Sha256::new();
    for Crossing { axis, line, cell } in first {
        for number in [axis as i64, line, cell] {
            hasher.update(number.to_le_bytes());
        }
    }
    let [a, b, c, d, ..]: [u8; 32] = hasher.finalize().into();
    u32::from_le_bytes([a, b, c, d])
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_core::PedestrianId;
    use ddl_data::{Dataset, Observation};

    fn fingerprints_of(recordings: &[Recording]) -> TrackFingerprints {
        TrackFingerprints::of(recordings.iter().flat_map(tracks_of))
    }

    fn changed(recording: &Recording, change: impl Fn(Observation) -> Option<Observation>) -> Recording {
        let rows = recording.observations().iter().copied();
        Recording::new("other", recording.frame_step(), rows.filter_map(change).collect()).unwrap()
    }

    /// What another file of the same recording may change, and how much of it must be known then.
    #[test]
    fn a_recording_is_known_again() {
        let recordings = Dataset::simulated(3).recordings().to_vec();
        let learned = fingerprints_of(&recordings[..2]);
        let first = &recordings[0];
        let half = first.frames()[first.frames().len() / 2];
        let known = |least: f64, change: &dyn Fn(Observation) -> Option<Observation>| {
            let share = learned.known(&[&changed(first, change)]).unwrap();
            assert!(share >= least, "{share} {least}");
        };
        known(1.0, &Some);
        let in_centimetres = |row: Observation, whole: fn(f64) -> f64| {
            let position = row.position.map(|x| whole(100.0 * x) / 100.0);
            Some(Observation { position, ..row })
        };
        known(0.8, &|row| in_centimetres(row, f64::round));
        known(0.5, &|row| in_centimetres(row, f64::floor));
        known(1.0, &|row| {
            let [x, y] = row.position;
            let position = [y, x];
            Some(Observation { position, ..row })
        });
        known(1.0, &|row| {
            let frame = 70_000 - 3 * row.frame;
            Some(Observation { frame, ..row })
        });
        known(1.0, &|row| (row.frame >= half).then_some(row));
        // Every other row is lost.
        known(0.3, &|row| (row.frame / first.frame_step() % 2 == 0).then_some(row));
        for other in &recordings[2..] {
            assert_eq!(learned.known(&[other]), None, "{}", other.name());
        }
    }

    /// A step of (2.2, 1.1) m crosses x = 1.0049 at 0.320 of its way, where y = 0.602, y = 1.0049 at 0.686 (x = 1.810)
    /// and x = 2.0049 at 0.775 (y = 1.102). The hash was computed with Python: the least of the four orders is
    /// backwards with exchanged axes.
    #[test]
    fn crossings_and_their_hash_by_hand() {
        let crossing = |(axis, line, cell)| Crossing { axis, line, cell };
        let (from, to) = ([0.3, 0.25], [2.5, 1.35]);
        let mut expected = [(0, 1, 5), (1, 1, 18), (0, 2, 10)].map(crossing);
        assert_eq!(crossings_of(from, to), expected);
        expected.reverse();
        assert_eq!(crossings_of(to, from), expected);
        let six = [(0, 3, 14), (1, -2, 31), (0, 4, -7), (0, 5, -2), (1, -1, 52), (1, 0, 58)];
        assert_eq!(hash(&six.map(crossing)), 183_163_768);
        let ahead = |steps: std::ops::Range<i32>| steps.map(|t| [0.3 + 0.4 * f64::from(t), 7.3]);
        // The lines 1 to 8; then the same ones with a jump after the fourth; then who goes to and fro over one line.
        assert_eq!(hashes(ahead(0..21)).len(), 3);
        assert_eq!(hashes(ahead(0..11).chain(ahead(50..60))).len(), 0);
        assert_eq!(hashes((0..40).map(|t| [0.9 + 0.2 * f64::from(t % 2), 0.3])).len(), 0);
    }

    /// A straight walk over 25 lines has 20 hashes.
    #[test]
    fn three_hashes_and_their_share_make_a_recording_known() {
        let row = |t: i32| Observation::new(i64::from(t), PedestrianId(1), [0.3 + 0.5 * f64::from(t), 0.3]);
        let known = |lines: i32, learned: usize| {
            let recording = Recording::new("other", 1, (0..2 * lines).map(row).collect()).unwrap();
            let all = fingerprints_of(std::slice::from_ref(&recording)).hashes;
            assert_eq!(all.len() as i32, lines - 6);
            let some = TrackFingerprints::limited(1, all.into_iter().take(learned).collect());
            (some.known(&[&recording]), some.is_unknown(&recording))
        };
        assert_eq!(known(26, 3), (Some(0.15), false));
        assert_eq!(known(27, 3), (None, false));
        assert_eq!(known(18, 2), (None, true));
        assert_eq!(known(106, 3), (None, false));
        assert_eq!(known(107, 3), (None, true));
    }

    #[test]
    fn as_many_hashes_as_fit_are_kept_as_bytes() {
        let recordings = Dataset::simulated(3).recordings().to_vec();
        let all = fingerprints_of(&recordings);
        let both = fingerprints_of(&recordings[..2]).with(&fingerprints_of(&recordings[2..]));
        assert_eq!(all, both);
        assert!(all.hashes.len() > 1000 && all.hashes.len() <= MOST);
        let many = TrackFingerprints::limited(1, (0..100_000).collect());
        assert_eq!((many.one_in, many.hashes.len()), (4, 25_000));
        let fewer = TrackFingerprints::limited(1, (0..10).collect());
        assert_eq!(fewer.with(&many), many.with(&fewer));
        assert_eq!(fewer.with(&many), many);
        let bytes = all.to_bytes();
        assert_eq!(TrackFingerprints::from_bytes(&bytes), Some(all));
        for wrong in [&bytes[1..], &[3, 0, 0, 0], &[]] {
            assert_eq!(TrackFingerprints::from_bytes(wrong), None);
        }
    }
}
