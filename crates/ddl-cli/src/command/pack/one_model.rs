//! Packs one model.

use ddl::{Ddl, DeviceChoice, ModelSource};
use std::path::Path;

/// Writes the packed model, and returns the number of its weights.
pub(super) fn pack(model: &Path, out: &Path) -> anyhow::Result<usize> {
    let model = Ddl::open(&ModelSource::named(model), DeviceChoice::Cpu)?;
    model.pack(out)?;
    Ok(model.parameter_count() + model.goal_model().parameter_count())
}
