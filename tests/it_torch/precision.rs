//! Feed-forward blocks in bf16: nearly the same forecasts, the same guarantee, and told in reports.

use ddl::star::EpochReport;
use ddl::{
    Ddl, DeviceChoice, EvaluationRequest, EvaluationSplit, Forecaster as _, Precision, Protocol,
    RunDirectory, Variant,
};
use ddl_tests::{crowd, tiny_model};
use std::ops::ControlFlow;
use std::path::Path;

const FOLD: &str = "plaza";

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
        test_walkers: Some(20),
        commit: String::new(),
    };
    let dataset = crowd::dataset();
    let rows = ddl::evaluate(&model, &dataset, &request, |_| ControlFlow::Continue(())).unwrap();
    for row in rows {
        let conditions = row.conditions;
        let device = if conditions.variant.is_some() {
            "cpu, bf16"
        } else {
            "cpu"
        };
        assert_eq!(conditions.device, device, "{}", conditions.forecaster);
    }
}

#[test]
fn training_in_bf16_goes_nearly_the_same_way() {
    let losses = |precision| {
        let folder = tempfile::tempdir().unwrap();
        let mut request = tiny_model::request(FOLD, Variant::Full, 40, folder.path());
        request.precision = precision;
        tiny_model::train(&request, &crowd::dataset());
        let run = RunDirectory::new(folder.path());
        let losses = run
            .metrics()
            .unwrap()
            .into_iter()
            .map(|epoch: EpochReport| epoch.loss);
        (losses.collect::<Vec<f64>>(), run.config().unwrap().device)
    };
    let (reference, cpu) = losses(Precision::F32);
    let (rounded, cpu_in_bf16) = losses(Precision::Bf16);
    assert_eq!((cpu.as_str(), cpu_in_bf16.as_str()), ("cpu", "cpu, bf16"));
    for (reference, rounded) in reference.iter().zip(&rounded) {
        let apart = (rounded / reference - 1.0).abs();
        assert!(apart > 0.0 && apart < 0.05, "{reference} and {rounded}");
    }
}
