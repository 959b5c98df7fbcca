//! Estimated goals of several pedestrians, one panel for each.

use ddl_data::Position;

use crate::error::ReportError;
use crate::figure::axes::{Axes, PANEL};
use crate::figure::drawing::{Drawing, PLOT_STYLE};
use crate::figure::goal_case::GoalCase;
use crate::figure::legend::{LegendEntry, LegendRows};
use crate::figure::marks::{goal_ring, nearest_goal};
use crate::figure::pedestrian;
use crate::figure::wrap::wrapped;

const MOST_CASES: usize = 9;
/// Space around everything, pixels.
const EDGE: f64 = 16.0;
/// Size of the letters of the title, and the height of a line of them.
const TITLE: f64 = 16.0;
const TITLE_LINE: f64 = 22.0;
/// Space between title and legend, pixels.
const BELOW_TITLE: f64 = 10.0;
/// Size of the letters above a panel, and the height of a line of them.
const LETTERS: f64 = 12.0;
const LINE: f64 = 17.0;
/// Largest number of lines of a title, of a panel or of the picture.
const TITLE_LINES: usize = 2;

/// Draws 1 to 9 pedestrians with their estimated goals, one panel for each, as the text of an SVG file.
///
/// Each panel shows metres from the pedestrian's last observed position, at one scale for both axes. The area of a ring
/// is proportional to the goal's probability, down to a least size. The same input gives the same bytes.
///
/// # Errors
/// There are no cases, or more than 9.
pub fn goals(title: &str, cases: &[GoalCase]) -> Result<String, ReportError> {
    if !(1..=MOST_CASES).contains(&cases.len()) {
        let (found, most) = (cases.len(), MOST_CASES);
        return Err(ReportError::Cases { found, most });
    }
    let panels: Vec<GoalPanel<'_>> = cases.iter().map(GoalPanel::new).collect();
    let [width, height] = panels[0].axes.size();
    let columns = columns(cases.len());
    let inner = width * columns as f64;
    let left = EDGE + PANEL.before[0];
    let text_width = inner - PANEL.before[0] - PANEL.after[0];
    let lines = wrapped(title, TITLE, text_width, TITLE_LINES);
    let entries = entries(cases);
    let legend = LegendRows::new(&entries, text_width);
    let below_title = EDGE + TITLE_LINE * lines.len() as f64 + BELOW_TITLE;
    let top = below_title + legend.height();
    let rows = cases.len().div_ceil(columns) as f64;

    let mut drawing = Drawing::new(2.0 * EDGE + inner, top + height * rows + EDGE, title);
    for (row, line) in (1..).zip(lines) {
        drawing.text("heading", [left, EDGE + TITLE_LINE * f64::from(row) - 5.0], line);
    }
    legend.draw(&mut drawing, [left, below_title]);
    for (index, panel) in panels.into_iter().enumerate() {
        let (row, column) = ((index / columns) as f64, (index % columns) as f64);
        panel.draw(&mut drawing, [EDGE + column * width, top + row * height]);
    }
    Ok(drawing.to_file(PLOT_STYLE))
}

fn columns(cases: usize) -> usize {
    match cases {
        4 => 2,
        _ => cases.min(3),
    }
}

fn entries(cases: &[GoalCase]) -> Vec<LegendEntry> {
    let mut entries = vec![LegendEntry::Observed, LegendEntry::Truth];
    if cases.iter().any(|case| case.expert_paths().next().is_some()) {
        entries.push(LegendEntry::Experts);
    }
    let axes = LegendEntry::Note("Axes: metres from the last observed position");
    entries.extend([LegendEntry::WeightedGoals, LegendEntry::NearestGoal, axes]);
    entries
}

/// One pedestrian, relative to its last observed position, because a recording may be far from its origin.
struct GoalPanel<'a> {
    case: &'a GoalCase,
    observed: Vec<Position>,
    truth: Vec<Position>,
    goals: Vec<Position>,
    axes: Axes,
}

impl<'a> GoalPanel<'a> {
    fn new(case: &'a GoalCase) -> Self {
        let here = case.here();
        let [observed, truth, goals] = [case.observed(), case.truth(), case.goals.goals()].map(|path| from(here, path));
        let points = [&observed[..], &truth, &goals].concat();
        Self {
            case,
            observed,
            truth,
            goals,
            axes: Axes::around(&points, &PANEL),
        }
    }

    fn draw(self, drawing: &mut Drawing, origin: [f64; 2]) {
        let (case, axes) = (self.case, self.axes.moved(origin));
        let plan = &axes.plan;
        axes.draw(drawing);
        draw_heading(drawing, &axes, case);
        drawing.within(axes.frame(), |drawing| {
            for path in case.expert_paths() {
                drawing.path("expert", &plan.path(&from(case.here(), path)));
            }
        });
        let nearest = case.nearest;
        let weights = case.goals.weights();
        for (k, (goal, weight)) in self.goals.iter().zip(weights).enumerate() {
            if k != nearest {
                goal_ring(drawing, plan.px(*goal), *weight);
            }
        }
        let (goal, end) = (self.goals[nearest], self.truth[self.truth.len() - 1]);
        drawing.line("miss", plan.px(goal), plan.px(end));
        nearest_goal(drawing, plan.px(goal), weights[nearest]);
        drawing.path("seen", &plan.path(&self.observed));
        // The true endpoint is drawn last, because it is small and the ticks of a nearby goal surround it.
        pedestrian::track(drawing, plan, &self.observed, &self.truth);
    }
}

fn from(here: Position, positions: &[Position]) -> Vec<Position> {
    let seen = |p: &Position| [p[0] - here[0], p[1] - here[1]];
    positions.iter().map(seen).collect()
}

fn draw_heading(drawing: &mut Drawing, axes: &Axes, case: &GoalCase) {
    let [[left, top], [right, _]] = axes.frame();
    // There is space between the frames of two panels.
    let width = right - left + PANEL.after[0] + EDGE;
    let mut lines = wrapped(&case.title, LETTERS, width, TITLE_LINES);
    lines.push(format!("nearest goal {:.2} m off", case.error()));
    for (above, line) in (0..).zip(lines.into_iter().rev()) {
        drawing.text("key", [left, top - 10.0 - f64::from(above) * LINE], line);
    }
}
