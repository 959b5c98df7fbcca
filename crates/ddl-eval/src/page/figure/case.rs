//! One case of the gallery, in the style of Figures 3 and 4 of the DDL paper.

use ddl_data::{OBSERVED, Position};

use super::{
    Drawing,
    marks::{arrow, star},
};
use crate::{Moment, MomentHypothesis, MomentWalker, gallery::Pick};

/// Width and height of the scene, px.
const SCENE: [f64; 2] = [360.0, 300.0];
/// Free space around what must be seen, px.
const MARGIN: f64 = 22.0;
/// A smaller scene is not magnified further, m.
const LEAST_SPAN: f64 = 3.0;
/// Frames between two arrows.
const ARROW_EVERY: usize = 3;
/// An arrow is as long as the way of this time, s: its length is proportional to the speed.
const ARROW_SECONDS: f64 = 0.8;
/// Heights of title and key of a file, px.
const STRIPS: [f64; 2] = [30.0, 44.0];

/// The walkers of the pick, and everybody else in grey; `alone` adds a title and a key, for a file.
///
/// Dots are observed, the solid line is the truth, dashes are the representative forecast with a star at its end and the ring
/// of its goal, thin lines the other hypotheses, and arrows velocities along it.
pub(crate) fn case_figure(moment: &Moment, pick: &Pick, alone: bool) -> Drawing {
    let title = format!(
        "{}: {}, frame {}",
        pick.show, moment.recording, moment.frame
    );
    let above = if alone { STRIPS[0] } else { 0.0 };
    let below = if alone { STRIPS[1] } else { 0.0 };
    let height = SCENE[1] + above + below;
    let mut drawing = Drawing::new(SCENE[0], height, &title);
    let view = View::of(moment, pick, above);
    for (at, walker) in moment.walkers.iter().enumerate() {
        if !pick.walkers.contains(&at) {
            bystander(&mut drawing, &view, walker);
        }
    }
    let chosen: Vec<&MomentWalker> = pick.walkers.iter().map(|&at| &moment.walkers[at]).collect();
    for walker in &chosen {
        others(&mut drawing, &view, walker);
    }
    for walker in &chosen {
        representative(&mut drawing, &view, walker);
    }
    for walker in &chosen {
        truth(&mut drawing, &view, walker);
    }
    for walker in &chosen {
        label(&mut drawing, &view, walker);
    }
    if alone {
        plate(&mut drawing, [0.0, above]);
        plate(&mut drawing, [height - below, height]);
        drawing.text("title", [12.0, 20.0], title);
        key(&mut drawing, height - below + 16.0);
    }
    scale_bar(&mut drawing, &view, height - below);
    drawing
}

/// Metres to pixels: equal on both axes, y up.
struct View {
    centre: Position,
    /// Pixels a metre.
    scale: f64,
    above: f64,
}

impl View {
    fn of(moment: &Moment, pick: &Pick, above: f64) -> Self {
        let seen = pick.walkers.iter().flat_map(|&at| {
            let walker = &moment.walkers[at];
            let shown = &walker.hypotheses[walker.representative()];
            let ends = walker
                .hypotheses
                .iter()
                .filter_map(|h| h.positions.last().copied());
            let paths = walker
                .observed
                .iter()
                .chain(&walker.truth)
                .chain(&shown.positions);
            paths.copied().chain(shown.goal).chain(ends)
        });
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in seen {
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        if !low[0].is_finite() {
            (low, high) = ([0.0; 2], [1.0; 2]);
        }
        let fit =
            |axis: usize| (SCENE[axis] - 2.0 * MARGIN) / (high[axis] - low[axis]).max(LEAST_SPAN);
        Self {
            centre: [0, 1].map(|axis| f64::midpoint(low[axis], high[axis])),
            scale: fit(0).min(fit(1)),
            above,
        }
    }

    fn px(&self, place: Position) -> [f64; 2] {
        [
            SCENE[0] / 2.0 + self.scale * (place[0] - self.centre[0]),
            self.above + SCENE[1] / 2.0 - self.scale * (place[1] - self.centre[1]),
        ]
    }

    fn path<'a>(&self, places: impl IntoIterator<Item = &'a Position>) -> Vec<[f64; 2]> {
        places.into_iter().map(|place| self.px(*place)).collect()
    }

    /// Whether a place can be seen, or nearly.
    fn shows(&self, place: Position) -> bool {
        let [x, y] = self.px(place);
        let slack = 30.0;
        (-slack..=SCENE[0] + slack).contains(&x)
            && (self.above - slack..=self.above + SCENE[1] + slack).contains(&y)
    }
}

fn from_last<'a>(
    walker: &'a MomentWalker,
    path: &'a [Position],
) -> impl Iterator<Item = &'a Position> {
    walker.observed[OBSERVED - 1..].iter().chain(path)
}

fn bystander(drawing: &mut Drawing, view: &View, walker: &MomentWalker) {
    let all = walker.observed.iter().chain(&walker.truth);
    if !all.clone().any(|place| view.shows(*place)) {
        return;
    }
    drawing.path("bystander", &view.path(&walker.observed));
    drawing.path(
        "bystander-ahead",
        &view.path(from_last(walker, &walker.truth)),
    );
    drawing.circle("bystander-dot", view.px(walker.observed[OBSERVED - 1]), 2.6);
}

