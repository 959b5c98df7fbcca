//! Forecasts of the built-in models agree with those of libtorch (`it_torch/golden_forecasts.rs` updates them).

use ddl::{Ddl, DeviceChoice};
use ddl_tests::golden::{self, Golden};

#[test]
fn built_in_models_agree_with_libtorch() {
    golden::check(|model| Golden::of(&Ddl::builtin(model, DeviceChoice::Cpu).unwrap()));
}
