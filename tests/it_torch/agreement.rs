//! The kernels against libtorch: forecasts of the built-in models on the scenes that they were trained without.

use ddl::data::{Convention, Dataset, Position, Window, WindowRule};
use ddl::eval::Forecast;
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecaster as _, ModelSource};
use ddl_tests::recordings;

/// One window of so many is forecast by both.
const STRIDE: usize = 50;

/// The largest differences between two forecasts: positions and goals (m), weights.
#[derive(Debug, Default)]
struct Difference {
    position: f64,
    goal: f64,
    weight: f64,
    pedestrians: usize,
}

fn apart(a: Position, b: Position) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

impl Difference {
    fn add(&mut self, kernels: &Forecast, libtorch: &Forecast) {
        for i in 0..kernels.pedestrians() {
            for h in 0..kernels.hypotheses() {
                let paths = kernels
                    .hypothesis(i, h)
                    .iter()
                    .zip(libtorch.hypothesis(i, h));
                self.position = paths.fold(self.position, |most, (&a, &b)| most.max(apart(a, b)));
                let goals = [kernels, libtorch].map(|forecast| forecast.goal(i, h).unwrap());
                self.goal = self.goal.max(apart(goals[0], goals[1]));
                let weights = kernels.weight(i, h) - libtorch.weight(i, h);
                self.weight = self.weight.max(weights.abs());
            }
        }
        self.pedestrians += kernels.pedestrians();
    }
}

#[test]
fn built_in_models_forecast_their_test_scenes_as_libtorch_does() {
    let Some(folder) = recordings::star_folder() else {
        return;
    };
    let dataset = Dataset::load(Convention::Star, &folder).unwrap();
    for name in dataset.fold_names() {
        let source = ModelSource::Builtin(name.parse::<BuiltinModel>().unwrap());
        let kernels = Ddl::open(&source, DeviceChoice::Cpu).unwrap();
        let libtorch = Ddl::reference(&source).unwrap();
        let windows = dataset
            .fold(name)
            .unwrap()
            .test_windows(WindowRule::Published);
        let some: Vec<&Window> = windows.iter().step_by(STRIDE).collect();
        let mut difference = Difference::default();
        for window in some {
            let [a, b] = [&kernels, &libtorch].map(|model| model.forecast(window).unwrap());
            difference.add(&a, &b);
        }
        assert!(difference.pedestrians > 20, "{name}: {difference:?}");
        assert!(difference.position < 1e-4, "{name}: {difference:?}");
        let exact = difference.goal < 1e-5 && difference.weight < 1e-5;
        assert!(exact, "{name}: {difference:?}");
    }
}
