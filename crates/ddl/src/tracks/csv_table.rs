//! Forecasts as csv: one row for each position.

use crate::tracks::moment::Moment;
use crate::tracks::wanted_regions::WantedRegions;
use ddl_core::{Holding, PedestrianName};
use ddl_data::FrameNumber;
use serde::Serialize;

#[derive(Serialize)]
struct PositionRow {
    observed_until: FrameNumber,
    pedestrian: PedestrianName,
    hypothesis: usize,
    weight: f64,
    /// Empty for a model without goals.
    goal_x: Option<f64>,
    goal_y: Option<f64>,
    frame: FrameNumber,
    x: f64,
    y: f64,
    unseen: usize,
    age: f64,
    uncertainty: f64,
    /// Empty if the model has no familiarity.
    familiarity: Option<f64>,
}

const COLUMNS: [&str; 13] = [
    "observed_until",
    "pedestrian",
    HYPOTHESIS,
    "weight",
    "goal_x",
    "goal_y",
    "frame",
    "x",
    "y",
    "unseen",
    "age",
    "uncertainty",
    "familiarity",
];
/// `future` for joint futures.
const HYPOTHESIS: &str = "hypothesis";
/// An additional first column, if the tracks name scenes.
const SCENE: &str = "scene";
/// Further columns for the certificate of a position.
const CERTIFIED: [&str; 2] = ["distance_to_goal", "certified"];

/// The table of these moments, with the names of the columns if it is `headed`, and a column of radii for each
/// requested region.
///
/// # Errors
/// A field that has no form in csv, which is a defect.
pub fn csv_table(moments: &[Moment<'_>], headed: bool, regions: WantedRegions<'_>) -> Result<String, csv::Error> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    if headed {
        let certified = moments.iter().any(|moment| !moment.answer.certificates().is_empty());
        let columns = COLUMNS.iter().chain(certified.then_some(&CERTIFIED).into_iter().flatten());
        let named = moments.iter().any(|moment| moment.scene.is_some());
        let columns = named.then_some(&SCENE).into_iter().chain(columns);
        let joint = moments.iter().any(|moment| moment.answer.is_joint());
        let named = |name: &'static str| if joint && name == HYPOTHESIS { "future" } else { name };
        let names = columns.map(|&name| named(name).to_owned());
        let prefix = match regions.holding {
            Holding::Step => String::new(),
            more => format!("{}_", more.name()),
        };
        writer.write_record(names.chain(regions.levels.iter().map(|level| format!("{prefix}radius_{level}"))))?;
    }
    for moment in moments {
        let (frames, forecast) = (moment.frames(), moment.answer.forecast());
        let held = regions.of(forecast);
        // One field if the tracks name scenes, otherwise no field.
        let scene = Vec::from_iter(moment.scene);
        for i in 0..moment.window.len() {
            let quality = moment.window.quality(i);
            for hypothesis in 0..forecast.hypotheses() {
                let certificate = moment.answer.certificate(i, hypothesis);
                let holds = certificate.is_some_and(|certificate| certificate.verify().is_ok());
                // The first distance belongs to the last observed position.
                let mut distances = certificate.map(|certificate| certificate.potentials().skip(1));
                let positions = forecast.hypothesis(i, hypothesis);
                let goal = forecast.goal(i, hypothesis);
                let goal = goal.map(|goal| goal.map(table_metres));
                for (t, (position, &frame)) in positions.iter().zip(&frames).enumerate() {
                    let [x, y] = position.map(table_metres);
                    let row = PositionRow {
                        observed_until: moment.observed_until().rounded(),
                        pedestrian: moment.window.name(i),
                        hypothesis,
                        weight: forecast.weight(i, hypothesis),
                        goal_x: goal.map(|[x, _]| x),
                        goal_y: goal.map(|[_, y]| y),
                        frame: frame.rounded(),
                        x,
                        y,
                        unseen: quality.unseen,
                        age: table_metres(quality.age),
                        uncertainty: table_metres(quality.uncertainty()),
                        familiarity: forecast.familiarity(i).map(table_share),
                    };
                    let radius = |&level: &f64| held.as_ref()?.region_radius(i, hypothesis, t, level).map(table_metres);
                    let radii: Vec<Option<f64>> = regions.levels.iter().map(radius).collect();
                    match distances.as_mut().and_then(Iterator::next) {
                        None => writer.serialize((&scene, row, radii))?,
                        Some(distance) => {
                            writer.serialize((&scene, row, distance, holds, radii))?;
                        }
                    }
                }
            }
        }
    }
    let bytes = writer.into_inner().map_err(csv::IntoInnerError::into_error)?;
    String::from_utf8(bytes).map_err(|error| std::io::Error::other(error).into())
}

/// A coordinate in tables, rounded to 0.1 mm; or a time, rounded to 0.1 ms.
pub fn table_metres(metres: f64) -> f64 {
    // no `-0`
    (1e4 * metres).round() / 1e4 + 0.0
}

/// A share in tables, rounded to 3 significant digits.
pub fn table_share(share: f64) -> f64 {
    // cannot fail: a formatted number parses
    format!("{share:.2e}").parse().unwrap_or(share)
}
