//! Figures as SVG, which need neither a display nor a font file.
//!
//! - [`scene()`]: one scene with its forecasts;
//! - [`place()`]: the tracks of a place.
//!
//! Maps show metres at one scale for both axes. Colours are those of the [page](crate::page).

mod axes;
pub(crate) mod cut;
pub(crate) mod drawing;
mod legend;
pub(crate) mod marks;
pub(crate) mod pedestrian;
mod place;
pub(crate) mod plan;
pub(crate) mod scale;
mod scene;
mod traffic;

pub use place::place;
pub use scene::scene;
