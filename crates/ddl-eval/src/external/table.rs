//! The comma-separated table with a row for each position.

use std::io::BufRead;

use ddl_core::{HORIZON, PedestrianName, Position};
use ddl_data::{Fault, FormatError, TextLines, quoted};

use crate::external::error::ExternalError;
use crate::external::expected::{ExpectedForecasts, PedestrianForecast};
use crate::external::lines::{self, not_finite, within_bounds, wrong_length};
use crate::external::pedestrian_key::{HypothesisNumbering, PedestrianKey, wrong_frames};
use crate::external::table_rows::{Fields, TableRows};
use crate::protocol::Protocol;

const REQUIRED: [&str; 5] = ["observed_until", "pedestrian", "frame", "x", "y"];

pub(super) fn read(lines: TextLines<impl BufRead>, expected: &mut ExpectedForecasts<'_>) -> Result<(), ExternalError> {
    let mut rows = TableRows::new(lines);
    let Some(header) = rows.next()? else { return Ok(()) };
    let columns = TableColumns::of(&header).map_err(|fault| rows.wrong(fault))?;
    let mut numbering = HypothesisNumbering::default();
    let mut group: Option<PedestrianRows> = None;
    while let Some(fields) = rows.next()? {
        let row = columns.row(&fields).map_err(|fault| rows.wrong(fault))?;
        let number = rows.number();
        if group.as_ref().is_some_and(|group| group.who != row.who) {
            put(group.take(), expected, &mut numbering)?;
        }
        let group = group.get_or_insert_with(|| PedestrianRows::new(row.who.clone(), number));
        group.add(&row, number).map_err(|fault| rows.wrong(fault))?;
    }
    Ok(put(group, expected, &mut numbering)?)
}

/// Adds a pedestrian whose rows are complete.
fn put(
    group: Option<PedestrianRows>,
    expected: &mut ExpectedForecasts<'_>,
    numbering: &mut HypothesisNumbering,
) -> Result<(), FormatError> {
    let Some(group) = group else { return Ok(()) };
    let line = group.line;
    let forecast = group.forecast(numbering);
    let put = forecast.and_then(|(who, forecast)| expected.put(&who, forecast, line).map_err(|fault| (line, fault)));
    put.map_err(|(line, fault)| fault.in_line(&expected.origin, line))
}

struct TableColumns {
    count: usize,
    required: [usize; REQUIRED.len()],
    recording: Option<usize>,
    hypothesis: Option<usize>,
    weight: Option<usize>,
}

struct TablePosition {
    who: PedestrianKey,
    hypothesis: i64,
    weight: Option<f64>,
    frame: i64,
    position: Position,
}

impl TableColumns {
    fn of(header: &Fields<'_>) -> Result<Self, Fault> {
        let names: Vec<&str> = (0..header.len()).map(|i| header.get(i)).collect();
        let wrong = |detail: String| {
            Fault::from(format!(
                "the header must name the columns observed_until, pedestrian, frame, x and y, and may name recording, \
                 hypothesis, weight and others, each once: {detail}"
            ))
        };
        let find = |name: &str| {
            let mut places = (0..names.len()).filter(|&i| names[i] == name);
            let place = places.next();
            match places.next() {
                None => Ok(place),
                Some(_) => Err(wrong(format!("column {name} appears twice"))),
            }
        };
        let mut required = [0; REQUIRED.len()];
        for (place, name) in required.iter_mut().zip(REQUIRED) {
            *place = find(name)?.ok_or_else(|| wrong(format!("column {name} is missing")))?;
        }
        Ok(Self {
            count: names.len(),
            required,
            recording: find("recording")?,
            hypothesis: find("hypothesis")?,
            weight: find("weight")?,
        })
    }

    fn row(&self, fields: &Fields<'_>) -> Result<TablePosition, Fault> {
        if fields.len() != self.count {
            let (expected, found) = (self.count, fields.len());
            return Err(Fault::from(format!("{found} fields where the header names {expected}")));
        }
        let [observed_until, pedestrian, frame, x, y] = self.required.map(|place| fields.get(place));
        let who = PedestrianKey {
            recording: self.recording.map(|place| fields.get(place)).filter(|name| !name.is_empty()).map(str::to_owned),
            observed_until: whole_number(observed_until, REQUIRED[0])?,
            pedestrian: name(pedestrian)?,
        };
        let hypothesis = match self.hypothesis {
            None => 0,
            Some(place) => whole_number(fields.get(place), "hypothesis")?,
        };
        let weight = match self.weight {
            None => None,
            Some(place) => Some(finite(fields.get(place), "weight")?),
        };
        let position = [finite(x, REQUIRED[3])?, finite(y, REQUIRED[4])?];
        within_bounds(position, || "x, y".to_owned())?;
        Ok(TablePosition { who, hypothesis, weight, frame: whole_number(frame, REQUIRED[2])?, position })
    }
}

