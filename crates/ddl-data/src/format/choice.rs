//! What the user says of the columns of text.

use std::fmt;

use ddl_core::Setting;
use thiserror::Error;

use crate::clock::TimeUnit;
use crate::format::column_names::{LengthUnit, Role, role_names, role_of_unit, unit_of_role};
use crate::format::fault::Problem;
use crate::format::kind::Format;

/// What a user gives of the columns of text cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{setting} {problem}")]
pub struct ChoiceError {
    /// What was given.
    pub setting: Setting,
    /// What is wrong with it; the text follows its name.
    pub problem: Problem,
}

/// What the columns of text are and which rows count, where their names do not say it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnChoice {
    /// Roles, each with the name of its column.
    pub(super) roles: Vec<(Role, String)>,
    /// What a column of times counts.
    pub(super) time_unit: Option<TimeUnit>,
    /// Only rows with this value in this column count.
    pub(super) keep: Option<(String, String)>,
    pub(super) unit: Option<LengthUnit>,
    /// Whether a homography maps the positions.
    pub(super) is_mapped: bool,
}

impl ColumnChoice {
    /// What a user gives: [columns](Self::with_columns), [keep](Self::keeping) and [unit](Self::in_unit), and whether a
    /// homography will map the positions, which are then in pixels.
    ///
    /// # Errors
    /// As those.
    pub fn given([columns, keep, unit]: [Option<&str>; 3], is_mapped: bool) -> Result<Self, ChoiceError> {
        let mut choice = Self { is_mapped, ..Self::default() };
        if let Some(columns) = columns {
            choice = choice.with_columns(columns)?;
        }
        if let Some(keep) = keep {
            choice = choice.keeping(keep)?;
        }
        if let Some(unit) = unit {
            choice = choice.in_unit(unit)?;
        }
        Ok(choice)
    }

    /// Names the columns that hold the frame (or time), pedestrian, x, y, the sides of a box, class or scene, such as
    /// `frame=frame_id,x=xCenter`. Columns that are not named keep the meaning of their names.
    ///
    /// # Errors
    /// When the text has another form; the message says which.
    pub fn with_columns(mut self, text: &str) -> Result<Self, ChoiceError> {
        let wrong = |problem| ChoiceError { setting: Setting::Columns, problem };
        for part in text.split(',') {
            let pair = part.split_once('=').map(|(role, name)| (role.trim(), name.trim()));
            let time_unit = pair.and_then(|(word, _)| unit_of_role(word));
            let role = |word: &str| {
                let word = if time_unit.is_some() { "time" } else { word };
                role_names().find(|(_, name)| *name == word).map(|(role, _)| role)
            };
            let given = pair.and_then(|(word, name)| Some((role(word)?, name.to_owned())));
            let Some((role, name)) = given.filter(|(_, name)| !name.is_empty()) else {
                let roles: Vec<&str> = role_names().map(|(_, name)| name).collect();
                let wanted = format!("like frame=frame_id,x=xCenter, with any of {}", roles.join(", "));
                return Err(wrong(Problem::value("", wanted, format!("{part:?}"))));
            };
            if self.roles.iter().any(|(other, taken)| *other == role || *taken == name) {
                return Err(wrong(format!("gives the role or the column of {part:?} a second time").into()));
            }
            self.roles.push((role, name));
            self.time_unit = self.time_unit.or(time_unit);
        }
        Ok(self)
    }

    /// # Errors
    /// When something is chosen, and the format has neither columns nor other units.
    pub(super) fn refuse_for(&self, format: Format) -> Result<(), Problem> {
        if self.roles.is_empty() && self.keep.is_none() && self.unit.is_none() {
            return Ok(());
        }
        let [columns, keep, unit] = [Setting::Columns, Setting::Keep, Setting::Unit];
        let advice = format!("leave out {columns}, {keep} and {unit}");
        Err(format!("the format {format} has no columns and units to choose; {advice}").into())
    }

    /// Only rows with a value in a column count, such as `class=Pedestrian`: `class`, or the name of a column.
    ///
    /// # Errors
    /// When the text has another form.
    pub fn keeping(mut self, text: &str) -> Result<Self, ChoiceError> {
        let pair = text.split_once('=').map(|(name, value)| (name.trim(), value.trim()));
        let Some((name, value)) = pair.filter(|(name, value)| !name.is_empty() && !value.is_empty()) else {
            let problem = Problem::value("", "like class=Pedestrian", format!("{text:?}"));
            return Err(ChoiceError { setting: Setting::Keep, problem });
        };
        self.keep = Some((name.to_owned(), value.to_owned()));
        Ok(self)
    }

    /// The positions are in `m`, `cm`, `mm` or `px`.
    ///
    /// # Errors
    /// For another unit.
    pub fn in_unit(mut self, unit: &str) -> Result<Self, ChoiceError> {
        self.unit = Some(match unit {
            "m" => LengthUnit::PerMetre(1.0),
            "cm" => LengthUnit::PerMetre(100.0),
            "mm" => LengthUnit::PerMetre(1000.0),
            "px" => LengthUnit::Pixels,
            _ => {
                let problem = Problem::value("", "m, cm, mm or px", format!("{unit:?}"));
                return Err(ChoiceError { setting: Setting::Unit, problem });
            }
        });
        Ok(self)
    }
}

impl fmt::Display for ColumnChoice {
    /// The columns, as [`with_columns`](Self::with_columns) reads them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of_time = self.time_unit.and_then(role_of_unit);
        let word = |role: Role| {
            let word = role_names().find(|(other, _)| *other == role).map_or("", |(_, word)| word);
            of_time.as_deref().filter(|_| role == Role::Time).unwrap_or(word)
        };
        let columns: Vec<String> = self.roles.iter().map(|(role, name)| format!("{}={name}", word(*role))).collect();
        f.write_str(&columns.join(","))
    }
}
