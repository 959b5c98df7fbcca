//! The comma-separated table: a row for each position.

use std::collections::HashSet;
use std::io::BufRead;

use csv::StringRecord;
use ddl_data::{HORIZON, PedestrianName, Position};

use super::bounds::within_bounds;
use super::error::{ForeignError, ForeignProblem};
use super::lines::{Lines, Wrong, in_field, whole_line};
use super::numbering::Numbering;
use super::repair::quoted;
use super::table_rows::{AtLine, TableRows};
use super::walkers::{WalkerForecast, Walkers, Who, in_short};
use crate::Protocol;

const REQUIRED: [&str; 5] = ["observed_until", "pedestrian", "frame", "x", "y"];
/// Whole numbers are below this in size: exact in an `f64`.
const LIMIT: f64 = 9_007_199_254_740_992.0;

pub(super) fn read(
    lines: Lines<impl BufRead>,
    walkers: &mut Walkers<'_>,
) -> Result<(), ForeignError> {
    let mut rows = TableRows::new(lines);
    let mut record = StringRecord::new();
    if rows.next(&mut record)?.is_none() {
        return Ok(());
    }
    let columns = Columns::of(&record).map_err(|wrong| rows.wrong(wrong))?;
    let mut numbering = Numbering::default();
    let mut group: Option<Group> = None;
    while let Some(number) = rows.next(&mut record)? {
        let row = columns.row(&record).map_err(|wrong| rows.wrong(wrong))?;
        if group.as_ref().is_some_and(|group| group.who != row.who) {
            put(group.take(), walkers, &mut numbering).map_err(|wrong| rows.wrong_at(wrong))?;
        }
        let group = group.get_or_insert_with(|| Group::new(row.who.clone(), number));
        group.add(&row, number).map_err(|wrong| rows.wrong(wrong))?;
    }
    put(group, walkers, &mut numbering).map_err(|wrong| rows.wrong_at(wrong))
}

/// Hands over a walker whose rows are complete; an error with its line.
fn put(
    group: Option<Group>,
    walkers: &mut Walkers<'_>,
    numbering: &mut Numbering,
) -> Result<(), AtLine<Wrong>> {
    let Some(group) = group else { return Ok(()) };
    let line = group.line;
    let (who, forecast) = group.forecast(numbering)?;
    let put = walkers.put(&who, forecast, line, true);
    put.map_err(|wrong| (line, wrong))
}

/// Which column holds what.
#[derive(Debug)]
struct Columns {
    count: usize,
    required: [usize; REQUIRED.len()],
    recording: Option<usize>,
    hypothesis: Option<usize>,
    weight: Option<usize>,
}

/// One position.
#[derive(Debug)]
struct Row {
    who: Who,
    hypothesis: i64,
    weight: Option<f64>,
    frame: i64,
    position: Position,
}

