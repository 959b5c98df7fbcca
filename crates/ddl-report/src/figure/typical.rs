//! Typical pedestrians: for each kind of motion the one with the median error.

use ddl_eval::MotionKind;

/// Picks for each kind of motion the pedestrian whose error is the median of its kind.
///
/// Errors are in metres. Of an even number of errors the lower middle one is the median. Errors that are not finite are
/// ignored. The indices are in the order of [`MotionKind::ALL`].
pub fn typical_pedestrians(pedestrians: &[(MotionKind, f64)]) -> Vec<usize> {
    MotionKind::ALL
        .into_iter()
        .filter_map(|kind| typical_of(kind, pedestrians))
        .collect()
}

fn typical_of(kind: MotionKind, pedestrians: &[(MotionKind, f64)]) -> Option<usize> {
    let of_kind = |(_, pedestrian): &(usize, &(MotionKind, f64))| pedestrian.0 == kind;
    let mut errors: Vec<(f64, usize)> = pedestrians
        .iter()
        .enumerate()
        .filter(of_kind)
        .map(|(index, pedestrian)| (pedestrian.1, index))
        .filter(|(error, _)| error.is_finite())
        .collect();
    errors.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let median = errors.get(errors.len().checked_sub(1)? / 2)?.0;
    errors
        .into_iter()
        .find_map(|(error, index)| error.total_cmp(&median).is_eq().then_some(index))
}

#[cfg(test)]
mod tests {
    use proptest::{collection::vec, prelude::*};

    use super::*;

    proptest! {
        #[test]
        fn half_of_a_kind_is_no_better_and_half_no_worse(
            pedestrians in vec((0..6_usize, 0..9_u8), 0..60)
        ) {
            let error = |tenths: u8| if tenths == 0 { f64::NAN } else { f64::from(tenths) };
            let pedestrians: Vec<_> = pedestrians.into_iter().map(|(k, e)| (MotionKind::ALL[k], error(e))).collect();
            let picked = typical_pedestrians(&pedestrians);
            let first = |i: &usize| pedestrians.iter().position(|w| *w == pedestrians[*i]) == Some(*i);
            prop_assert!(picked.iter().all(first));
            let kinds: Vec<_> = picked.iter().map(|&i| pedestrians[i].0).collect();
            let has = |kind| pedestrians.iter().any(|w| w.0 == kind && w.1.is_finite());
            let present = MotionKind::ALL.into_iter().filter(|&kind| has(kind));
            prop_assert!(present.eq(kinds));
            for i in picked {
                let (kind, error) = pedestrians[i];
                let count = |holds: &dyn Fn(f64) -> bool| {
                    pedestrians.iter().filter(|w| w.0 == kind && w.1.is_finite() && holds(w.1)).count()
                };
                let all = count(&|_| true);
                prop_assert!(2 * count(&|e| e <= error) >= all && 2 * count(&|e| e >= error) >= all);
            }
        }
    }
}
