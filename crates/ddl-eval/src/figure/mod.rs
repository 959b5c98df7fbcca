//! Pictures of scenes as SVG, which need neither a display nor a font file.
//!
//! One scene: what was observed (dark dots), what then happened (solid blue, a full dot at the end), the
//! hypotheses (orange, the more likely the more opaque; the most likely one dashed and bold, a star at
//! its end) and their goals (green rings). Metres on both axes, at one scale. The colours are those of
//! Okabe and Ito, told apart by colour-blind readers; roles differ in shape as well as in colour.

mod axes;
mod canvas;
mod legend;

use ddl_data::{OBSERVED, Position, Window};
use plotters::style::Color;

use self::{
    axes::Axes,
    canvas::{Canvas, Pixel},
};
use crate::{Forecast, error::FigureError};

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
        let axes = Axes::around(&self.extent());
        let mut svg = String::new();
        let canvas = Canvas::new(&mut svg, axes.size())?;
        axes.draw(&canvas, &self.heading())?;
        legend::draw(&canvas, &axes, self.roles())?;
        self.draw_hypotheses(&canvas, &axes)?;
        self.draw_tracks(&canvas, &axes)?;
        self.draw_likeliest(&canvas, &axes)?;
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

    fn roles(&self) -> legend::Roles {
        legend::Roles {
            truth: self.window.has_future(),
            several: self.forecast.hypotheses() > 1,
            goals: self.forecast.has_goals(),
        }
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
            for k in 0..self.forecast.hypotheses() {
                let opacity = self.opacity(i, k);
                let path: Vec<_> = self.path(i, k).iter().map(|p| axes.pixel(*p)).collect();
                // The most likely one is drawn later, on top of everything.
                if k != self.forecast.most_likely(i) {
                    canvas.line(&path, canvas::FORECAST.mix(opacity), 3)?;
                    canvas.dot(path[path.len() - 1], canvas::FORECAST.mix(opacity), 5)?;
                }
                if let Some(goal) = self.forecast.goal(i, k) {
                    canvas.ring(axes.pixel(goal), canvas::GOAL.mix(0.25 + opacity), 11)?;
                }
            }
        }
        Ok(())
    }

    fn draw_tracks(&self, canvas: &Canvas<'_>, axes: &Axes) -> Result<(), FigureError> {
        for i in 0..self.window.len() {
            let strength = if self.is_drawn(i) { 1.0 } else { 0.3 };
            // The plot is cut to the people drawn: of the others, what lies within is shown.
            let visible = |track: &[Position]| -> Vec<Pixel> {
                track
                    .iter()
                    .map(|p| axes.pixel(*p))
                    .filter(|p| axes.shows(*p))
                    .collect()
            };
            if self.window.has_future() {
                let truth = visible(&self.window.track(i)[OBSERVED - 1..]);
                canvas.line(&truth, canvas::TRUTH.mix(strength), 5)?;
                for end in self
                    .window
                    .end(i)
                    .map(|end| visible(&[end]))
                    .iter()
                    .flatten()
                {
                    canvas.dot(*end, canvas::TRUTH.mix(strength), 9)?;
                }
            }
            let observed = visible(self.window.observed(i));
            canvas.line(&observed, canvas::OBSERVED.mix(0.5 * strength), 2)?;
            for pixel in observed {
                canvas.dot(pixel, canvas::OBSERVED.mix(strength), 6)?;
            }
        }
        Ok(())
    }

    fn draw_likeliest(&self, canvas: &Canvas<'_>, axes: &Axes) -> Result<(), FigureError> {
        for i in self.drawn() {
            let best = self.path(i, self.forecast.most_likely(i));
            let path: Vec<_> = best.iter().map(|p| axes.pixel(*p)).collect();
            canvas.dashes(&path, canvas::FORECAST, 5)?;
            canvas.star(path[path.len() - 1], canvas::FORECAST, 15)?;
        }
        Ok(())
    }
}
