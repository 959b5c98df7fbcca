//! The decision among the windows that a sieve has left, in `f64`.

use crate::error::SoftDtwError;
use crate::refine::PairValue;
use crate::sliding::{Place, SlidingIndex, WindowNeighbour};
use crate::value::{finite, normalise};

/// A window and its distance to a query, or a bound below it.
#[derive(Clone, Copy, Debug)]
struct Ranked {
    distance: f64,
    window: usize,
}

impl<const D: usize> SlidingIndex<D> {
    /// The `wanted` nearest among `survivors`, in order.
    pub(super) fn decide(
        &self,
        query: &[[f64; D]],
        own: f64,
        survivors: &[usize],
        wanted: usize,
    ) -> Result<Vec<WindowNeighbour>, SoftDtwError> {
        let values = self.pair_values();
        let pairs = survivors.iter().map(|&window| (query, self.window(window)));
        let ranked = |window: usize, value: f64| Ranked {
            distance: normalise(value, own, self.self_values[window]),
            window,
        };
        let (mut found, mut beyond) = (Vec::with_capacity(survivors.len()), Vec::new());
        for (&window, value) in survivors.iter().zip(values.of(pairs)) {
            match value {
                PairValue::Known(value) => found.push(ranked(window, value)),
                PairValue::AtLeast(bound) => beyond.push(ranked(window, bound)),
            }
        }
        nearest_first(&mut found, wanted);
        if found.len() == wanted {
            let last = found[wanted - 1].distance;
            beyond.retain(|at_least| at_least.distance <= last);
        }
        if !beyond.is_empty() {
            let evaluate =
                |Ranked { window, .. }| ranked(window, values.beyond(query, self.window(window)));
            found.extend(beyond.into_iter().map(evaluate));
            nearest_first(&mut found, wanted);
        }
        let neighbour = |Ranked { distance, window }| {
            let Place { track, offset } = self.places[window];
            finite(distance).map(|distance| WindowNeighbour {
                track,
                offset,
                distance,
            })
        };
        found.into_iter().map(neighbour).collect()
    }
}

/// Leaves the `wanted` nearest (all, if there are fewer), in order, ties by window: windows are numbered by track and offset.
fn nearest_first(found: &mut Vec<Ranked>, wanted: usize) {
    let order = |a: &Ranked, b: &Ranked| {
        let distances = a.distance.total_cmp(&b.distance);
        distances.then(a.window.cmp(&b.window))
    };
    if wanted < found.len() {
        found.select_nth_unstable_by(wanted, order);
        found.truncate(wanted);
    }
    found.sort_unstable_by(order);
}
