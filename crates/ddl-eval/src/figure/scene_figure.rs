//! One scene: everybody's past, future and forecast.

use ddl_data::{OBSERVED, Position, Window};
use plotters::style::Color;

use super::{
    axes::Axes,
    canvas::{Canvas, FORECAST, GOAL, Place},
    error::FigureError,
    layout::SCENE,
    legend::{self, Entry},
    walker,
};
use crate::Forecast;

/// Draws a scene with default settings; see [`SceneFigure`].
///
/// # Errors
/// As [`SceneFigure::to_svg`].
pub fn scene(window: &Window, forecast: &Forecast) -> Result<String, FigureError> {
    SceneFigure::new(window, forecast).to_svg()
}

/// A picture of one window and its forecast.
///
/// # Examples
/// ```
/// use ddl_data::{PedestrianId, Window};
/// use ddl_eval::{Forecaster, baseline::ConstantVelocity, figure::SceneFigure};
/// let walk = (0..20).map(|t| [0.4 * f64::from(t), 0.02 * f64::from(t * t)]).collect();
/// let window = Window::new("corridor", 0, 10, vec![PedestrianId(7)], vec![walk])?;
/// let forecast = ConstantVelocity::angular_noise(1).forecast(&window)?;
/// let svg = SceneFigure::new(&window, &forecast).title("A curve ahead").to_svg()?;
/// assert!(svg.starts_with("<svg") && svg.contains("A curve ahead"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SceneFigure<'a> {
    window: &'a Window,
    forecast: &'a Forecast,
    title: Option<String>,
    pedestrians: Option<Vec<usize>>,
}

impl<'a> SceneFigure<'a> {
    /// A picture of everybody, titled with the recording and the first frame.
    #[must_use]
    pub fn new(window: &'a Window, forecast: &'a Forecast) -> Self {
        Self {
            window,
            forecast,
            title: None,
            pedestrians: None,
        }
    }

    /// Another title.
    #[must_use]
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = Some(title.into());
        self
    }

    /// Draws the forecasts of these rows of the window alone; the others are shown pale, without
    /// forecasts. Rows that the window does not have are ignored.
    #[must_use]
    pub fn only(mut self, pedestrians: impl IntoIterator<Item = usize>) -> Self {
        self.pedestrians = Some(pedestrians.into_iter().collect());
        self
    }

    /// The picture as the text of an SVG file. The same input gives the same bytes.
    ///
    /// # Errors
    /// The forecast is not of the window's pedestrians, or the drawing library fails.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        let (expected, found) = (self.window.len(), self.forecast.pedestrians());
        if expected != found {
            return Err(FigureError::Pedestrians { expected, found });
        }
        let axes = Axes::around(&self.extent(), &SCENE);
        let mut svg = String::new();
        let canvas = Canvas::new(&mut svg, axes.size())?;
        axes.draw(&canvas)?;
        axes.draw_names(&canvas)?;
        let [(left, top), (right, _)] = axes.frame();
        canvas.text(&self.heading(), (left, top / 2), 36, Place::RightOf)?;
        legend::draw_column(&canvas, (right + 30, top), &self.entries())?;
        self.draw_hypotheses(&canvas, &axes)?;
        self.draw_tracks(&canvas, &axes)?;
        self.draw_representative(&canvas, &axes)?;
        canvas.finish()?;
        Ok(svg)
    }

    fn heading(&self) -> String {
        self.title.clone().unwrap_or_else(|| {
            format!(
                "{}, from frame {}",
                self.window.recording(),
                self.window.start_frame()
            )
        })
    }

    /// What the legend names: the roles that the picture has.
    fn entries(&self) -> Vec<Entry> {
        let several = self.forecast.hypotheses() > 1;
        let mut entries = vec![Entry::Observed];
        if self.window.has_future() {
            entries.push(Entry::Truth);
        }
        if several {
            let paler = Entry::Note("(the paler, the less likely)");
            entries.extend([Entry::Representative, Entry::OtherHypotheses, paler]);
        } else {
            entries.push(Entry::Forecast);
        }
        if self.forecast.has_goals() {
            entries.push(Entry::Goals(if several { "goals" } else { "goal" }));
        }
        entries
    }

    fn is_drawn(&self, i: usize) -> bool {
        self.pedestrians
            .as_ref()
            .is_none_or(|rows| rows.contains(&i))
    }

    fn drawn(&self) -> impl Iterator<Item = usize> {
        (0..self.window.len()).filter(|&i| self.is_drawn(i))
    }

    /// Every point that the picture must hold.
    fn extent(&self) -> Vec<Position> {
        let mut points = Vec::new();
        for i in self.drawn() {
            points.extend(self.window.track(i));
            for k in 0..self.forecast.hypotheses() {
                points.extend(self.forecast.hypothesis(i, k));
                points.extend(self.forecast.goal(i, k));
            }
        }
        points
    }

    /// The path of hypothesis `k` from the last observed position on.
    fn path(&self, i: usize, k: usize) -> Vec<Position> {
        let here = self.window.observed(i)[OBSERVED - 1];
        [here]
            .into_iter()
            .chain(self.forecast.hypothesis(i, k).iter().copied())
            .collect()
    }

    /// Opacity of hypothesis `k`: its weight against the greatest of the pedestrian, never invisible.
    fn opacity(&self, i: usize, k: usize) -> f64 {
        let greatest = self.forecast.weight(i, self.forecast.most_likely(i));
        0.15 + 0.55 * self.forecast.weight(i, k) / greatest
    }

    fn draw_hypotheses(&self, canvas: &Canvas<'_>, axes: &Axes) -> Result<(), FigureError> {
        for i in self.drawn() {
            let representative = self.forecast.representative(i);
            for k in 0..self.forecast.hypotheses() {
                let opacity = self.opacity(i, k);
                let path: Vec<_> = self.path(i, k).iter().map(|p| axes.pixel(*p)).collect();
                // The representative one is drawn later, on top of everything.
                if k != representative {
                    canvas.line(&path, FORECAST.mix(opacity), 3)?;
                    canvas.dot(path[path.len() - 1], FORECAST.mix(opacity), 5)?;
                }
                if let Some(goal) = self.forecast.goal(i, k) {
                    canvas.ring(axes.pixel(goal), GOAL.mix(0.25 + opacity), 11, 3)?;
                }
            }
        }
        Ok(())
    }

    fn draw_tracks(&self, canvas: &Canvas<'_>, axes: &Axes) -> Result<(), FigureError> {
        for i in 0..self.window.len() {
            let strength = if self.is_drawn(i) { 1.0 } else { 0.3 };
            // The plot is cut to the people drawn: of the others, what lies within is shown.
            if self.window.has_future() {
                let path = &self.window.track(i)[OBSERVED - 1..];
                walker::draw_truth(canvas, axes, path, strength)?;
            }
            walker::draw_observed(canvas, axes, self.window.observed(i), strength)?;
        }
        Ok(())
    }

    fn draw_representative(&self, canvas: &Canvas<'_>, axes: &Axes) -> Result<(), FigureError> {
        for i in self.drawn() {
            let one = self.path(i, self.forecast.representative(i));
            let path: Vec<_> = one.iter().map(|p| axes.pixel(*p)).collect();
            canvas.dashes(&path, FORECAST, 5)?;
            canvas.star(path[path.len() - 1], FORECAST, 15)?;
        }
        Ok(())
    }
}
