//! Scenes: the pedestrians of each, and the visibility between them.

use std::ops::Range;

/// The pedestrians of several scenes, in sequence, with visibility masks for each of several frames.
///
/// Memory and time grow with the number of pairs that are visible to each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scenes {
    ranges: Vec<Range<usize>>,
    frames: usize,
    /// For each frame, scene and pair of queries: the keys visible to at least one of the two, ascending.
    seen: Vec<SeenKey>,
    /// For each pair of queries: the end of its keys in `seen`.
    ends: Vec<usize>,
    /// For each scene: the first of its pairs in the `ends` of a frame; last, the number of pairs in a frame.
    starts: Vec<usize>,
}

/// A key, and the queries of a pair to which it is visible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SeenKey(u32);

impl SeenKey {
    /// Index in the scene.
    pub(super) fn key(self) -> usize {
        (self.0 >> 2) as usize
    }

    /// Bit r: whether it is visible to query r of the pair.
    pub(super) fn code(self) -> usize {
        (self.0 & 3) as usize
    }
}

/// The visibility in some of the frames of [`Scenes`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct SceneFrames<'a> {
    scenes: &'a Scenes,
    first: usize,
    count: usize,
}

/// One scene in one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneView<'a> {
    /// Index of the first pedestrian among those of all scenes.
    pub(super) first: usize,
    pub(super) pedestrians: usize,
    seen: &'a [SeenKey],
    /// Start of the first pair's keys in `seen`, and the end of each pair's keys.
    start: usize,
    ends: &'a [usize],
}

impl<'a> SceneView<'a> {
    /// The keys visible to the pedestrians 2 `two` and 2 `two` + 1, ascending.
    pub(super) fn keys_of(self, two: usize) -> &'a [SeenKey] {
        let start = two.checked_sub(1).map_or(self.start, |i| self.ends[i]);
        &self.seen[start..self.ends[two]]
    }
}

impl Scenes {
    /// Scenes of `sizes` pedestrians with their visibility in every frame.
    ///
    /// # Shapes
    /// `seen`: for each frame, scene and pedestrian, the ascending indices, within its scene, of the pedestrians that
    /// it sees, including itself.
    ///
    /// # Panics
    /// If there is no scene, or an empty one. If `seen` does not have a whole number of frames (at least one). If a
    /// pedestrian does not see itself. If indices are not ascending or not in the scene.
    pub(crate) fn new(sizes: &[usize], seen: impl IntoIterator<Item = Vec<u32>>) -> Self {
        assert!(!sizes.is_empty(), "at least one scene is needed");
        assert!(sizes.iter().all(|&size| size > 0), "a scene has at least one pedestrian: {sizes:?}");
        let mut ranges = Vec::with_capacity(sizes.len());
        let (mut pedestrians, mut starts) = (0, vec![0]);
        for size in sizes {
            ranges.push(pedestrians..pedestrians + size);
            pedestrians += size;
            starts.push(starts[starts.len() - 1] + size.div_ceil(2));
        }
        let mut scenes = Self { ranges, frames: 0, seen: Vec::new(), ends: Vec::new(), starts };
        let mut lists = seen.into_iter().peekable();
        while lists.peek().is_some() {
            for &size in sizes {
                for first in (0..size).step_by(2) {
                    let mut list = |query: usize| {
                        let list = lists.next();
                        let list =
                            list.unwrap_or_else(|| panic!("visibility is not of a number of frames of {pedestrians}"));
                        check(&list, query, size);
                        list
                    };
                    let even = list(first);
                    // If the number of queries is odd, a padding query has the visibility of the last one, so that its
                    // weights are finite.
                    let odd = (first + 1 < size).then(|| list(first + 1));
                    scenes.push(&even, odd.as_deref().unwrap_or(&even));
                }
            }
            scenes.frames += 1;
        }
        assert!(scenes.frames > 0, "visibility of at least one frame is needed");
        scenes
    }

    fn push(&mut self, mut even: &[u32], mut odd: &[u32]) {
        loop {
            let next = [even, odd].map(|list| list.first().copied().unwrap_or(u32::MAX));
            let key = next[0].min(next[1]);
            if key == u32::MAX {
                break;
            }
            let sees = next.map(|first| first == key);
            even = &even[usize::from(sees[0])..];
            odd = &odd[usize::from(sees[1])..];
            let code = u32::from(sees[0]) + 2 * u32::from(sees[1]);
            self.seen.push(SeenKey(key << 2 | code));
        }
        self.ends.push(self.seen.len());
    }

    /// Number of pedestrians in all scenes.
    pub fn pedestrians(&self) -> usize {
        self.ranges.last().map_or(0, |last| last.end)
    }

    /// The index range of the pedestrians of each scene.
    pub fn ranges(&self) -> &[Range<usize>] {
        &self.ranges
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// The ordered pairs of pedestrians, indexed over all scenes, of which the first is one of `queries` and sees the
    /// second in a frame.
    ///
    /// # Panics
    /// If the frame does not exist.
    pub fn pairs(&self, frame: usize, queries: Range<usize>) -> impl Iterator<Item = (usize, usize)> + '_ {
        let Range { start, end } = queries;
        let first = self.ranges.partition_point(|scene| scene.end <= start);
        let scenes = self.during(frame..frame + 1).of_entry(0).skip(first).take_while(move |scene| scene.first < end);
        scenes.flat_map(move |scene| {
            let within = |i: usize| i.saturating_sub(scene.first).min(scene.pedestrians);
            (within(start)..within(end)).flat_map(move |i| {
                let seen = scene.keys_of(i / 2).iter();
                let seen = seen.filter(move |seen| seen.code() >> (i % 2) & 1 == 1);
                seen.map(move |seen| (scene.first + i, scene.first + seen.key()))
            })
        })
    }

