//! The built-in model.

use crate::exchange::Failure;
use ddl::{BuiltinModel, Ddl, DeviceChoice};
use std::cell::OnceCell;
use std::sync::Arc;

/// The built-in model, loaded once.
pub(crate) fn model() -> Result<Arc<Ddl>, Failure> {
    thread_local!(static MODEL: OnceCell<Arc<Ddl>> = const { OnceCell::new() });
    MODEL.with(|loaded| {
        if let Some(model) = loaded.get() {
            return Ok(Arc::clone(model));
        }
        let model = Ddl::builtin(BuiltinModel::World, DeviceChoice::Cpu)?;
        Ok(Arc::clone(loaded.get_or_init(|| Arc::new(model))))
    })
}
