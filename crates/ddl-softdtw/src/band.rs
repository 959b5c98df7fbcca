//! The Sakoe-Chiba band, which limits the cells that a warping path may pass.

use std::ops::RangeInclusive;

/// Sakoe-Chiba band: warping paths stay within `radius` steps of the diagonal.
///
/// ```text
/// cell (i, j), from 0, is in the band when |i (m − 1) − j (n − 1)| ≤ max(radius, 1/2) · (max(n, m) − 1)
/// ```
///
/// For sequences of equal length that is |i − j| ≤ radius. For unequal lengths the diagonal is the straight line from
/// the first pair to the last, and the radius counts steps of the shorter sequence. Half a step is always allowed, so
/// every band contains a path. The band of (y, x) is the transposed band of (x, y).
///
/// # References
/// Sakoe & Chiba, *Dynamic programming algorithm optimization for spoken word recognition*, IEEE TASSP 26 (1978).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Band {
    radius: usize,
}

impl Band {
    /// The band of `radius` steps on either side of the diagonal.
    pub const fn new(radius: usize) -> Self {
        Self { radius }
    }

    /// Steps on either side of the diagonal.
    pub const fn radius(self) -> usize {
        self.radius
    }

    /// Columns of row `row` in the band of a `rows` × `columns` grid; never empty, and both ends grow with the row.
    pub(crate) fn columns(self, row: usize, rows: usize, columns: usize) -> RangeInclusive<usize> {
        let wide = |length: usize| length as u128;
        let last = columns - 1;
        if rows == 1 {
            return 0..=last;
        }
        // 2 |i (m − 1) − j (n − 1)| ≤ reach, solved for j. A radius above both lengths does not limit the paths.
        let longer = wide(rows.max(columns));
        let reach = (2 * wide(self.radius).min(longer)).max(1) * (longer - 1);
        let centre = 2 * wide(row) * wide(last);
        let spacing = 2 * wide(rows - 1);
        let first = centre.saturating_sub(reach).div_ceil(spacing) as usize;
        let end = ((centre + reach) / spacing).min(wide(last)) as usize;
        first..=end
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::Band;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn ranges_hold_the_cells_of_the_definition_and_are_connected(
            n in 1..40_usize, m in 1..40_usize, radius in 0..45_usize,
        ) {
            let reach = (2 * radius).max(1) * (n.max(m) - 1);
            let mut before = 0..=0;
            for i in 0..n {
                let range = Band::new(radius).columns(i, n, m);
                for j in 0..m {
                    let inside = 2 * (i * (m - 1)).abs_diff(j * (n - 1)) <= reach;
                    prop_assert_eq!(range.contains(&j), inside, "cell {} {}", i, j);
                }
                // A path can step from the row above into this one, and both ends only grow.
                prop_assert!(range.start() <= range.end() && *range.start() <= before.end() + 1);
                prop_assert!(range.start() >= before.start() && range.end() >= before.end());
                before = range;
            }
            prop_assert_eq!(*before.end(), m - 1);
        }
    }
}
