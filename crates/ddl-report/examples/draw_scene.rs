//! Draws the most crowded test window of a fold: `draw_scene star zara1 12 scene.svg`
//! (convention, fold, greatest number of pedestrians, file to write).

use std::error::Error;

use ddl_data::{Convention, Dataset, Window, WindowRule, locate};
use ddl_eval::{
    ForecastError, Forecaster,
    baseline::{GoalSource, StraightLine, WeightedGoals},
};
use ddl_report::figure::SceneFigure;

/// A fan of goals around the point that constant velocity reaches: a stand-in for an estimator.
struct Fan;

impl GoalSource for Fan {
    fn name(&self) -> String {
        "a fan of goals".to_owned()
    }

    fn goals(&self, window: &Window) -> Result<Vec<WeightedGoals>, ForecastError> {
        let fan = |i: usize| {
            let observed = window.observed(i);
            let (first, last) = (observed[0], observed[7]);
            let ahead = [
                (last[0] - first[0]) / 7.0 * 12.0,
                (last[1] - first[1]) / 7.0 * 12.0,
            ];
            let turns = [-40.0, -20.0, -8.0, 0.0, 8.0, 20.0, 40.0_f64];
            let goals = turns.map(|turn| {
                let (sin, cos) = turn.to_radians().sin_cos();
                [
                    last[0] + cos * ahead[0] - sin * ahead[1],
                    last[1] + sin * ahead[0] + cos * ahead[1],
                ]
            });
            let weights = vec![0.02, 0.08, 0.2, 0.4, 0.2, 0.08, 0.02];
            Ok(WeightedGoals::new(goals.to_vec(), weights)?)
        };
        (0..window.len()).map(fan).collect()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [convention, fold, most, path] = arguments.as_slice() else {
        return Err("usage: draw_scene CONVENTION FOLD MOST_PEDESTRIANS FILE.svg".into());
    };
    let (convention, most): (Convention, usize) = (convention.parse()?, most.parse()?);
    let dataset = match convention {
        Convention::Simulated => Dataset::simulated(1),
        real => Dataset::load(real, &locate(real, None)?)?,
    };
    let windows = dataset.fold(fold)?.test_windows(WindowRule::Published);
    let fitting = windows.iter().filter(|window| window.len() <= most);
    let window = fitting
        .max_by_key(|window| window.len())
        .ok_or("no window is that small")?;
    let forecast = StraightLine::to(Fan).forecast(window)?;
    std::fs::write(path, SceneFigure::new(window, &forecast).to_svg()?)?;
    Ok(())
}
