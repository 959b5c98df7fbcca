//! Training curves: one panel for each fold and quantity, variants named at the ends of their lines.

use maud::{Markup, html};

use crate::error::ReportError;
use crate::figure::drawing::Drawing;
use crate::figure::scale::Scale;
use crate::training_curve::{EpochPoint, TrainingCurve};

const SIZE: [f64; 2] = [360.0, 230.0];
const LEFT: f64 = 46.0;
const RIGHT: f64 = SIZE[0] - 110.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 36.0;
/// Height of a label, px; closer labels are moved apart.
const LABEL: f64 = 14.0;
const COLOURS: usize = 5;

#[derive(Debug, Clone)]
struct TrainingPanel {
    fold: String,
    quantity: String,
    /// First and last epoch.
    epochs: [usize; 2],
    drawing: Drawing,
}

const VALIDATION: &str = "error on the validation split, m";

struct Series<'a> {
    curve: &'a TrainingCurve,
    colour: usize,
    points: Vec<(usize, f64)>,
}

/// One panel for each fold and kind of loss, then the validation errors, if any.
fn training_panels(curves: &[TrainingCurve]) -> Vec<TrainingPanel> {
    let variants = distinct(curves.iter().map(|curve| curve.variant.as_str()));
    let validation = values(curves.iter(), |point| point.validation);
    let mut panels = Vec::new();
    for fold in distinct(curves.iter().map(|curve| curve.fold.as_str())) {
        let of_fold = || curves.iter().filter(move |curve| curve.fold == fold);
        for loss in distinct(of_fold().map(|curve| curve.loss.as_str())) {
            let of_loss = of_fold().filter(|curve| curve.loss == loss);
            // All folds have the same scale.
            let same_loss = curves.iter().filter(|curve| curve.loss == loss);
            let losses = values(same_loss, |point| Some(point.loss));
            let series = series(of_loss, &variants, |point| Some(point.loss));
            panels.extend(panel(fold, loss, &series, &losses));
        }
        let series = series(of_fold(), &variants, |point| point.validation);
        panels.extend(panel(fold, VALIDATION, &series, &validation));
    }
    panels
}

fn values<'a>(curves: impl Iterator<Item = &'a TrainingCurve>, value: fn(&EpochPoint) -> Option<f64>) -> Vec<f64> {
    let points = curves.flat_map(|curve| &curve.epochs).filter_map(value);
    points.filter(|number| number.is_finite()).collect()
}

fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = Vec::new();
    for name in names {
        if !seen.contains(&name) {
            seen.push(name);
        }
    }
    seen
}

fn series<'a>(
    curves: impl Iterator<Item = &'a TrainingCurve>,
    variants: &[&str],
    value: fn(&EpochPoint) -> Option<f64>,
) -> Vec<Series<'a>> {
    let one = |curve: &'a TrainingCurve| {
        let finite = |point: &EpochPoint| Some((point.epoch, value(point).filter(|v| v.is_finite())?));
        let points: Vec<(usize, f64)> = curve.epochs.iter().filter_map(finite).collect();
        let colour = variants.iter().position(|variant| *variant == curve.variant)? % COLOURS;
        (!points.is_empty()).then_some(Series { curve, colour, points })
    };
    curves.filter_map(one).collect()
}

