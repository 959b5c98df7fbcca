//! The gallery: the picked cases as figures in the style of Figures 3 and 4 of the DDL paper, with captions.

use ddl_data::{OBSERVED, Position};
use maud::{Markup, html};

use crate::document::inline;
use crate::figure::drawing::Drawing;
use crate::figure::marks::{arrow, star};
use crate::figure::pedestrian;
use crate::figure::plan::{PlanView, bounds};
use crate::snapshot::{ForecastSnapshot, Highlight, HighlightKind, SnapshotPedestrian};

const CASE: [f64; 2] = [360.0, 300.0];
/// Margin around the shown tracks, px.
const MARGIN: f64 = 22.0;
/// Least width of the shown area, m.
const LEAST_SPAN: f64 = 3.0;
/// Heights of title and legend of a file, px.
const STRIPS: [f64; 2] = [30.0, 44.0];

#[derive(Clone, Copy, PartialEq, Eq)]
enum CaseFrame {
    /// In a page, which has a caption and a legend.
    Page,
    /// In a separate file, with a title and a legend.
    File,
}

/// Draws the pedestrians of the pick, and the others in grey.
fn case_figure(moment: &ForecastSnapshot, pick: &Highlight, frame: CaseFrame) -> Drawing {
    let title = format!("{}: {}, frame {}", pick.show, moment.recording, moment.frame);
    let [above, below] = match frame {
        CaseFrame::Page => [0.0; 2],
        CaseFrame::File => STRIPS,
    };
    let height = CASE[1] + above + below;
    let mut drawing = Drawing::new(CASE[0], height, &title);
    let chosen: Vec<&SnapshotPedestrian> = pick.pedestrians.iter().map(|&i| &moment.pedestrians[i]).collect();
    let plan = fitting(&chosen, above);
    for (i, pedestrian) in moment.pedestrians.iter().enumerate() {
        let mut track = pedestrian.observed.iter().chain(&pedestrian.truth);
        if !pick.pedestrians.contains(&i) && track.any(|place| is_seen(&plan, *place, above)) {
            pedestrian::bystander(&mut drawing, &plan, pedestrian);
        }
    }
    for pedestrian in &chosen {
        pedestrian::other_hypotheses(&mut drawing, &plan, pedestrian);
    }
    for pedestrian in &chosen {
        pedestrian::representative_goal(&mut drawing, &plan, pedestrian);
        pedestrian::representative(&mut drawing, &plan, pedestrian, true);
    }
    for pedestrian in &chosen {
        pedestrian::track(&mut drawing, &plan, &pedestrian.observed, &pedestrian.truth);
    }
    for pedestrian in &chosen {
        label(&mut drawing, &plan, pedestrian, above);
    }
    if frame == CaseFrame::File {
        plate(&mut drawing, [0.0, above]);
        plate(&mut drawing, [height - below, height]);
        drawing.text("title", [12.0, 20.0], title);
        key(&mut drawing, height - below + 16.0);
    }
    scale_bar(&mut drawing, &plan, height - below);
    drawing
}

fn fitting(chosen: &[&SnapshotPedestrian], above: f64) -> PlanView {
    let seen = chosen.iter().flat_map(|pedestrian| {
        let shown = &pedestrian.hypotheses[pedestrian.representative()];
        let paths = pedestrian.observed.iter().chain(&pedestrian.truth);
        let ends = pedestrian.hypotheses.iter().filter_map(|h| h.positions.last());
        let paths = paths.chain(&shown.positions).chain(ends);
        paths.copied().chain(shown.goal)
    });
    let [low, high] = bounds(seen).unwrap_or([[0.0; 2], [1.0; 2]]);
    let fit = |axis: usize| (CASE[axis] - 2.0 * MARGIN) / (high[axis] - low[axis]).max(LEAST_SPAN);
    PlanView {
        centre: [0, 1].map(|axis| f64::midpoint(low[axis], high[axis])),
        middle: [CASE[0] / 2.0, above + CASE[1] / 2.0],
        scale: fit(0).min(fit(1)),
    }
}

fn is_seen(plan: &PlanView, place: Position, above: f64) -> bool {
    let [x, y] = plan.px(place);
    let slack = 30.0;
    (-slack..=CASE[0] + slack).contains(&x) && (above - slack..=above + CASE[1] + slack).contains(&y)
}

fn label(drawing: &mut Drawing, plan: &PlanView, pedestrian: &SnapshotPedestrian, above: f64) {
    let [first, last] = [pedestrian.observed[0], pedestrian.observed[OBSERVED - 1]].map(|p| plan.px(p));
    let ahead = last[0] - first[0];
    let words = pedestrian.pedestrian.to_string();
    let width = 7.0 * words.len() as f64;
    let (class, x) = if ahead > 0.0 {
        ("small halo end", (first[0] - 7.0).max(width + 2.0))
    } else {
        ("small halo", (first[0] + 7.0).min(CASE[0] - width - 2.0))
    };
    let y = (first[1] + 4.0).clamp(above + 12.0, above + CASE[1] - 22.0);
    drawing.text(class, [x, y], words);
}

