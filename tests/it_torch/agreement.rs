//! The kernels against libtorch: forecasts of the built-in models on their test scenes.

use ddl::data::{Convention, Window, WindowRule};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecast, Forecaster, ModelSource, Remembering};
use ddl_core::distance;
use ddl_tests::recordings;
use std::io::Write as _;

/// One window in this many is forecast by both, unless `DDL_AGREEMENT_STRIDE` is set.
const STRIDE: usize = 50;

/// Goals farther apart than this (m) count as different: two partitions of the proposed endpoints were equally good,
/// and rounding decided.
const OTHER: f64 = 1e-3;

/// The largest differences between two forecasts: positions and goals (m), weights.
#[derive(Debug, Default)]
struct Difference {
    position: f64,
    goal: f64,
    weight: f64,
    pedestrians: usize,
    /// Pedestrians with different goals, which do not count above.
    others: usize,
}

impl Difference {
    fn add(&mut self, kernels: &Forecast, libtorch: &Forecast) {
        for i in 0..kernels.pedestrians() {
            let pairs: Vec<_> = (0..kernels.hypotheses())
                .map(|h| {
                    let [a, b] = [kernels, libtorch].map(|forecast| forecast.goal(i, h).unwrap());
                    let paths = kernels.hypothesis(i, h).iter().zip(libtorch.hypothesis(i, h));
                    let off = paths.fold(0.0_f64, |most, (&a, &b)| most.max(distance(a, b)));
                    let weight = kernels.weight(i, h) - libtorch.weight(i, h);
                    (distance(a, b), off, weight.abs())
                })
                .collect();
            if pairs.iter().any(|&(goal, ..)| goal > OTHER) {
                self.others += 1;
                continue;
            }
            self.pedestrians += 1;
            for (goal, position, weight) in pairs {
                self.goal = self.goal.max(goal);
                self.position = self.position.max(position);
                self.weight = self.weight.max(weight);
            }
        }
    }
}

#[test]
fn built_in_models_agree_with_libtorch_on_their_test_scenes() {
    let Some(dataset) = recordings::dataset(Convention::Star) else {
        return;
    };
    let stride = std::env::var("DDL_AGREEMENT_STRIDE").map_or(STRIDE, |text| text.parse().unwrap());
    for name in dataset.fold_names() {
        let source = ModelSource::Builtin(name.parse::<BuiltinModel>().unwrap());
        let kernels = Ddl::open(&source, DeviceChoice::Cpu).unwrap();
        let libtorch = Ddl::reference(&source).unwrap();
        let windows = dataset.fold(name).unwrap().test_windows(WindowRule::Published);
        let some: Vec<Window> = windows.into_iter().step_by(stride).collect();
        // Without and with remembered tracks.
        let remembering = kernels.goal_model().remembering(&some, &dataset, Remembering::Online);
        let mut difference = Difference::default();
        for window in some.iter().chain(&remembering.unwrap()) {
            let [a, b] = [&kernels, &libtorch].map(|model| Forecaster::forecast(model, window).unwrap());
            difference.add(&a, &b);
        }
        writeln!(std::io::stdout(), "{name}: {difference:?}").unwrap();
        assert!(difference.others * 1000 <= difference.pedestrians, "{name}: {difference:?}");
        assert!(difference.pedestrians > 20, "{name}: {difference:?}");
        assert!(difference.position < 1e-4, "{name}: {difference:?}");
        assert!(difference.goal < 1e-5 && difference.weight < 1e-5, "{name}: {difference:?}");
    }
}