fn panel(fold: &str, quantity: &str, series: &[Series<'_>], range: &[f64]) -> Option<TrainingPanel> {
    let epochs = || series.iter().flat_map(|s| s.points.iter().map(|(epoch, _)| *epoch));
    let (first, last) = (epochs().min()?, epochs().max()?);
    let bottom = SIZE[1] - BOTTOM;
    let up = Scale::of(range, [bottom, TOP]);
    let span = (last - first).max(1) as f64;
    let across = |epoch: usize| LEFT + (epoch - first) as f64 / span * (RIGHT - LEFT);

    let mut drawing = Drawing::new(SIZE[0], SIZE[1], format!("{fold}: {quantity} by epoch"));
    drawing.text("title", [0.0, 14.0], fold);
    for (value, label) in up.ticks() {
        let y = up.at(value);
        drawing.line("grid", [LEFT, y], [RIGHT, y]);
        drawing.text("small end", [LEFT - 6.0, y + 4.0], label);
    }
    drawing.line("axis", [LEFT, bottom], [RIGHT, bottom]);
    for epoch in epoch_ticks(first, last) {
        drawing.text("small middle", [across(epoch), bottom + 15.0], epoch.to_string());
    }
    drawing.text("small middle", [f64::midpoint(LEFT, RIGHT), bottom + 31.0], "epoch");
    for s in series {
        let points: Vec<[f64; 2]> = s.points.iter().map(|(e, v)| [across(*e), up.at(*v)]).collect();
        drawing.path(&format!("curve c{}", s.colour), &points);
        if let [only] = points.as_slice() {
            drawing.circle(&format!("c{}", s.colour), *only, 2.0);
        }
    }
    for (colour, y, words) in labels(series, &up, [TOP, bottom]) {
        drawing.text(&format!("small c{colour}"), [RIGHT + 7.0, y + 4.0], words);
    }
    Some(TrainingPanel {
        fold: fold.to_owned(),
        quantity: quantity.to_owned(),
        epochs: [first, last],
        drawing,
    })
}

/// Names each variant once, beside the end of its lines; labels that would overlap are moved apart.
fn labels(series: &[Series<'_>], up: &Scale, [top, bottom]: [f64; 2]) -> Vec<(usize, f64, String)> {
    let mut labels: Vec<(usize, f64, String)> = Vec::new();
    for variant in distinct(series.iter().map(|s| s.curve.variant.as_str())) {
        let of_it: Vec<&Series<'_>> = series.iter().filter(|s| s.curve.variant == variant).collect();
        let ends = of_it.iter().filter_map(|s| s.points.last());
        let y = ends.map(|(_, value)| up.at(*value)).sum::<f64>() / of_it.len() as f64;
        let words: String = variant.chars().take(17).collect();
        labels.push((of_it[0].colour, y, words));
    }
    labels.sort_by(|a, b| a.1.total_cmp(&b.1));
    // Down from the top, then up from the bottom, so that the block stays within the panel.
    let mut free = top;
    for label in &mut labels {
        label.1 = label.1.max(free);
        free = label.1 + LABEL;
    }
    let mut free = bottom;
    for label in labels.iter_mut().rev() {
        label.1 = label.1.min(free);
        free = label.1 - LABEL;
    }
    labels
}

fn epoch_ticks(first: usize, last: usize) -> Vec<usize> {
    let steps = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
    let step = steps
        .into_iter()
        .find(|step| (last - first) / step <= 5)
        .unwrap_or(10_000);
    let mut ticks: Vec<usize> = (first..=last).filter(|epoch| epoch % step == 0).collect();
    if ticks.first() != Some(&first) && ticks.first().is_none_or(|tick| tick - first > step / 2) {
        ticks.insert(0, first);
    }
    ticks
}

pub(super) fn check(curves: &[TrainingCurve]) -> Result<(), ReportError> {
    for (index, curve) in curves.iter().enumerate() {
        for pair in curve.epochs.windows(2) {
            if pair[1].epoch <= pair[0].epoch {
                return Err(ReportError::Epochs {
                    index,
                    fold: curve.fold.clone(),
                    variant: curve.variant.clone(),
                    seed: curve.seed,
                    epoch: pair[1].epoch,
                    before: pair[0].epoch,
                });
            }
        }
    }
    Ok(())
}

pub(super) fn html(curves: &[TrainingCurve]) -> Markup {
    let panels = training_panels(curves);
    html! {
        @if panels.is_empty() {
            p.nothing { "Nothing in this report was trained, or no training was recorded." }
        }
        @for quantity in distinct(panels.iter().map(|panel| panel.quantity.as_str())) {
            h3 { (quantity) }
            div.panels {
                @for panel in panels.iter().filter(|panel| panel.quantity == quantity) { (panel.html()) "\n" }
            }
        }
    }
}

impl TrainingPanel {
    /// The figure, with what the script needs to read values from it.
    fn html(&self) -> Markup {
        let kind = if self.quantity == VALIDATION {
            "validation"
        } else {
            "loss"
        };
        let [first, last] = self.epochs;
        html! {
            figure data-fold=(self.fold) data-quantity=(kind) data-loss=(self.quantity) data-left=(LEFT)
                data-right=(RIGHT) data-first=(first) data-last=(last)
            {
                (self.drawing.inline("curves"))
                figcaption aria-live="off" { "\u{a0}" }
            }
        }
    }
}

pub(super) fn figures(curves: &[TrainingCurve]) -> Vec<(String, Drawing)> {
    let named = |panel: TrainingPanel| (format!("training {} {}", panel.fold, panel.quantity), panel.drawing);
    training_panels(curves).into_iter().map(named).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_few_and_whole() {
        assert_eq!(epoch_ticks(1, 6), [1, 2, 3, 4, 5, 6]);
        assert_eq!(epoch_ticks(1, 30), [1, 5, 10, 15, 20, 25, 30]);
        assert_eq!(epoch_ticks(3, 3), [3]);
    }
}
