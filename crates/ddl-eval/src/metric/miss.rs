//! Misses: pedestrians whose end no hypothesis comes near.
//!
//! ```text
//! miss_i = [ min_k FDE_{i,k} > d ]        miss rate = mean of miss_i, in [0, 1]
//! ```
//!
//! d is 0.5 m; the rates for 1 m and 2 m are measured beside it, because works differ. Benchmarks of cars
//! use 2 m (Argoverse); at walking speed that forgives almost everything.

use super::displacement::DisplacementErrors;

/// The distance beyond which an end counts as missed, metres.
pub const MISS_DISTANCE: f64 = 0.5;
/// It, and the distances of other works; metres.
pub const MISS_DISTANCES: [f64; 3] = [MISS_DISTANCE, 1.0, 2.0];

/// Whether every hypothesis of pedestrian `i` ends farther than `threshold` metres from the truth.
///
/// # Examples
/// ```
/// use ddl_data::{PedestrianId, Window};
/// use ddl_eval::metric::{displacement::DisplacementErrors, miss::is_miss};
/// use ddl_eval::{Forecast, Scene};
///
/// let walk = (0..20).map(|t| [0.5 * f64::from(t), 0.0]).collect(); // ends at (9.5, 0) m
/// let window = Window::new("yard", 0, 10, vec![PedestrianId(1)], vec![walk])?;
/// let ends_early = (8..20).map(|t| [0.4 * f64::from(t), 0.0]).collect(); // at (7.6, 0) m
/// let forecast = Forecast::equally_likely(1, 1, ends_early)?;
/// let errors = DisplacementErrors::of(&Scene::new(&window, &forecast)?);
/// assert!(is_miss(&errors, 0, 0.5) && !is_miss(&errors, 0, 2.0)); // 1.9 m off
/// assert!(!is_miss(&errors, 0, errors.min_fde(0))); // the distance itself is not beyond it
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn is_miss(errors: &DisplacementErrors, i: usize, threshold: f64) -> bool {
    errors.min_fde(i) > threshold
}
