//! Layout of the windows of all tracks: pieces of tracks, one per lane, sixteen in a group.

use ddl_simd::{LANES, Lanes};

use crate::blocks::{Narrowing, Step};

/// Largest number of windows of a piece. Longer tracks are cut, so that the similarities of a group stay in the cache.
const LONGEST_PIECE: usize = 64;

/// The windows of all tracks in `f32`, scaled and shifted.
#[derive(Clone, Debug)]
pub(super) struct WindowLayout<const D: usize> {
    pub(super) narrowing: Narrowing<D>,
    largest: f64,
    length: usize,
    groups: Vec<PieceGroup>,
    samples: Vec<Step<D>>,
    weights: Vec<Lanes>,
}

#[derive(Clone, Debug)]
struct PieceGroup {
    first_sample: usize,
    first_weight: usize,
    windows: usize,
    first_windows: [usize; LANES],
}

#[derive(Clone, Copy, Debug)]
pub(super) struct GroupView<'a, const D: usize> {
    /// Steps of the pieces; 0 after the end of a shorter piece.
    pub(super) samples: &'a [Step<D>],
    /// 2^(D(y, y) / 2) of each window, with D in log2 units; 0 where there is no window.
    pub(super) weights: &'a [Lanes],
    /// Number of the first window of each lane; the windows of a lane are consecutive.
    pub(super) first_windows: &'a [usize; LANES],
}

#[derive(Clone, Copy, Debug)]
struct Piece {
    track: usize,
    offset: usize,
    windows: usize,
    first_window: usize,
}

impl<const D: usize> WindowLayout<D> {
    /// Lays out the first `windows[t]` windows of `length` steps of every track t, whose D(y, y) are `self_values`,
    /// track by track.
    pub(super) fn new(
        gamma: f64,
        tracks: &[&[[f64; D]]],
        windows: &[usize],
        length: usize,
        self_values: &[f64],
    ) -> Self {
        let used = tracks
            .iter()
            .zip(windows)
            .filter(|&(_, &windows)| windows > 0)
            .flat_map(|(track, windows)| &track[..windows + length - 1]);
        let narrowing = Narrowing::new(gamma, used.clone());
        let mut layout = Self {
            narrowing,
            largest: narrowing.largest(used),
            length,
            groups: Vec::new(),
            samples: Vec::new(),
            weights: Vec::new(),
        };
        let mut pieces = pieces(windows);
        pieces.sort_by_key(|piece| std::cmp::Reverse(piece.windows));
        for members in pieces.chunks(LANES) {
            layout.push_group(tracks, members, self_values);
        }
        layout
    }

    fn push_group(&mut self, tracks: &[&[[f64; D]]], members: &[Piece], self_values: &[f64]) {
        let (first_sample, first_weight) = (self.samples.len(), self.weights.len());
        let windows = members.iter().map(|piece| piece.windows).max().unwrap_or(0);
        let steps = windows + self.length - 1;
        self.samples.resize(first_sample + steps, [Lanes::ZERO; D]);
        self.weights.resize(first_weight + windows, Lanes::ZERO);
        let scale = self.narrowing.scale;
        let mut first_windows = [0; LANES];
        for (lane, piece) in members.iter().enumerate() {
            first_windows[lane] = piece.first_window;
            let steps = &tracks[piece.track][piece.offset..][..piece.windows + self.length - 1];
            let narrow = self.narrowing.narrow(steps);
            for (sample, step) in self.samples[first_sample..].iter_mut().zip(narrow) {
                for (lanes, value) in sample.iter_mut().zip(step) {
                    lanes.0[lane] = value;
                }
            }
            let own = &self_values[piece.first_window..][..piece.windows];
            for (weight, own) in self.weights[first_weight..].iter_mut().zip(own) {
                let half_log2 = own * scale * scale / 2.0;
                weight.0[lane] = half_log2.exp2() as f32;
            }
        }
        self.groups.push(PieceGroup {
            first_sample,
            first_weight,
            windows,
            first_windows,
        });
    }

    pub(super) fn length(&self) -> usize {
        self.length
    }

    pub(super) fn groups(&self) -> impl Iterator<Item = GroupView<'_, D>> {
        self.groups.iter().map(|group| GroupView {
            samples: &self.samples[group.first_sample..][..group.windows + self.length - 1],
            weights: &self.weights[group.first_weight..][..group.windows],
            first_windows: &group.first_windows,
        })
    }

    /// Largest absolute value among the shifted and scaled components of the windows and of `query`.
    pub(super) fn largest_with(&self, query: &[[f64; D]]) -> f64 {
        self.largest.max(self.narrowing.largest(query.iter()))
    }
}

/// Divides the windows of all tracks into pieces. The pieces of a track have nearly equal lengths.
fn pieces(windows: &[usize]) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut first_window = 0;
    for (track, &windows) in windows.iter().enumerate() {
        let count = windows.div_ceil(LONGEST_PIECE);
        let mut offset = 0;
        for left in (1..=count).rev() {
            let windows = (windows - offset).div_ceil(left);
            pieces.push(Piece {
                track,
                offset,
                windows,
                first_window: first_window + offset,
            });
            offset += windows;
        }
        first_window += windows;
    }
    pieces
}
