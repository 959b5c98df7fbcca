//! Where the learned numbers of a layer stand.

/// Sizes of an encoder layer.
///
/// Its learned numbers stand one after the other, matrices by rows: weight `[3 width, width]` and bias of queries, keys
/// and values; weight and bias of the map after attention; of the feed-forward block the weight `[hidden, width]` and bias
/// before `ReLU` and those after it; weight and bias of the first normalisation and of the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Numbers of a token.
    pub width: usize,
    /// Attention heads, a divisor of the width.
    pub heads: usize,
    /// Hidden units of the feed-forward block.
    pub hidden: usize,
}

/// Pieces that [`Sizes`] names.
const PIECES: usize = 12;

impl Sizes {
    /// Learned numbers in all.
    pub fn count(self) -> usize {
        self.lengths().iter().sum()
    }

    fn lengths(self) -> [usize; PIECES] {
        let Self { width, hidden, .. } = self;
        [
            3 * width * width,
            3 * width,
            width * width,
            width,
            hidden * width,
            hidden,
            width * hidden,
            width,
            width,
            width,
            width,
            width,
        ]
    }

    /// The pieces of a layer's learned numbers.
    pub(super) fn pieces(self, mut numbers: &[f32]) -> [&[f32]; PIECES] {
        self.check(numbers);
        self.lengths()
            .map(|length| numbers.split_off(..length).unwrap_or_default())
    }

    /// The same, to be written.
    pub(super) fn pieces_mut(self, mut numbers: &mut [f32]) -> [&mut [f32]; PIECES] {
        self.check(numbers);
        self.lengths()
            .map(|length| numbers.split_off_mut(..length).unwrap_or_default())
    }

    fn check(self, numbers: &[f32]) {
        assert_eq!(
            numbers.len(),
            self.count(),
            "learned numbers of an encoder layer"
        );
    }
}
