//! Forecasts as csv: a row a position.

use super::Moment;
use crate::clock::FrameNumber;
use anyhow::Context as _;
use serde::Serialize;

/// A forecast position.
#[derive(Serialize)]
struct Row {
    observed_until: FrameNumber,
    pedestrian: i64,
    hypothesis: usize,
    weight: f64,
    /// Empty where the model has no goals.
    goal_x: Option<f64>,
    goal_y: Option<f64>,
    frame: FrameNumber,
    x: f64,
    y: f64,
    /// Positions before the first that was seen, and in holes.
    padded: usize,
    filled: usize,
}

/// What its certificate says of a position: further columns of the row.
#[derive(Serialize)]
struct Certified {
    distance_to_goal: f64,
    certified: bool,
}

pub(super) fn csv(moments: &[Moment<'_>], headed: bool) -> anyhow::Result<String> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(headed)
        .from_writer(Vec::new());
    for moment in moments {
        let frames = moment.frames();
        for (i, pedestrian) in moment.window.pedestrians().iter().enumerate() {
            let made_up = moment.window.made_up(i);
            for hypothesis in 0..moment.forecast.hypotheses() {
                let certificate = moment.certificate(i, hypothesis);
                let holds = certificate.is_some_and(|certificate| certificate.holds().is_ok());
                // the first distance is that of the last observed position
                let mut distances = certificate.map(|certificate| certificate.potentials().skip(1));
                let positions = moment.forecast.hypothesis(i, hypothesis);
                let goal = moment.forecast.goal(i, hypothesis);
                for (position, &frame) in positions.iter().zip(&frames) {
                    let row = Row {
                        observed_until: moment.observed_until(),
                        pedestrian: pedestrian.0,
                        hypothesis,
                        weight: moment.forecast.weight(i, hypothesis),
                        goal_x: goal.map(|[x, _]| x),
                        goal_y: goal.map(|[_, y]| y),
                        frame,
                        x: position[0],
                        y: position[1],
                        padded: made_up.padded,
                        filled: made_up.filled,
                    };
                    match distances.as_mut().and_then(Iterator::next) {
                        None => writer.serialize(row)?,
                        Some(distance_to_goal) => writer.serialize((
                            row,
                            Certified {
                                distance_to_goal,
                                certified: holds,
                            },
                        ))?,
                    }
                }
            }
        }
    }
    let bytes = writer.into_inner().context("cannot finish the csv")?;
    Ok(String::from_utf8(bytes)?)
}
