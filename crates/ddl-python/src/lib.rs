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
    use crate::{
        baselines::baseline,
        dynamics::Flow,
        evaluation::{TestSet, conventions, evaluate_model, report, windows},
        forecasts::{region_radii, write_forecasts},
        goals::GoalEstimator,
        interruptible::set_num_threads,
        live::LiveHandle,
        metrics::{collisions, displacement_errors, kde_nll, mahalanobis, scores, spread_between},
        model::ForecastModel,
        program::main,
        recording::Recording,
        scene::FuturesHandle,
        soft_dtw::{SearchIndex, value, value_and_gradient},
    };

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::errors::word_settings();
        module.add("UNFAMILIAR", ddl::UNFAMILIAR_THRESHOLD)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
