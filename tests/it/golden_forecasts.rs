//! Forecasts of the built-in models agree with those of libtorch (`it_torch/golden_forecasts.rs` updates them).

use ddl::{BuiltinModel, Ddl, DeviceChoice};
use ddl_tests::golden::{self, Golden};

#[test]
fn built_in_models_agree_with_libtorch() {
    let file = golden::file();
    for model in BuiltinModel::ALL {
        let computed = Golden::of(&Ddl::builtin(model, DeviceChoice::Cpu).unwrap());
        let stored = &file[model.name()];
        assert_eq!(computed.len(), stored.len());
        for (computed, stored) in computed.iter().zip(stored) {
            computed.assert_near(stored, model.name());
        }
    }
}
