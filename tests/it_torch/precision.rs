//! Feed-forward blocks in bf16: nearly the same forecasts, the same guarantee, and told in reports.

use ddl::{
    Ddl, DeviceChoice, EvaluationRequest, EvaluationSplit, Forecaster as _, Precision, Protocol,
    Variant,
};
use ddl_tests::{crowd, tiny_model};
use std::ops::ControlFlow;
use std::path::Path;

fn in_bf16(folder: &Path) -> Ddl {
    let model = Ddl::load(folder, DeviceChoice::Cpu).unwrap();
    model.in_precision(Precision::Bf16).unwrap()
}

#[test]
fn forecasts_are_nearly_the_same_and_still_certified() {
    let windows = crowd::windows(6, 24);
    let tiny = tiny_model::of(Variant::Full);
    let reference = tiny.model.forecast_all(&windows).unwrap();
    let certified = in_bf16(tiny.folder()).forecast_certified(&windows).unwrap();
    let mut largest = 0.0_f64;
    for (reference, certified) in reference.iter().zip(&certified) {
        assert!(certified.first_violation().is_none());
        for i in 0..reference.pedestrians() {
            for k in 0..reference.hypotheses() {
                let [one, other] = [reference, &certified.forecast].map(|f| f.hypothesis(i, k));
                for (a, b) in one.iter().zip(other) {
                    largest = largest.max((a[0] - b[0]).hypot(a[1] - b[1]));
                }
            }
        }
    }
    assert!(largest > 1e-7, "nothing was rounded");
    assert!(largest < 0.05, "{largest} m");
}

#[test]
fn reports_name_it() {
    let tiny = tiny_model::of(Variant::Full);
    let model = in_bf16(tiny.folder());
    let request = EvaluationRequest {
        protocols: vec![Protocol::Single],
        on: EvaluationSplit::Test,
        validation_recordings: Vec::new(),
        test_walkers: Some(20),
        commit: String::new(),
    };
    let dataset = crowd::dataset();
    let evaluation =
        ddl::evaluate(&model, &dataset, &request, |_| ControlFlow::Continue(())).unwrap();
    for row in evaluation.rows {
        let conditions = row.conditions;
        let device = if conditions.variant.is_some() {
            "cpu, bf16"
        } else {
            "cpu"
        };
        assert_eq!(conditions.device, device, "{}", conditions.forecaster);
    }
}
