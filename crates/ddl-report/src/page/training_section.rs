//! How the trainings went: a chart for each fold and quantity.

use std::fmt::Write as _;

use super::{
    error::PageError,
    figure::{TrainingPanel, training_panels},
};
use crate::{TrainingCurve, document::escape, figure::drawing::Drawing};

/// Checks that epochs ascend.
pub(super) fn check(curves: &[TrainingCurve]) -> Result<(), PageError> {
    for (index, curve) in curves.iter().enumerate() {
        for pair in curve.epochs.windows(2) {
            if pair[1].epoch <= pair[0].epoch {
                return Err(PageError::Epochs {
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

pub(super) fn html(curves: &[TrainingCurve]) -> String {
    let panels = training_panels(curves);
    if panels.is_empty() {
        return "<p class=\"nothing\">Nothing in this report was trained, or no training was recorded.</p>\n".to_owned();
    }
    let mut quantities: Vec<&str> = Vec::new();
    for panel in &panels {
        if !quantities.contains(&panel.quantity.as_str()) {
            quantities.push(&panel.quantity);
        }
    }
    let mut html = String::new();
    for quantity in quantities {
        let _ = write!(
            html,
            "<h3>{}</h3>\n<div class=\"panels\">\n",
            escape(quantity)
        );
        for panel in panels.iter().filter(|panel| panel.quantity == quantity) {
            let _ = write!(
                html,
                "<figure>\n{}\n<figcaption aria-live=\"off\">&nbsp;</figcaption>\n</figure>\n",
                panel.drawing.inline("curves")
            );
        }
        html.push_str("</div>\n");
    }
    html
}

pub(super) fn figures(curves: &[TrainingCurve]) -> Vec<(String, Drawing)> {
    let named = |panel: TrainingPanel| {
        (
            format!("training {} {}", panel.fold, panel.quantity),
            panel.drawing,
        )
    };
    training_panels(curves).into_iter().map(named).collect()
}
