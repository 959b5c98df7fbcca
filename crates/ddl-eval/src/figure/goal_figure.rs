//! Estimated goals of several walkers, a panel each.

use ddl_data::Position;
use plotters::style::Color;

use super::{
    axes::Axes,
    canvas::{Canvas, EXPERT, FORECAST, Pixel, Place},
    error::FigureError,
    goal_case::GoalCase,
    goal_ring::{self, EXPERT_OPACITY},
    layout::PANEL,
    legend::{Entry, Rows},
    walker,
    wrap::wrapped,
};

/// A picture has at most this many panels.
const MOST_CASES: usize = 9;
/// Space around everything, pixels.
const EDGE: i32 = 24;
/// Size of the letters of the title, and the height of a line of them.
const TITLE: i32 = 38;
const TITLE_LINE: i32 = 46;
/// Space between title and legend, pixels.
const BELOW_TITLE: i32 = 22;
/// Space between legend and panels, pixels.
const BELOW_LEGEND: i32 = 12;
/// Size of the letters above a panel, and the height of a line of them.
const LETTERS: i32 = 28;
const LINE: i32 = 34;
/// How far the title of a panel may reach beyond its frame, pixels.
const BEYOND: i32 = EDGE + PANEL.right;
/// Lines that a title may take, be it of a panel or of the picture.
const TITLE_LINES: usize = 2;

/// Draws 1 to 9 walkers with their estimated goals, a panel each, as the text of an SVG file.
///
/// Each panel is in metres from the walker's last observed position, at one scale for both axes, and holds
/// the track and all goals; of the experts what lies within is drawn. The area of a ring is the goal's
/// probability, except that no ring is too small to be seen. The same input gives the same bytes.
///
/// # Errors
/// There is no case or there are more than 9, or the drawing library fails.
///
/// # Examples
/// See [`GoalCase`].
pub fn goals(title: &str, cases: &[GoalCase]) -> Result<String, FigureError> {
    if !(1..=MOST_CASES).contains(&cases.len()) {
        let (found, most) = (cases.len(), MOST_CASES);
        return Err(FigureError::Cases { found, most });
    }
    let panels: Vec<Panel<'_>> = cases.iter().map(Panel::new).collect();
    let (width, height) = panels[0].axes.size();
    let (width, height) = (width as i32, height as i32);
    let columns = columns(cases.len());
    let rows = cases.len().div_ceil(columns);
    let inner = width * columns as i32;
    let (left, text_width) = (EDGE + PANEL.left, inner - PANEL.left - PANEL.right);
    let title = wrapped(title, TITLE, text_width, TITLE_LINES);
    let entries = entries(cases);
    let legend = Rows::new(&entries, text_width);
    let below_title = EDGE + TITLE_LINE * title.len() as i32 + BELOW_TITLE;
    let top = below_title + legend.height() + BELOW_LEGEND;
    let size = [2 * EDGE + inner, top + height * rows as i32 + EDGE];

    let mut svg = String::new();
    let canvas = Canvas::new(&mut svg, (size[0].unsigned_abs(), size[1].unsigned_abs()))?;
    for (line, y) in title
        .iter()
        .zip((EDGE + TITLE_LINE / 2..).step_by(TITLE_LINE as usize))
    {
        canvas.text(line, (left, y), TITLE, Place::RightOf)?;
    }
    legend.draw(&canvas, (left, below_title))?;
    for (index, panel) in panels.into_iter().enumerate() {
        let (row, column) = ((index / columns) as i32, (index % columns) as i32);
        panel.draw(&canvas, (EDGE + column * width, top + row * height))?;
    }
    canvas.finish()?;
    Ok(svg)
}

/// Up to three panels side by side; four make a square.
fn columns(cases: usize) -> usize {
    match cases {
        4 => 2,
        _ => cases.min(3),
    }
}

fn entries(cases: &[GoalCase]) -> Vec<Entry> {
    let mut entries = vec![Entry::Observed, Entry::Truth];
    if cases
        .iter()
        .any(|case| case.expert_paths().next().is_some())
    {
        entries.push(Entry::Experts);
    }
    let axes = Entry::Note("Axes: metres from the last observed position");
    entries.extend([Entry::WeightedGoals, Entry::NearestGoal, axes]);
    entries
}

/// One walker in metres from its last observed position: recordings may lie far from their origin.
struct Panel<'a> {
    case: &'a GoalCase,
    axes: Axes,
}

impl<'a> Panel<'a> {
    fn new(case: &'a GoalCase) -> Self {
        let mut points = from(case.here(), case.observed());
        points.extend(from(case.here(), case.truth()));
        points.extend(from(case.here(), case.goals().goals()));
        let axes = Axes::around(&points, &PANEL);
        Self { case, axes }
    }

    fn draw(self, canvas: &Canvas<'_>, origin: Pixel) -> Result<(), FigureError> {
        let (case, here, axes) = (self.case, self.case.here(), self.axes.at(origin));
        axes.draw(canvas)?;
        draw_heading(canvas, &axes, case)?;
        for path in case.expert_paths() {
            for piece in axes.cut(&from(here, path)) {
                canvas.line(&piece, EXPERT.mix(EXPERT_OPACITY), 2)?;
            }
        }
        let goals: Vec<Pixel> = from(here, case.goals().goals())
            .iter()
            .map(|goal| axes.pixel(*goal))
            .collect();
        let nearest = case.nearest_goal();
        for (k, (at, weight)) in goals.iter().zip(case.goals().weights()).enumerate() {
            if k != nearest {
                goal_ring::draw(canvas, *at, *weight)?;
            }
        }
        walker::draw_observed(canvas, &axes, &from(here, case.observed()), 1.0)?;
        // The true end lies on top: it is small, and a goal that hits it has its ticks around it.
        let truth = from(here, case.truth());
        let end = axes.pixel(truth[truth.len() - 1]);
        canvas.line(&[goals[nearest], end], FORECAST, 3)?;
        goal_ring::draw_nearest(canvas, goals[nearest], case.goals().weights()[nearest])?;
        walker::draw_truth(canvas, &axes, &truth, 1.0)
    }
}

/// Positions as seen from `here`.
fn from(here: Position, positions: &[Position]) -> Vec<Position> {
    let seen = |p: &Position| [p[0] - here[0], p[1] - here[1]];
    positions.iter().map(seen).collect()
}

fn draw_heading(canvas: &Canvas<'_>, axes: &Axes, case: &GoalCase) -> Result<(), FigureError> {
    let [(left, top), (right, _)] = axes.frame();
    let mut lines = wrapped(case.title(), LETTERS, right - left + BEYOND, TITLE_LINES);
    lines.push(format!("nearest goal {:.2} m off", case.error()));
    for (above, line) in (0..).zip(lines.iter().rev()) {
        let y = top - 24 - above * LINE;
        canvas.text(line, (left, y), LETTERS, Place::RightOf)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_are_as_square_as_three_columns_allow() {
        let found: Vec<usize> = (1..=MOST_CASES).map(columns).collect();
        assert_eq!(found, [1, 2, 3, 2, 3, 3, 3, 3, 3]);
    }
}
