//! Draws the observed track and the forecast of one pedestrian, in the same way in every picture.

use crate::figure::drawing::Drawing;
use crate::figure::marks::star;
use crate::figure::plan::PlanView;
use crate::snapshot::{SnapshotHypothesis, SnapshotPedestrian};
use ddl_core::{OBSERVED, Position};

fn from_last<'a>(observed: &'a [Position], path: &'a [Position]) -> impl Iterator<Item = &'a Position> {
    observed[OBSERVED - 1..].iter().chain(path)
}

/// All hypotheses except the representative one; a larger weight gives a darker line.
pub(crate) fn other_hypotheses(drawing: &mut Drawing, plan: &PlanView, pedestrian: &SnapshotPedestrian) {
    let representative = pedestrian.representative();
    let heaviest = pedestrian.hypotheses.iter().map(|h| h.weight).fold(1e-9, f64::max);
    for (k, hypothesis) in pedestrian.hypotheses.iter().enumerate() {
        if k == representative {
            continue;
        }
        let share = (hypothesis.weight / heaviest).clamp(0.0, 1.0);
        let path = plan.path(from_last(&pedestrian.observed, &hypothesis.positions));
        drawing.styled_path("hypothesis", &path, &hypothesis_style(share));
        let opacity = format!("opacity:{:.2}", 0.3 + 0.5 * share);
        if let Some(goal) = hypothesis.goal {
            drawing.styled_circle("goal", plan.px(goal), 2.5 + 3.5 * share.sqrt(), Some(&opacity));
        }
    }
}

pub(super) fn hypothesis_style(share: f64) -> String {
    let (opacity, width) = (0.14 + 0.5 * share, 0.8 + share);
    format!("opacity:{opacity:.2};stroke-width:{width:.1}")
}

pub(crate) fn representative_goal(drawing: &mut Drawing, plan: &PlanView, pedestrian: &SnapshotPedestrian) {
    if let Some(goal) = pedestrian.hypotheses[pedestrian.representative()].goal {
        drawing.circle("goal representative", plan.px(goal), 8.0);
    }
}

pub(crate) fn representative(drawing: &mut Drawing, plan: &PlanView, pedestrian: &SnapshotPedestrian) {
    let hypothesis: &SnapshotHypothesis = &pedestrian.hypotheses[pedestrian.representative()];
    let way: Vec<Position> = from_last(&pedestrian.observed, &hypothesis.positions).copied().collect();
    drawing.path("forecast", &plan.path(&way));
    if let Some(end) = way.last() {
        drawing.polygon("star", &star(plan.px(*end), 7.0));
    }
}

/// Dots at the observed positions, and a line along the true future to a full dot.
pub(crate) fn track(drawing: &mut Drawing, plan: &PlanView, observed: &[Position], truth: &[Position]) {
    if let Some(end) = truth.last() {
        drawing.path("truth", &plan.path(from_last(observed, truth)));
        drawing.circle("truth-end", plan.px(*end), 3.6);
    }
    for place in observed {
        drawing.circle("observed", plan.px(*place), 2.4);
    }
}
