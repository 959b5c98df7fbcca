//! Forecasts of the built-in models agree with those of libtorch (`it_torch/golden_forecasts.rs` updates them).

use ddl::{BuiltinModel, Ddl, DeviceChoice};
use ddl_tests::golden::{self, Golden};

#[test]
fn built_in_models_agree_with_libtorch() {
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
