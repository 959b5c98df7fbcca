//! JSON lines: an object for each walker of a window.

use std::io::BufRead;

use ddl_data::{HORIZON, PedestrianName, Position};
use serde::{Deserialize, Deserializer};
use serde_json::Value;

use super::bounds::within_bounds;
use super::error::{ForeignError, ForeignProblem};
use super::lines::{Lines, Wrong, in_field};
use super::repair::{self, finite, kind, list, optional, pedestrian, position, required, whole};
use super::walkers::{WalkerForecast, Walkers, Who};
use crate::Protocol;

/// Fields of other names may stand beside these.
#[derive(Debug, Deserialize)]
struct Line {
    recording: Option<String>,
    observed_until: i64,
    pedestrian: PedestrianName,
    frames: Option<Vec<i64>>,
    hypotheses: Vec<Hypothesis>,
}

#[derive(Debug, Deserialize)]
struct Hypothesis {
    #[serde(default, deserialize_with = "number")]
    weight: Option<f64>,
    /// `null` is no goal: what programs make of NaN is `[null, null]`, and refused.
    goal: Option<Position>,
    positions: Vec<Position>,
}

/// The fields that are read.
const FIELDS: [&str; 8] = [
    "recording",
    "observed_until",
    "pedestrian",
    "frames",
    "hypotheses",
    "weight",
    "goal",
    "positions",
];

/// A field that is there must be a number: `null` is what programs make of NaN, and not nothing.
fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    f64::deserialize(deserializer).map(Some)
}

pub(super) fn read(
    mut lines: Lines<impl BufRead>,
    walkers: &mut Walkers<'_>,
) -> Result<(), ForeignError> {
    while let Some((number, text)) = lines.next_line()? {
        // The quick way knows no names of fields, so that a line it refuses is read again.
        let line = serde_json::from_str(text).or_else(|_| field_by_field(text));
        let taken = line.and_then(|line: Line| {
            let (who, forecast) = line.taken_apart()?;
            walkers.put(&who, forecast, number, true)
        });
        if let Err(wrong) = taken {
            return Err(lines.wrong(number, wrong));
        }
    }
    Ok(())
}

impl Line {
    fn taken_apart(self) -> Result<(Who, WalkerForecast), Wrong> {
        let count = self.hypotheses.len();
        let who = Who {
            recording: self.recording,
            observed_until: self.observed_until,
            pedestrian: self.pedestrian,
        };
        if count > Protocol::MOST_HYPOTHESES {
            return Err(in_field("hypotheses", who.too_many_hypotheses()));
        }
        let weighted = self
            .hypotheses
            .iter()
            .filter(|h| h.weight.is_some())
            .count();
        if weighted != 0 && weighted != count {
            return Err(in_field("hypotheses", ForeignProblem::WeightsOfSome));
        }
        let with_goal = self.hypotheses.iter().filter(|h| h.goal.is_some()).count();
        let mut forecast = WalkerForecast {
            positions: Vec::with_capacity(count * HORIZON),
            weights: (weighted > 0).then(|| Vec::with_capacity(count)),
            goals: (with_goal > 0).then(|| Vec::with_capacity(count)),
            frames: self.frames,
        };
        for (k, hypothesis) in self.hypotheses.into_iter().enumerate() {
            let found = hypothesis.positions.len();
            if found != HORIZON {
                let expected = HORIZON;
                let problem = ForeignProblem::Length { expected, found };
                return Err(in_field(format!("hypotheses[{k}].positions"), problem));
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
                let missing = || in_field(format!("hypotheses[{k}].goal"), ForeignProblem::Missing);
                goals.push(hypothesis.goal.ok_or_else(missing)?);
            }
        }
        Ok((who, forecast))
    }
}

fn field_by_field(text: &str) -> Result<Line, Wrong> {
    let object = repair::object(text, &FIELDS)?;
    let recording = match optional(&object, "recording") {
        None => None,
        Some(Value::String(name)) => Some(name.clone()),
        Some(other) => return Err(in_field("recording", kind("a name in quotes", other))),
    };
    let field = |key: &str| required(&object, key, key);
    let observed_until = whole(field("observed_until")?, "observed_until")?;
    let pedestrian = pedestrian(field("pedestrian")?, "pedestrian")?;
    let frames = match optional(&object, "frames") {
        None => None,
        Some(frames) => Some(each(frames, "frames", whole)?),
    };
    let hypotheses = required(&object, "hypotheses", "hypotheses")?;
    let hypotheses = each(hypotheses, "hypotheses", hypothesis)?;
    Ok(Line {
        recording,
        observed_until,
        pedestrian,
        frames,
        hypotheses,
    })
}

fn hypothesis(value: &Value, path: &str) -> Result<Hypothesis, Wrong> {
    let Value::Object(object) = value else {
        return Err(in_field(path, kind("an object", value)));
    };
    let weight = match object.get("weight") {
        None => None,
        Some(weight) => Some(finite(weight, &format!("{path}.weight"))?),
    };
    let goal = match optional(object, "goal") {
        None => None,
        Some(goal) => Some(position(goal, &format!("{path}.goal"))?),
    };
    let path = format!("{path}.positions");
    let positions = each(required(object, "positions", &path)?, &path, position)?;
    Ok(Hypothesis {
        weight,
        goal,
        positions,
    })
}

/// Every entry of a list, read with its path.
fn each<T>(
    value: &Value,
    path: &str,
    read: impl Fn(&Value, &str) -> Result<T, Wrong>,
) -> Result<Vec<T>, Wrong> {
    let entries = list(value, path)?.iter().enumerate();
    entries
        .map(|(i, entry)| read(entry, &format!("{path}[{i}]")))
        .collect()
}
