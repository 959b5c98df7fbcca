//! Ground coordinates to pixels: one scale for both axes, y up.

use ddl_core::Position;

#[derive(Debug, Clone, Copy)]
pub(crate) struct PlanView {
    /// The ground position in the middle, metres.
    pub(crate) centre: Position,
    /// Its position in the picture, pixels.
    pub(crate) middle: [f64; 2],
    /// Pixels per metre.
    pub(crate) scale: f64,
}

impl PlanView {
    pub(crate) fn px(&self, place: Position) -> [f64; 2] {
        let [x, y] = [0, 1].map(|axis| self.scale * (place[axis] - self.centre[axis]));
        [self.middle[0] + x, self.middle[1] - y]
    }

    pub(crate) fn path<'a>(&self, places: impl IntoIterator<Item = &'a Position>) -> Vec<[f64; 2]> {
        places.into_iter().map(|place| self.px(*place)).collect()
    }
}
