//! What the user says of the columns of text.

use std::fmt;

use ddl_core::Setting;

use crate::clock::TimeUnit;
use crate::format::column_names::{LengthUnit, Role, role_names, role_of_unit, unit_of_role};
use crate::format::kind::Format;

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
    /// As those; the message begins with the name of the option.
    pub fn given([columns, keep, unit]: [Option<&str>; 3], is_mapped: bool) -> Result<Self, String> {
        let mut choice = Self { is_mapped, ..Self::default() };
        if let Some(columns) = columns {
            choice = choice.with_columns(columns).map_err(|problem| format!("columns {problem}"))?;
        }
        if let Some(keep) = keep {
            choice = choice.keeping(keep).map_err(|problem| format!("keep {problem}"))?;
        }
        if let Some(unit) = unit {
            choice = choice.in_unit(unit).map_err(|problem| format!("unit {problem}"))?;
        }
        Ok(choice)
    }

    /// Names the columns that hold the frame (or time), pedestrian, x, y, the sides of a box, class or scene, such as
    /// `frame=frame_id,x=xCenter`. Columns that are not named keep the meaning of their names.
    ///
    /// # Errors
    /// When the text has another form; the message says which.
    pub fn with_columns(mut self, text: &str) -> Result<Self, String> {
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
                return Err(format!(
                    "must be like frame=frame_id,x=xCenter, with any of {}, found {part:?}",
                    roles.join(", ")
                ));
            };
            if self.roles.iter().any(|(other, taken)| *other == role || *taken == name) {
                return Err(format!("gives the role or the column of {part:?} a second time"));
            }
            self.roles.push((role, name));
            self.time_unit = self.time_unit.or(time_unit);
        }
        Ok(self)
    }

    /// # Errors
    /// When something is chosen, and the format has neither columns nor other units.
    pub(super) fn refuse_for(&self, format: Format) -> Result<(), String> {
        if self.roles.is_empty() && self.keep.is_none() && self.unit.is_none() {
            Ok(())
        } else {
            let [columns, keep, unit] = [Setting::Columns, Setting::Keep, Setting::Unit];
            let leave = format!("leave out {columns}, {keep} and {unit}");
            Err(format!("the format {format} has no columns and units to choose; {leave}"))
        }
    }

    /// Only rows with a value in a column count, such as `class=Pedestrian`: `class`, or the name of a column.
    ///
    /// # Errors
    /// When the text has another form.
    pub fn keeping(mut self, text: &str) -> Result<Self, String> {
        let pair = text.split_once('=').map(|(name, value)| (name.trim(), value.trim()));
        let Some((name, value)) = pair.filter(|(name, value)| !name.is_empty() && !value.is_empty()) else {
            return Err(format!("must be like class=Pedestrian, found {text:?}"));
        };
        self.keep = Some((name.to_owned(), value.to_owned()));
        Ok(self)
    }

    /// The positions are in `m`, `cm`, `mm` or `px`.
    ///
    /// # Errors
    /// For another unit.
    pub fn in_unit(mut self, unit: &str) -> Result<Self, String> {
        self.unit = Some(match unit {
            "m" => LengthUnit::PerMetre(1.0),
            "cm" => LengthUnit::PerMetre(100.0),
            "mm" => LengthUnit::PerMetre(1000.0),
            "px" => LengthUnit::Pixels,
            _ => return Err(format!("must be m, cm, mm or px, found {unit:?}")),
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
