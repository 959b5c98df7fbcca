//! The private module `_core` of the Python package `ddl_forecast`: arrays in, arrays out. The public API and its
//! documentation are in `python/ddl_forecast`; the signatures of this module are in `_core.pyi`.

#![allow(
    missing_docs,
    clippy::doc_markdown,
    clippy::needless_pass_by_value,
    clippy::too_many_arguments,
    clippy::type_complexity,
    clippy::unnecessary_wraps,
    reason = "signatures are Python's, and documented there"
)]

mod arrays;
mod baselines;
mod dynamics;
mod errors;
mod evaluation;
mod forecasts;
mod goals;
mod interruptible;
mod live;
mod metrics;
mod model;
mod moments;
mod observed;
mod program;
mod recording;
mod scene;
mod soft_dtw;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::baselines::baseline;
    #[pymodule_export]
    use crate::dynamics::Flow;
    #[pymodule_export]
    use crate::evaluation::{TestSet, conventions, evaluate_model, report, windows};
    #[pymodule_export]
    use crate::forecasts::{region_radii, write_forecasts};
    #[pymodule_export]
    use crate::goals::GoalEstimator;
    #[pymodule_export]
    use crate::interruptible::set_num_threads;
    #[pymodule_export]
    use crate::live::Live;
    #[pymodule_export]
    use crate::metrics::{collisions, displacement_errors, kde_nll, mahalanobis, scores, spread_between};
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::program::main;
    #[pymodule_export]
    use crate::recording::Recording;
    #[pymodule_export]
    use crate::scene::{clearances, occupancy, risks};
    #[pymodule_export]
    use crate::soft_dtw::{SearchIndex, value, value_and_gradient};

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("UNFAMILIAR", ddl::UNFAMILIAR_THRESHOLD)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