/// Every hypothesis but the representative: the heavier, the clearer.
fn others(drawing: &mut Drawing, view: &View, walker: &MomentWalker) {
    let representative = walker.representative();
    let weights = walker.hypotheses.iter().map(|h| h.weight);
    let heaviest = weights.fold(1e-9, f64::max);
    for (_, hypothesis) in walker
        .hypotheses
        .iter()
        .enumerate()
        .filter(|(k, _)| *k != representative)
    {
        let share = (hypothesis.weight / heaviest).clamp(0.0, 1.0);
        let style = format!(
            "opacity:{:.2};stroke-width:{:.1}",
            0.14 + 0.5 * share,
            0.8 + share
        );
        drawing.styled_path(
            "hypothesis",
            &view.path(from_last(walker, &hypothesis.positions)),
            &style,
        );
        let opacity = format!("opacity:{:.2}", 0.3 + 0.5 * share);
        if let Some(goal) = hypothesis.goal {
            drawing.styled_circle("goal", view.px(goal), 2.5 + 3.5 * share.sqrt(), &opacity);
        }
    }
}

fn representative(drawing: &mut Drawing, view: &View, walker: &MomentWalker) {
    let hypothesis: &MomentHypothesis = &walker.hypotheses[walker.representative()];
    if let Some(goal) = hypothesis.goal {
        drawing.circle("goal representative", view.px(goal), 8.0);
    }
    let way: Vec<Position> = from_last(walker, &hypothesis.positions).copied().collect();
    drawing.path("forecast", &view.path(&way));
    for pair in way.windows(2).step_by(ARROW_EVERY) {
        let seconds = ARROW_SECONDS / ddl_data::TIME_STEP;
        let tip = [0, 1].map(|axis| pair[0][axis] + seconds * (pair[1][axis] - pair[0][axis]));
        for stroke in arrow(view.px(pair[0]), view.px(tip)).into_iter().flatten() {
            drawing.path("velocity", &stroke);
        }
    }
    if let Some(end) = way.last() {
        drawing.polygon("star", &star(view.px(*end), 7.0));
    }
}

fn truth(drawing: &mut Drawing, view: &View, walker: &MomentWalker) {
    drawing.path("truth", &view.path(from_last(walker, &walker.truth)));
    if let Some(end) = walker.truth.last() {
        drawing.circle("truth-end", view.px(*end), 3.6);
    }
    for place in &walker.observed {
        drawing.circle("observed", view.px(*place), 2.4);
    }
}

/// The walker's number, behind where it was first seen.
fn label(drawing: &mut Drawing, view: &View, walker: &MomentWalker) {
    let [first, last] = [walker.observed[0], walker.observed[OBSERVED - 1]].map(|p| view.px(p));
    let ahead = last[0] - first[0];
    let words = walker.pedestrian.to_string();
    let width = 7.0 * words.len() as f64;
    let (class, x) = if ahead > 0.0 {
        ("small halo end", (first[0] - 7.0).max(width + 2.0))
    } else {
        ("small halo", (first[0] + 7.0).min(SCENE[0] - width - 2.0))
    };
    let y = (first[1] + 4.0).clamp(view.above + 12.0, view.above + SCENE[1] - 22.0);
    drawing.text(class, [x, y], words);
}

fn plate(drawing: &mut Drawing, [top, bottom]: [f64; 2]) {
    let right = SCENE[0];
    drawing.polygon(
        "plate",
        &[[0.0, top], [right, top], [right, bottom], [0.0, bottom]],
    );
}

/// A bar of 1, 2, 5 ... metres at the lower left.
fn scale_bar(drawing: &mut Drawing, view: &View, bottom: f64) {
    let metres = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]
        .into_iter()
        .find(|metres| metres * view.scale >= 36.0)
        .unwrap_or(200.0);
    let (x, y, length) = (12.0, bottom - 10.0, metres * view.scale);
    let ends = [[x, y - 3.0], [x, y], [x + length, y], [x + length, y - 3.0]];
    drawing.path("scale-bar", &ends);
    drawing.text(
        "small halo",
        [x + length + 6.0, y + 2.0],
        format!("{metres} m"),
    );
}

/// What the shapes mean, in two lines.
fn key(drawing: &mut Drawing, y: f64) {
    drawing.circle("observed", [16.0, y - 4.0], 2.4);
    drawing.circle("observed", [24.0, y - 4.0], 2.4);
    drawing.text("small", [32.0, y], "observed");
    drawing.path("truth", &[[92.0, y - 4.0], [112.0, y - 4.0]]);
    drawing.text("small", [118.0, y], "truth");
    drawing.path("forecast", &[[158.0, y - 4.0], [182.0, y - 4.0]]);
    drawing.polygon("star", &star([188.0, y - 4.0], 6.0));
    drawing.text("small", [199.0, y], "representative, its end");
    let y = y + 18.0;
    drawing.circle("goal representative", [20.0, y - 4.0], 5.5);
    drawing.text("small", [32.0, y], "goal");
    drawing.path("hypothesis", &[[92.0, y - 4.0], [112.0, y - 4.0]]);
    drawing.text("small", [118.0, y], "others");
    for stroke in arrow([160.0, y - 4.0], [182.0, y - 4.0])
        .into_iter()
        .flatten()
    {
        drawing.path("velocity", &stroke);
    }
    drawing.text("small", [199.0, y], "velocity (way of 0.8 s)");
}
