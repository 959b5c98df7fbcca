//! Which pedestrians stand in which scene, and who sees whom.

use std::ops::Range;

/// The pedestrians of several scenes, one scene after the other, with who sees whom in each of several frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scenes {
    ranges: Vec<Range<usize>>,
    frames: usize,
    /// Bit r of a code: the pedestrian 2 i + r sees pedestrian j. By frame, scene, i and j.
    codes: Vec<u8>,
    /// Where the codes of each scene start within a frame, and where they end.
    starts: Vec<usize>,
}

/// Who sees whom in some of the frames of [`Scenes`].
#[derive(Clone, Copy, Debug)]
pub struct Frames<'a> {
    scenes: &'a Scenes,
    first: usize,
    count: usize,
}

/// One scene in one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneCodes<'a> {
    /// Number of the first pedestrian.
    pub(super) first: usize,
    pub(super) pedestrians: usize,
    /// For every two queries, what they see of every key: see [`Scenes`].
    pub(super) codes: &'a [u8],
}

impl Scenes {
    /// Scenes of `sizes` pedestrians, with who sees whom in every frame.
    ///
    /// # Shapes
    /// `visible`: for each frame, for each scene, `[size, size]`; the entry (i, j) says that i sees j.
    ///
    /// # Panics
    /// When there is no scene or an empty one, when `visible` is not a whole number of frames (at least one), or when
    /// a pedestrian does not see itself.
    pub fn new(sizes: &[usize], visible: &[bool]) -> Self {
        assert!(!sizes.is_empty(), "at least one scene is needed");
        assert!(
            sizes.iter().all(|&size| size > 0),
            "a scene has at least one pedestrian: {sizes:?}"
        );
        let pairs: usize = sizes.iter().map(|size| size * size).sum();
        assert!(
            !visible.is_empty() && visible.len().is_multiple_of(pairs),
            "{} entries of visibility are not a number of frames of {pairs}",
            visible.len()
        );
        let mut ranges = Vec::with_capacity(sizes.len());
        let (mut pedestrians, mut starts) = (0, vec![0]);
        for size in sizes {
            ranges.push(pedestrians..pedestrians + size);
            pedestrians += size;
            starts.push(starts[starts.len() - 1] + size.div_ceil(2) * size);
        }
        let mut codes = Vec::with_capacity(visible.len() / 2);
        for frame in visible.chunks_exact(pairs) {
            let mut rest = frame;
            for &size in sizes {
                let (scene, later) = rest.split_at(size * size);
                rest = later;
                let sees_itself = scene.iter().step_by(size + 1).all(|&visible| visible);
                assert!(sees_itself, "every pedestrian sees itself");
                for two in scene.chunks(2 * size) {
                    let (even, odd) = two.split_at(size);
                    codes.extend((0..size).map(|key| {
                        // The query that fills up an odd number sees everything, so that its weights are finite.
                        let odd = odd.get(key).copied().unwrap_or(true);
                        u8::from(even[key]) + 2 * u8::from(odd)
                    }));
                }
            }
        }
        Self {
            ranges,
            frames: visible.len() / pairs,
            codes,
            starts,
        }
    }

    /// Pedestrians in all scenes together.
    pub fn pedestrians(&self) -> usize {
        self.ranges.last().map_or(0, |last| last.end)
    }

    /// The pedestrians of each scene.
    pub fn ranges(&self) -> &[Range<usize>] {
        &self.ranges
    }

    /// Frames with visibility of their own.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Who sees whom in `frames`: one frame stands for every entry of a batch, several for one entry each.
    ///
    /// # Panics
    /// When the frames are none or not there.
    pub fn during(&self, frames: Range<usize>) -> Frames<'_> {
        assert!(
            frames.start < frames.end && frames.end <= self.frames,
            "frames {frames:?} of {}",
            self.frames
        );
        Frames {
            scenes: self,
            first: frames.start,
            count: frames.len(),
        }
    }

    #[cfg(test)]
    pub(super) fn throughout(&self) -> Frames<'_> {
        self.during(0..self.frames)
    }
}

impl<'a> Frames<'a> {
    pub(super) fn scenes(self) -> &'a Scenes {
        self.scenes
    }

    /// The scenes of a batch entry, in the order of the pedestrians.
    pub(super) fn of_entry(self, entry: usize) -> impl Iterator<Item = SceneCodes<'a>> {
        let scenes = self.scenes;
        let frame = self.first + if self.count == 1 { 0 } else { entry };
        let per_frame = scenes.codes.len() / scenes.frames;
        let codes = &scenes.codes[frame * per_frame..][..per_frame];
        let within = scenes.starts.windows(2).map(|ends| ends[0]..ends[1]);
        scenes
            .ranges
            .iter()
            .zip(within)
            .map(|(range, within)| SceneCodes {
                first: range.start,
                pedestrians: range.len(),
                codes: &codes[within],
            })
    }

    /// Panics unless a batch of `entries` can have these frames.
    pub(super) fn check(self, entries: usize) {
        assert!(
            self.count == 1 || self.count == entries,
            "{} frames of visibility for {entries} batch entries",
            self.count
        );
    }

    /// Queries times keys in a batch of `entries`.
    pub(super) fn pairs(self, entries: usize) -> usize {
        let squares = self.scenes.ranges.iter().map(|range| range.len().pow(2));
        entries * squares.sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::tests::numbers::assert_refused;

    #[test]
    fn two_queries_share_a_code() {
        let visible = [
            true, // a scene of one
            true, true, false, // a scene of three
            false, true, true, //
            true, false, true,
        ];
        let both = [visible, [true; 10]].concat();
        let scenes = Scenes::new(&[1, 3], &both);
        assert_eq!((scenes.pedestrians(), scenes.frames()), (4, 2));
        assert_eq!(scenes.ranges(), [0..1, 1..4]);
        let of = |frames: Frames<'_>, entry| -> Vec<Vec<u8>> {
            frames
                .of_entry(entry)
                .map(|scene| scene.codes.to_vec())
                .collect()
        };
        let (first, all) = ([vec![3], vec![1, 3, 2, 3, 2, 3]], [vec![3], vec![3; 6]]);
        assert_eq!(of(scenes.throughout(), 0), first);
        assert_eq!(of(scenes.throughout(), 1), all);
        assert_eq!(of(scenes.during(0..1), 1), first);
        assert_eq!(of(scenes.during(1..2), 5), all);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let refused = |said, sizes: &[usize], visible: &[bool]| {
            assert_refused(said, || drop(Scenes::new(sizes, visible)));
        };
        refused(
            "every pedestrian sees itself",
            &[2],
            &[true, true, true, false],
        );
        refused("9 entries of visibility", &[2], &[true; 9]);
        refused("at least one pedestrian", &[2, 0], &[true; 4]);
        assert_refused("frames 1..3 of 2", || {
            let _ = Scenes::new(&[1], &[true; 2]).during(1..3);
        });
    }
}
