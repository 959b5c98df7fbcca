//! JSON lines: one object for each pedestrian of a window.

use std::io::BufRead;

use ddl_core::{HORIZON, PedestrianName, Position};
use ddl_data::{Fault, TextLines};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

use crate::external::error::ExternalError;
use crate::external::expected::{ExpectedForecasts, PedestrianForecast};
use crate::external::json::{self, Whole};
use crate::external::lines::{missing, within_bounds, wrong_length};
use crate::external::pedestrian_key::PedestrianKey;
use crate::protocol::Protocol;

/// Fields of other names are ignored.
#[derive(Debug, Deserialize)]
struct JsonForecast {
    recording: Option<String>,
    #[serde(deserialize_with = "json::whole_number")]
    observed_until: i64,
    #[serde(deserialize_with = "json::pedestrian")]
    pedestrian: PedestrianName,
    frames: Option<Vec<Whole>>,
    hypotheses: Vec<JsonHypothesis>,
}

#[derive(Debug, Deserialize)]
struct JsonHypothesis {
    #[serde(default, deserialize_with = "number")]
    weight: Option<f64>,
    /// `null` means no goal; `[null, null]`, which some programs write for NaN, is an error.
    goal: Option<Position>,
    positions: Vec<Position>,
}

/// A field that is present must be a number; `null`, which some programs write for NaN, is an error.
fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    f64::deserialize(deserializer).map(Some)
}

pub(super) fn read(
    mut lines: TextLines<impl BufRead>,
    expected: &mut ExpectedForecasts<'_>,
) -> Result<(), ExternalError> {
    while let Some(text) = lines.next_filled()? {
        let line = read_line(text);
        let taken = line.and_then(|line| {
            let (who, forecast) = line.taken_apart()?;
            expected.put(&who, forecast, lines.number())
        });
        taken.map_err(|fault| lines.wrong(fault))?;
    }
    Ok(())
}

fn read_line(text: &str) -> Result<JsonForecast, Fault> {
    json::read(text).map_err(|wrong| {
        let is_of_trajnet = |line: Map<String, Value>| line.keys().eq(["scene"]) || line.keys().eq(["track"]);
        let remedy = "a scene or track of TrajNet++; convert the file to JSON lines as docs/your-model.md shows";
        let known = serde_json::from_str(text).is_ok_and(is_of_trajnet);
        if known { Fault::from(remedy) } else { wrong }
    })
}

impl JsonForecast {
    fn taken_apart(self) -> Result<(PedestrianKey, PedestrianForecast), Fault> {
        let count = self.hypotheses.len();
        let who = PedestrianKey {
            recording: self.recording,
            observed_until: self.observed_until,
            pedestrian: self.pedestrian,
        };
        if count > Protocol::MAX_HYPOTHESES {
            return Err(Fault::named("hypotheses", who.too_many_hypotheses()));
        }
        let weighted = self.hypotheses.iter().filter(|h| h.weight.is_some()).count();
        if weighted != 0 && weighted != count {
            return Err(Fault::named("hypotheses", "all hypotheses of a pedestrian must have weights, or none"));
        }
        let with_goal = self.hypotheses.iter().filter(|h| h.goal.is_some()).count();
        let mut forecast = PedestrianForecast {
            positions: Vec::with_capacity(count * HORIZON),
            weights: (weighted > 0).then(|| Vec::with_capacity(count)),
            goals: (with_goal > 0).then(|| Vec::with_capacity(count)),
            frames: self.frames.map(|frames| frames.iter().map(|frame| frame.0).collect()),
        };
        for (k, hypothesis) in self.hypotheses.into_iter().enumerate() {
            let found = hypothesis.positions.len();
            if found != HORIZON {
                return Err(Fault::named(format!("hypotheses[{k}].positions"), wrong_length(found)));
            }
            for (t, &position) in hypothesis.positions.iter().enumerate() {
                within_bounds(position, || format!("hypotheses[{k}].positions[{t}]"))?;
            }
            if let Some(goal) = hypothesis.goal {
                within_bounds(goal, || format!("hypotheses[{k}].goal"))?;
            }
            forecast.positions.extend(hypothesis.positions);
            if let (Some(weights), Some(weight)) = (&mut forecast.weights, hypothesis.weight) {
                weights.push(weight);
            }
            if let Some(goals) = &mut forecast.goals {
                let goal = hypothesis.goal;
                goals.push(goal.ok_or_else(|| missing(format!("hypotheses[{k}].goal")))?);
            }
        }
        Ok((who, forecast))
    }
}