fn plate(drawing: &mut Drawing, [top, bottom]: [f64; 2]) {
    drawing.rectangle("plate", [[0.0, top], [CASE[0], bottom]]);
}

/// A bar of 1, 2, 5 ... metres at the lower left.
fn scale_bar(drawing: &mut Drawing, plan: &PlanView, bottom: f64) {
    let metres = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]
        .into_iter()
        .find(|metres| metres * plan.scale >= 36.0)
        .unwrap_or(200.0);
    let (x, y, length) = (12.0, bottom - 10.0, metres * plan.scale);
    let ends = [[x, y - 3.0], [x, y], [x + length, y], [x + length, y - 3.0]];
    drawing.path("scale-bar", &ends);
    drawing.text("small halo", [x + length + 6.0, y + 2.0], format!("{metres} m"));
}

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
    let strokes = arrow([160.0, y - 4.0], [182.0, y - 4.0]);
    for stroke in strokes.into_iter().flatten() {
        drawing.path("velocity", &stroke);
    }
    drawing.text("small", [199.0, y], "velocity (move in 0.8 s)");
}

/// A highlight and the index of its moment.
struct GalleryEntry<'a> {
    index: usize,
    moment: &'a ForecastSnapshot,
    pick: &'a Highlight,
}

fn entries<'a>(moments: &'a [ForecastSnapshot]) -> Vec<GalleryEntry<'a>> {
    let picks = |(index, moment): (usize, &'a ForecastSnapshot)| {
        moment
            .picks
            .iter()
            .map(move |pick| GalleryEntry { index, moment, pick })
    };
    let mut entries: Vec<GalleryEntry<'a>> = moments.iter().enumerate().flat_map(picks).collect();
    entries.sort_by_key(|entry| entry.pick.show);
    entries
}

fn meaning(show: HighlightKind) -> &'static str {
    match show {
        HighlightKind::Convergence => "A pedestrian who reaches the goal of the representative hypothesis.",
        HighlightKind::Group => "Pedestrians who walk together.",
        HighlightKind::SlowingDown => {
            "A pedestrian who slows down; where the forecast does too, its arrows grow shorter."
        }
        HighlightKind::KeepingDistance => "Pedestrians who pass each other and keep their distance.",
        HighlightKind::Turning => "A pedestrian who turns.",
    }
}

pub(super) fn html(moments: &[ForecastSnapshot]) -> Markup {
    let entries = entries(moments);
    html! {
        @if entries.is_empty() {
            p.nothing { "No cases were picked for this page." }
        } @else {
            div.cases { @for entry in &entries { (entry.html()) "\n" } }
        }
    }
}

impl GalleryEntry<'_> {
    fn html(&self) -> Markup {
        let Self { index, moment, pick } = *self;
        let who = pick
            .pedestrians
            .iter()
            .map(|&i| moment.pedestrians[i].pedestrian.to_string());
        let who: Vec<String> = who.collect();
        let plural = if who.len() == 1 { "Pedestrian" } else { "Pedestrians" };
        html! {
            figure {
                (case_figure(moment, pick, CaseFrame::Page).inline("case"))
                figcaption {
                    h3 { (capitalised(&pick.show.to_string())) }
                    p {
                        (meaning(pick.show)) " " (plural) " " (who.join(", ")) " of recording "
                        code { (moment.recording) }
                        @if moment.fold != moment.recording { " (fold " code { (moment.fold) } ")" }
                        ", frame " (moment.frame) "; forecast by " (moment.forecaster) "."
                    }
                    p.rule { "Why this one: " (inline(pick.rule.trim_end_matches('.'))) "." }
                    button type="button" data-moment=(index)
                        data-pedestrian=(pick.pedestrians.first().copied().unwrap_or(0))
                    { "Play this moment" }
                }
            }
        }
    }
}

pub(super) fn figures(moments: &[ForecastSnapshot]) -> Vec<(String, Drawing)> {
    let named = |GalleryEntry { moment, pick, .. }| {
        let name = format!("case {} {} {}", pick.show, moment.recording, moment.frame);
        (name, case_figure(moment, pick, CaseFrame::File))
    };
    entries(moments).into_iter().map(named).collect()
}

fn capitalised(words: &str) -> String {
    let mut characters = words.chars();
    characters
        .next()
        .map_or(String::new(), |first| first.to_uppercase().chain(characters).collect())
}