struct PedestrianRows {
    who: PedestrianKey,
    line: usize,
    hypotheses: Vec<HypothesisRows>,
}

struct HypothesisRows {
    hypothesis: i64,
    line: usize,
    weight: Option<f64>,
    frames: Vec<i64>,
    positions: Vec<Position>,
}

impl PedestrianRows {
    fn new(who: PedestrianKey, line: usize) -> Self {
        Self { who, line, hypotheses: Vec::new() }
    }

    fn add(&mut self, row: &TablePosition, line: usize) -> Result<(), Fault> {
        let hypothesis = row.hypothesis;
        if self.hypotheses.last().is_none_or(|last| last.hypothesis != hypothesis) {
            if self.hypotheses.iter().any(|other| other.hypothesis == hypothesis) {
                let problem = "appeared before; the rows of a hypothesis must be consecutive";
                return Err(Fault::named("hypothesis", format!("hypothesis {hypothesis} {problem}")));
            }
            if self.hypotheses.len() == Protocol::MAX_HYPOTHESES {
                return Err(Fault::named("hypothesis", self.who.too_many_hypotheses()));
            }
            self.hypotheses.push(HypothesisRows {
                hypothesis,
                line,
                weight: row.weight,
                frames: Vec::with_capacity(HORIZON),
                positions: Vec::with_capacity(HORIZON),
            });
        }
        let Some(rows) = self.hypotheses.last_mut() else { return Ok(()) };
        if let (Some(first), Some(found)) = (rows.weight, row.weight)
            && first.to_bits() != found.to_bits()
        {
            let problem = format!("weight {found}, but {first} in the row before; a hypothesis has one weight");
            return Err(Fault::named("weight", problem));
        }
        if rows.positions.len() == HORIZON {
            return Err(Fault::from(wrong_length(HORIZON + 1)));
        }
        rows.frames.push(row.frame);
        rows.positions.push(row.position);
        Ok(())
    }

    fn forecast(
        mut self,
        numbering: &mut HypothesisNumbering,
    ) -> Result<(PedestrianKey, PedestrianForecast), (usize, Fault)> {
        self.hypotheses.sort_by_key(|rows| rows.hypothesis);
        let numbers: Vec<i64> = self.hypotheses.iter().map(|rows| rows.hypothesis).collect();
        numbering
            .check(&numbers, &self.who.named())
            .map_err(|problem| (self.line, Fault::named("hypothesis", problem)))?;
        let mut forecast = PedestrianForecast::default();
        for rows in self.hypotheses {
            let found = rows.positions.len();
            if found != HORIZON {
                return Err((rows.line, Fault::from(wrong_length(found))));
            }
            let frames = forecast.frames.get_or_insert_with(|| rows.frames.clone());
            if *frames != rows.frames {
                return Err((rows.line, Fault::named("frame", wrong_frames(&rows.frames, frames))));
            }
            forecast.positions.extend(rows.positions);
            if let Some(weight) = rows.weight {
                forecast.weights.get_or_insert_default().push(weight);
            }
        }
        Ok((self.who, forecast))
    }
}

pub(super) fn whole_number(text: &str, name: &'static str) -> Result<i64, Fault> {
    let number = text.parse().ok().or_else(|| lines::whole_number(text.parse().ok()?));
    number.ok_or_else(|| Fault::named(name, format!("must be a whole number, found {:?}", quoted(text))))
}

/// A pedestrian: a whole number, or a word that is not a number.
fn name(text: &str) -> Result<PedestrianName, Fault> {
    let wrong = text.is_empty() || text.parse::<f64>().is_ok_and(|n| !n.is_infinite() && n.fract() != 0.0);
    if wrong {
        let problem = format!("must be a whole number or a word, found {:?}", quoted(text));
        return Err(Fault::named(REQUIRED[1], problem));
    }
    Ok(PedestrianName::of_text(text))
}

pub(super) fn finite(text: &str, name: &'static str) -> Result<f64, Fault> {
    let number = text.parse::<f64>().ok().filter(|n| n.is_finite());
    number.ok_or_else(|| Fault::named(name, not_finite(&format!("{:?}", quoted(text)))))
}
