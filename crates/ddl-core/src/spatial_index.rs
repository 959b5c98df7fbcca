//! A spatial index of positions, for the neighbours of pedestrians.

use crate::position::Position;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

/// A spatial index of places (m). The time of a query grows with the number of results, not with the number of places.
#[derive(Debug, Clone)]
pub struct SpatialIndex {
    tree: RTree<IndexedPlace>,
}

/// A position with its index.
type IndexedPlace = GeomWithData<Position, u32>;

impl SpatialIndex {
    /// An index of these positions (m, finite). A place is identified by its index in `positions`.
    #[must_use]
    pub fn new(positions: &[Position]) -> Self {
        let places = positions.iter().zip(0..).map(|(&position, index)| GeomWithData::new(position, index));
        Self { tree: RTree::bulk_load(places.collect()) }
    }

    /// Indices of the places within the box |dx| <= w and |dy| <= w around `centre`, in no order; w is the half width
    /// (m).
    pub fn within_box(&self, centre: Position, half_width_m: f64) -> impl Iterator<Item = usize> {
        self.around(centre, half_width_m)
            .filter(move |place| {
                let position = place.geom();
                (0..2).all(|axis| (position[axis] - centre[axis]).abs() <= half_width_m)
            })
            .map(|place| place.data as usize)
    }

    /// Indices of the `count` places nearest to `centre`, except the place `own`: nearest first, ties by index. All
    /// other places if there are fewer.
    #[must_use]
    pub fn nearest_others(&self, excluded: usize, centre: Position, count: usize) -> Vec<usize> {
        let distance = |position: &Position| (position[0] - centre[0]).hypot(position[1] - centre[1]);
        let nearest = self.tree.nearest_neighbor_iter(centre).take(count + 1);
        // The tree compares squared distances, whose rounding may change the order, so its result only bounds the
        // search.
        let reach = nearest.map(|place| distance(place.geom())).fold(0.0, f64::max);
        let others = self.around(centre, reach).map(|place| (distance(place.geom()), place.data as usize));
        let mut others: Vec<(f64, usize)> = others.filter(|&(_, other)| other != excluded).collect();
        others.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        others.truncate(count);
        others.into_iter().map(|(_, other)| other).collect()
    }

    /// All places within the box, and possibly some just outside: the corners of the box are rounded outwards.
    fn around(&self, centre: Position, half_width_m: f64) -> impl Iterator<Item = &IndexedPlace> {
        let size = half_width_m + centre[0].abs().max(centre[1].abs());
        let reach = half_width_m + 4.0 * f64::EPSILON * size;
        let corner = |sign: f64| centre.map(|x| x + sign * reach);
        self.tree.locate_in_envelope(AABB::from_corners(corner(-1.0), corner(1.0)))
    }
}
