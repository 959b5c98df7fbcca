//! Forecasts of the built-in models as libtorch computes them (`it_torch/golden_forecasts.rs` renews them).

use ddl::{BuiltinModel, Ddl, DeviceChoice};
use ddl_tests::golden::{self, Golden};

#[test]
fn built_in_models_forecast_as_libtorch_did() {
    let file = golden::file();
    for model in BuiltinModel::ALL {
        let found = Golden::of(&Ddl::builtin(model, DeviceChoice::Cpu).unwrap());
        let known = &file[model.name()];
        assert_eq!(found.len(), known.len());
        for (found, known) in found.iter().zip(known) {
            found.assert_near(known, model.name());
        }
    }
}