impl Columns {
    fn of(header: &StringRecord) -> Result<Self, Wrong> {
        let names: Vec<&str> = header.iter().map(str::trim).collect();
        let wrong = |detail: String| whole_line(ForeignProblem::Header { detail });
        let find = |name: &str| {
            let mut places = (0..names.len()).filter(|&i| names[i] == name);
            let place = places.next();
            match places.next() {
                None => Ok(place),
                Some(_) => Err(wrong(format!("column {name} is there twice"))),
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

    fn row(&self, fields: &StringRecord) -> Result<Row, Wrong> {
        if fields.len() != self.count {
            let (expected, found) = (self.count, fields.len());
            return Err(whole_line(ForeignProblem::FieldCount { expected, found }));
        }
        let [observed_until, pedestrian, frame, x, y] =
            self.required.map(|place| fields[place].trim());
        let who = Who {
            recording: self
                .recording
                .map(|place| fields[place].trim())
                .filter(|name| !name.is_empty())
                .map(str::to_owned),
            observed_until: whole(observed_until, REQUIRED[0])?,
            pedestrian: name(pedestrian)?,
        };
        let hypothesis = match self.hypothesis {
            None => 0,
            Some(place) => whole(fields[place].trim(), "hypothesis")?,
        };
        let weight = match self.weight {
            None => None,
            Some(place) => Some(finite(fields[place].trim(), "weight")?),
        };
        let position = [finite(x, REQUIRED[3])?, finite(y, REQUIRED[4])?];
        within_bounds(position, || "x, y".to_owned())?;
        Ok(Row {
            who,
            hypothesis,
            weight,
            frame: whole(frame, REQUIRED[2])?,
            position,
        })
    }
}

/// The rows of one walker so far.
#[derive(Debug)]
struct Group {
    who: Who,
    line: usize,
    /// In the order of the file.
    hypotheses: Vec<Rows>,
    numbers: HashSet<i64>,
}

#[derive(Debug)]
struct Rows {
    hypothesis: i64,
    line: usize,
    weight: Option<f64>,
    frames: Vec<i64>,
    positions: Vec<Position>,
}

impl Group {
    fn new(who: Who, line: usize) -> Self {
        Self {
            who,
            line,
            hypotheses: Vec::new(),
            numbers: HashSet::new(),
        }
    }

    fn add(&mut self, row: &Row, line: usize) -> Result<(), Wrong> {
        let hypothesis = row.hypothesis;
        if self
            .hypotheses
            .last()
            .is_none_or(|last| last.hypothesis != hypothesis)
        {
            if !self.numbers.insert(hypothesis) {
                let problem = ForeignProblem::Scattered { hypothesis };
                return Err(in_field("hypothesis", problem));
            }
            if self.hypotheses.len() == Protocol::MOST_HYPOTHESES {
                let problem = self.who.too_many_hypotheses();
                return Err(in_field("hypothesis", problem));
            }
            self.hypotheses.push(Rows {
                hypothesis,
                line,
                weight: row.weight,
                frames: Vec::with_capacity(HORIZON),
                positions: Vec::with_capacity(HORIZON),
            });
        }
        let Some(rows) = self.hypotheses.last_mut() else {
            return Ok(());
        };
        if let (Some(first), Some(found)) = (rows.weight, row.weight)
            && first.to_bits() != found.to_bits()
        {
            let problem = ForeignProblem::WeightChanges { first, found };
            return Err(in_field("weight", problem));
        }
        if rows.positions.len() == HORIZON {
            let (expected, found) = (HORIZON, HORIZON + 1);
            return Err(whole_line(ForeignProblem::Length { expected, found }));
        }
        rows.frames.push(row.frame);
        rows.positions.push(row.position);
        Ok(())
    }

    /// The forecast, or what is wrong with it and on which line.
    fn forecast(
        mut self,
        numbering: &mut Numbering,
    ) -> Result<(Who, WalkerForecast), AtLine<Wrong>> {
        self.hypotheses.sort_by_key(|rows| rows.hypothesis);
        let numbers: Vec<i64> = self.hypotheses.iter().map(|rows| rows.hypothesis).collect();
        numbering
            .check(&numbers, &self.who.named())
            .map_err(|problem| (self.line, in_field("hypothesis", problem)))?;
        let mut forecast = WalkerForecast::default();
        for rows in self.hypotheses {
            let found = rows.positions.len();
            if found != HORIZON {
                let expected = HORIZON;
                let problem = ForeignProblem::Length { expected, found };
                return Err((rows.line, whole_line(problem)));
            }
            let frames = forecast.frames.get_or_insert_with(|| rows.frames.clone());
            if *frames != rows.frames {
                let problem = ForeignProblem::Frames {
                    expected: in_short(frames),
                    found: in_short(&rows.frames),
                };
                return Err((rows.line, in_field("frame", problem)));
            }
            forecast.positions.extend(rows.positions);
            if let Some(weight) = rows.weight {
                forecast.weights.get_or_insert_default().push(weight);
            }
        }
        Ok((self.who, forecast))
    }
}

fn whole(text: &str, name: &'static str) -> Result<i64, Wrong> {
    let number = text.parse::<i64>().ok().or_else(|| {
        let number = text.parse::<f64>().ok()?;
        (number.fract() == 0.0 && number.abs() < LIMIT).then_some(number as i64)
    });
    number.ok_or_else(|| {
        let (expected, found) = ("a whole number", format!("{:?}", quoted(text)));
        in_field(name, ForeignProblem::Kind { expected, found })
    })
}

/// A pedestrian: a whole number, or a word, which is no number at all.
fn name(text: &str) -> Result<PedestrianName, Wrong> {
    let wrong = text.is_empty()
        || text
            .parse::<f64>()
            .is_ok_and(|n| !n.is_infinite() && n.fract() != 0.0);
    if wrong {
        let (expected, found) = ("a whole number or a word", format!("{:?}", quoted(text)));
        return Err(in_field(
            REQUIRED[1],
            ForeignProblem::Kind { expected, found },
        ));
    }
    Ok(PedestrianName::of_text(text))
}

fn finite(text: &str, name: &'static str) -> Result<f64, Wrong> {
    let number = text.parse::<f64>().ok().filter(|n| n.is_finite());
    number.ok_or_else(|| {
        let found = format!("{:?}", quoted(text));
        in_field(name, ForeignProblem::NotFinite { found })
    })
}