    /// The visibility in `frames`. A single frame is used for all entries of a batch, several for one entry each.
    ///
    /// # Panics
    /// If the range is empty or a frame does not exist.
    pub(crate) fn during(&self, frames: Range<usize>) -> SceneFrames<'_> {
        assert!(frames.start < frames.end && frames.end <= self.frames, "frames {frames:?} of {}", self.frames);
        SceneFrames { scenes: self, first: frames.start, count: frames.len() }
    }

    #[cfg(test)]
    pub(super) fn throughout(&self) -> SceneFrames<'_> {
        self.during(0..self.frames)
    }
}

fn check(seen: &[u32], query: usize, size: usize) {
    assert!(
        seen.is_sorted_by(|a, b| a < b) && seen.last().is_none_or(|&last| (last as usize) < size),
        "whom a pedestrian sees are ascending indices of its scene of {size}"
    );
    let sees_itself = seen.binary_search(&(query as u32)).is_ok();
    assert!(sees_itself, "every pedestrian sees itself");
}

impl<'a> SceneFrames<'a> {
    pub(super) fn scenes(self) -> &'a Scenes {
        self.scenes
    }

    /// The scenes of a batch entry, in the order of the pedestrians.
    pub(super) fn of_entry(self, entry: usize) -> impl Iterator<Item = SceneView<'a>> {
        let scenes = self.scenes;
        let frame = self.first + if self.count == 1 { 0 } else { entry };
        let per_frame = scenes.ends.len() / scenes.frames;
        let places = scenes.starts.array_windows().map(move |&[start, end]| {
            let before = frame * per_frame;
            before + start..before + end
        });
        scenes.ranges.iter().zip(places).map(|(range, place)| SceneView {
            first: range.start,
            pedestrians: range.len(),
            seen: &scenes.seen,
            start: place.start.checked_sub(1).map_or(0, |i| scenes.ends[i]),
            ends: &scenes.ends[place],
        })
    }

    /// Panics if the number of frames does not fit a batch of `entries`.
    pub(super) fn check(self, entries: usize) {
        assert!(
            self.count == 1 || self.count == entries,
            "{} frames of visibility for {entries} batch entries",
            self.count
        );
    }

    /// Number of pairs of a query and a visible key in a batch of `entries`.
    pub(super) fn pairs(self, entries: usize) -> usize {
        2 * self.scenes.seen.len() / self.scenes.frames * entries
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::tests::numbers::{assert_refused, lists};

    #[test]
    fn two_queries_share_a_code() {
        let visible = [
            true, // a scene of one
            true, true, false, // a scene of three
            false, true, true, //
            true, false, true,
        ];
        let both = [visible, [true; 10]].concat();
        let scenes = Scenes::new(&[1, 3], lists(&[1, 3], &both));
        assert_eq!((scenes.pedestrians(), scenes.frames()), (4, 2));
        assert_eq!(scenes.ranges(), [0..1, 1..4]);
        let codes_of = |frames: SceneFrames<'_>, entry| -> Vec<Vec<(usize, usize)>> {
            let twos = frames.of_entry(entry).flat_map(|scene| (0..scene.ends.len()).map(move |i| scene.keys_of(i)));
            twos.map(|seen| seen.iter().map(|seen| (seen.key(), seen.code()))).map(Iterator::collect).collect()
        };
        let first = [vec![(0, 3)], vec![(0, 1), (1, 3), (2, 2)], vec![(0, 3), (2, 3)]];
        let visible = [(0, 3), (1, 3), (2, 3)];
        let visible = [visible[..1].to_vec(), visible.to_vec(), visible.to_vec()];
        assert_eq!(codes_of(scenes.throughout(), 0), first);
        assert_eq!(codes_of(scenes.throughout(), 1), visible);
        assert_eq!(codes_of(scenes.during(0..1), 1), first);
        assert_eq!(codes_of(scenes.during(1..2), 5), visible);
        let pairs = [(0, 0), (1, 1), (1, 2), (2, 2), (2, 3), (3, 1), (3, 3)];
        assert_eq!(scenes.pairs(0, 0..4).collect::<Vec<_>>(), pairs);
        assert_eq!(scenes.pairs(0, 1..3).collect::<Vec<_>>(), pairs[1..5]);
        assert_eq!(scenes.pairs(1, 0..9).count(), 10);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let refused = |said, sizes: &[usize], seen: &[&[u32]]| {
            let seen = seen.iter().map(|list| list.to_vec());
            assert_refused(said, || drop(Scenes::new(sizes, seen)));
        };
        refused("every pedestrian sees itself", &[2], &[&[0, 1], &[0]]);
        refused("not of a number of frames of 2", &[2], &[&[0], &[1], &[0]]);
        refused("at least one frame", &[2], &[]);
        refused("at least one pedestrian", &[2, 0], &[&[0], &[1]]);
        refused("ascending indices of its scene of 2", &[2], &[&[0, 2], &[1]]);
        refused("ascending indices of its scene of 2", &[2], &[&[1, 0], &[1]]);
        assert_refused("frames 1..3 of 2", || {
            let _ = Scenes::new(&[1], [vec![0], vec![0]]).during(1..3);
        });
    }
}
