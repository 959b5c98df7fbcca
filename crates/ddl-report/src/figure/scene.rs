//! One scene: the past, future and forecast of every pedestrian.

use crate::error::ReportError;
use crate::figure::axes::{Axes, SCENE};
use crate::figure::drawing::{Drawing, PLOT_STYLE};
use crate::figure::legend::{self, LegendSample};
use crate::figure::pedestrian;
use crate::snapshot::{ForecastSnapshot, SnapshotPedestrian};
use ddl_core::{Disc, Forecast, HORIZON, OBSERVED, Position, Window};

/// Probability that the drawn region contains the pedestrian at the end of the horizon.
const LEVEL: f64 = 0.9;

/// Draws the pedestrians of a window and their forecast as the text of an SVG file. The same input gives the same
/// bytes.
///
/// # Errors
/// The forecast is not of the window's pedestrians.
pub fn scene(window: &Window, forecast: &Forecast) -> Result<String, ReportError> {
    let seen = |i: usize| window.track(i)[OBSERVED..].to_vec();
    let seen: Vec<Vec<Position>> = (0..window.len()).map(seen).collect();
    let moment = ForecastSnapshot::under_way("", window, forecast, &seen).map_err(|_| {
        let (expected, found) = (window.len(), forecast.pedestrians());
        ReportError::Pedestrians { expected, found }
    })?;
    let drawn = &moment.pedestrians;
    let axes = Axes::around(&extent(drawn), &SCENE);
    let [width, height] = axes.size();
    let heading = format!("{}, from frame {}", window.recording(), window.start_frame());
    let mut drawing = Drawing::new(width, height, &heading);
    axes.draw(&mut drawing);
    axes.draw_names(&mut drawing);
    let [[left, top], [right, _]] = axes.frame();
    drawing.text("heading", [left, top - 18.0], heading);
    legend::draw_column(&mut drawing, [right + 20.0, top], &entries(window, forecast));
    drawing.within(axes.frame(), |drawing| {
        for disc in regions(forecast) {
            drawing.circle("region", axes.plan.px(disc.centre), axes.plan.scale * disc.radius);
        }
        for pedestrian in drawn {
            pedestrian::other_hypotheses(drawing, &axes.plan, pedestrian);
        }
        for pedestrian in drawn {
            pedestrian::representative_goal(drawing, &axes.plan, pedestrian);
        }
        for pedestrian in drawn {
            let (observed, truth) = (&pedestrian.observed, &pedestrian.truth);
            drawing.path("seen", &axes.plan.path(observed));
            pedestrian::track(drawing, &axes.plan, observed, truth);
        }
        for pedestrian in drawn {
            pedestrian::representative(drawing, &axes.plan, pedestrian);
        }
    });
    Ok(drawing.to_file(PLOT_STYLE))
}

/// The discs of all pedestrians; empty for forecasts without regions.
fn regions(forecast: &Forecast) -> impl Iterator<Item = Disc> {
    (0..forecast.pedestrians()).flat_map(|i| forecast.region(i, HORIZON - 1, LEVEL).unwrap_or_default())
}

fn entries(window: &Window, forecast: &Forecast) -> Vec<(LegendSample, &'static str)> {
    let several = forecast.hypotheses() > 1;
    let mut entries = vec![(LegendSample::Observed, "observed, 3.2 s")];
    if window.has_future() {
        entries.push((LegendSample::Truth, "truth, 4.8 s, and its end"));
    }
    if several {
        entries.extend([
            (LegendSample::Forecast, "representative forecast"),
            (LegendSample::OtherHypotheses, "other hypotheses"),
            (LegendSample::Note, "(the paler, the less likely)"),
        ]);
    } else {
        entries.push((LegendSample::Forecast, "forecast"));
    }
    if forecast.has_goals() {
        entries.push((LegendSample::Goals, if several { "goals" } else { "goal" }));
    }
    if regions(forecast).next().is_some() {
        entries.push((LegendSample::Region, "90 % region at 4.8 s"));
    }
    entries
}

fn extent(drawn: &[SnapshotPedestrian]) -> Vec<Position> {
    let of_one = |pedestrian: &SnapshotPedestrian| {
        let mut points = [&pedestrian.observed[..], &pedestrian.truth].concat();
        for hypothesis in &pedestrian.hypotheses {
            points.extend(&hypothesis.positions);
            points.extend(hypothesis.goal);
        }
        points
    };
    drawn.iter().flat_map(of_one).collect()
}
