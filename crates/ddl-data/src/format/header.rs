//! What the columns of a table hold, by the names that people give them.

use std::borrow::Cow;

use ddl_core::Setting;

use crate::class::{is_one_of, name_words};
use crate::clock::TimeUnit;
use crate::format::choice::ColumnChoice;
use crate::format::column_names::{
    LengthUnit, NamedColumn, Rest, Role, chosen_as, count_columns, is_known, named, rest_beside,
};
use crate::format::fault::{Fault, Field};
use crate::format::layouts::FileLayout;
use crate::format::position_columns::PositionColumns;
use crate::format::quoted::quoted;

/// Names of columns that tell the recordings of one file apart.
const GROUPS: &str = "recording recordingid video videoid videoname clip clipid sequenceid sequencename session \
                      sessionid runid take takeid trial trialid experiment experimentid caseid scenario scenarioid \
                      logid dataset floor floorid locationid site siteid camera cameraid cameraname cam camid sceneid \
                      scenename scenetoken episode episodeid rollout rolloutid simulation simulationid";
/// Names of columns that may tell recordings apart, but often hold something else.
const PARTS: &str = "seq sequence run file log source segment segmentid part partid zone zoneid room area location \
                     place map city vid date day device deviceid sensor sensorid station";
/// Those of `GROUPS` that a stream may call `scene`.
const CAMERAS: &str = "camera cameraid cameraname cam camid sceneid scenename scenetoken";
/// Most faults of columns that say the same in a message.
const MOST_FAULTS: usize = 5;
/// Number of unknown columns that a message names.
const NAMED: usize = 5;
const LIFETIME: &str = "the classes of the tracks are in another file (tracksMeta): vehicles are read too";
const WIDE: &str = "each pedestrian has columns of its own; write a row for each frame and pedestrian: python -c \
    \"import pandas; pandas.wide_to_long(pandas.read_csv('FILE'), ['x', 'y'], 'frame', \
    'pedestrian').dropna().to_csv('rows.csv')\"";
const RULE: &str = "the header must name the columns frame (or time), pedestrian, x and y, each once";

/// What the first column counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TimeColumn {
    /// Frames, unless a value has a fraction: then seconds.
    Frame,
    /// Seconds or dates, as the first value says.
    Time,
    /// Frames, without a unit, or times.
    Known(Option<TimeUnit>),
}

/// What the columns of a text hold, by the names of a header or by a layout.
#[derive(Debug)]
pub(super) struct ColumnRoles {
    pub(super) time: TimeColumn,
    pub(super) frame: usize,
    /// A part of a second beside whole seconds, which are the first column.
    pub(super) rest: Option<Rest>,
    pub(super) pedestrian: usize,
    pub(super) position: PositionColumns,
    /// Units of length per metre; `None` for pixels.
    pub(super) per_metre: Option<f64>,
    /// Whether the names, the layout or the user say that positions are in metres or parts of them.
    pub(super) has_unit: bool,
    pub(super) scene: Option<usize>,
    /// The column of classes, and the class that is read; `None` for all but vehicles.
    pub(super) class: Option<(usize, Option<&'static str>)>,
    /// The column by which the user keeps rows, and its value in them. What marks rows or their class may be that.
    pub(super) keep: Option<(usize, String)>,
    /// The columns that mark rows, each with the mark of those that are left out.
    pub(super) marks: Vec<(usize, bool)>,
    /// Columns whose value must stay the same: others belong to other recordings.
    pub(super) constants: Vec<usize>,
    /// Further columns: those that are not read, and those that must hold numbers.
    pub(super) unread: Vec<usize>,
    pub(super) numbers: Vec<usize>,
    /// What the reader should know of the choice of columns.
    pub(super) remarks: Vec<String>,
}

/// The columns of a header with and without a role.
struct NamedColumns<'a> {
    names: &'a [&'a str],
    /// The words of the names, written together.
    plain: &'a [String],
    found: Vec<NamedColumn>,
    unknown: Vec<usize>,
}

impl ColumnRoles {
    /// The columns of a header.
    ///
    /// # Errors
    /// The first field that is wrong, and everything that is wrong.
    pub(super) fn of_names(names: &[&str], choice: &ColumnChoice) -> Result<Self, Fault> {
        refuse_numbers(names)?;
        let plain: Vec<String> = names.iter().map(|name| name_words(name).concat()).collect();
        let mut roles = NamedColumns::of(names, &plain, choice).roles(choice)?;
        if let Some(rest) = rest_beside(&plain, roles.frame) {
            roles.time = TimeColumn::Known(Some(TimeUnit::Seconds));
            roles.unread.retain(|&index| index != rest.0);
            let [first, second] = [roles.frame, rest.0].map(|index| quoted(names[index]));
            roles.remarks.push(format!("the times are {first} and {second} together"));
            roles.rest = Some(rest);
        }
        if choice.time_unit.is_some() {
            roles.time = TimeColumn::Known(choice.time_unit);
        }
        if let Some(unit) = choice.unit {
            (roles.per_metre, roles.has_unit) = (unit.per_metre(), unit != LengthUnit::Pixels);
        }
        Ok(roles)
    }

    /// The columns of a layout.
    ///
    /// # Errors
    /// When the user names a column, or keeps rows by one that is not there.
    pub(super) fn of_layout(layout: &FileLayout, choice: &ColumnChoice) -> Result<Self, Fault> {
        if let Some((_, name)) = choice.roles.first() {
            return Err(format!("there is no header, so no column is called {name:?}; write one above the rows").into());
        }
        let names: Vec<&str> = layout.names.split(' ').collect();
        let index = |(name, value): &(String, String)| {
            let index = names.iter().position(|column| column.eq_ignore_ascii_case(name));
            let missing = || format!("there is no column {:?} among {}", quoted(name), names.join(", "));
            Ok::<_, Fault>((index.ok_or_else(missing)?, value.clone()))
        };
        let keep = choice.keep.as_ref().map(index).transpose()?;
        let is_kept = |index: usize| keep.as_ref().is_some_and(|(kept, _)| *kept == index);
        let of_row = [&[layout.frame, layout.pedestrian], layout.position.columns()].concat();
        let is_read = |index: usize| of_row.contains(&index) || layout.class.is_some_and(|(class, _)| class == index);
        let has_unit = layout.note.is_some() && layout.per_metre.is_some();
        let is_as_usual = choice.unit.is_none() && choice.keep.is_none();
        let asked = (!is_as_usual).then(|| format!("read as {}, with the unit and the rows asked for", layout.format));
        Ok(Self {
            time: match names[0] {
                "time" => TimeColumn::Known(Some(TimeUnit::Seconds)),
                _ => TimeColumn::Frame,
            },
            frame: layout.frame,
            rest: None,
            pedestrian: layout.pedestrian,
            position: layout.position,
            per_metre: choice.unit.map_or(layout.per_metre, LengthUnit::per_metre),
            has_unit: choice.unit.map_or(has_unit, |unit| unit != LengthUnit::Pixels),
            scene: None,
            class: layout.class.filter(|&(index, _)| !is_kept(index)).map(|(index, class)| (index, Some(class))),
            marks: layout.mark.into_iter().filter(|&(index, _)| !is_kept(index)).collect(),
            keep,
            constants: layout.constant.into_iter().collect(),
            unread: Vec::new(),
            numbers: (0..names.len()).filter(|&index| !is_read(index)).collect(),
            remarks: asked.into_iter().collect(),
        })
    }

    /// The columns that are not read: those that may tell rows apart before those of measurements, as the first row
    /// shows.
    pub(super) fn unread_of_first(&self, fields: &[Cow<'_, str>], names: &[String]) -> Vec<usize> {
        let mut unread = self.unread.clone();
        if unread.len() > NAMED {
            let is_number = |index: &usize| fields[*index].parse::<f64>().is_ok();
            unread.sort_by_key(|index| is_number(index) && !is_one_of(PARTS, &name_words(&names[*index]).concat()));
        }
        unread
    }
}

/// Refuses a first line of numbers, which names no columns.
fn refuse_numbers(names: &[&str]) -> Result<(), Fault> {
    let numbers = names.iter().filter(|name| name.parse::<f64>().is_ok()).count();
    if 2 * numbers <= names.len() || names.iter().any(|name| is_known(name)) {
        return Ok(());
    }
    let count = names.len();
    let detail = if count_columns(names.iter().copied()) {
        format!("found 0, 1, 2, ...; if they count the columns, write the {count} names instead, otherwise above")
    } else {
        format!("found numbers; put a line with the names of the {count} columns above them")
    };
    let example = if count == 4 { ": frame,pedestrian,x,y" } else { "" };
    Err(format!("{RULE}: {detail}{example}").into())
}

impl<'a> NamedColumns<'a> {
    fn of(names: &'a [&'a str], plain: &'a [String], choice: &ColumnChoice) -> Self {
        let mut columns = Self { names, plain, found: Vec::new(), unknown: Vec::new() };
        let has_time = names.iter().any(|name: &&str| named(0, name).is_some_and(|named| named.role == Role::Time));
        // x and y that are given stand for a box as well, and a box for x and y.
        let is_given = |role: Role| choice.roles.iter().any(|(given, _)| given.stands_for(role));
        for (index, name) in names.iter().enumerate() {
            let chosen = choice.roles.iter().find(|(_, chosen)| columns.is_called(name, chosen));
            let by_name = if !has_time && rest_beside(plain, index).is_some() {
                Some(chosen_as(Role::Time, index, name))
            } else {
                named(index, name)
            };
            match (chosen, by_name.filter(|named| !is_given(named.role))) {
                (Some(&(role, _)), _) => columns.found.push(chosen_as(role, index, name)),
                (None, Some(named)) => columns.found.push(named),
                _ if name.is_empty() => {}
                _ => columns.unknown.push(index),
            }
        }
        columns
    }

    /// Whether this is the column that is asked for. Large and small letters count where a column has just that name.
    fn is_called(&self, column: &str, asked: &str) -> bool {
        column == asked || column.eq_ignore_ascii_case(asked) && !self.names.contains(&asked)
    }

    /// The column that the user calls so.
    fn called(&self, asked: &str) -> Option<usize> {
        self.names.iter().position(|column| self.is_called(column, asked))
    }

    /// The column of that role; of several class columns, the first whose name does not end in `id`.
    fn column(&self, role: Role) -> Option<&NamedColumn> {
        let mut found = self.found.iter().filter(|named| named.role == role);
        let is_id =
            |named: &&NamedColumn| role == Role::Class && self.names[named.index].to_ascii_lowercase().ends_with("id");
        found.clone().find(|named| !is_id(named)).or(found.next())
    }

    fn index(&self, role: Role) -> Option<usize> {
        self.column(role).map(|named| named.index)
    }

    fn quoted(&self, index: usize) -> String {
        quoted(self.names[index])
    }

    fn roles(&self, choice: &ColumnChoice) -> Result<ColumnRoles, Fault> {
        if self.position().is_none() && self.names[0].starts_with(['{', '[']) {
            let detail = "this is not a table; tracks as JSON must be TrajNet++ ndjson, one object per line";
            return Err(Fault::at(0, detail));
        }
        if self.is_wide() {
            return Err(WIDE.into());
        }
        let mut faults = self.faults(choice);
        let time = self.column(Role::Time).or(self.column(Role::Frame));
        let parts = (time, self.index(Role::Pedestrian), self.position());
        let ((Some(time), Some(pedestrian), Some(position)), true) = (parts, faults.is_empty()) else {
            faults.extend(self.missing());
            let details: Vec<String> = faults.iter().map(|fault| fault.problem.to_string()).collect();
            let field = faults.into_iter().find_map(|fault| fault.field);
            return Err(Fault { field, ..format!("{RULE}: {}", details.join("; ")).into() });
        };
        let is_point = matches!(position, PositionColumns::Point(_));
        let length = [Role::X, Role::Y].into_iter().find_map(|role| self.column(role)?.length);
        let keep = choice.keep.as_ref().and_then(|(name, value)| Some((self.kept(name)?, value.clone())));
        let is_kept = |index: usize| keep.as_ref().is_some_and(|(kept, _)| *kept == index);
        let marks = [(Role::Lost, true), (Role::Valid, false)].into_iter();
        let marks = marks.filter_map(|(role, left_out)| Some((self.index(role)?, left_out)));
        let unread = self.unread(is_point);
        let is_group = |index: &usize| self.index(Role::Scene).is_none() && is_one_of(GROUPS, &self.plain[*index]);
        Ok(ColumnRoles {
            remarks: self.remarks(time, is_point, choice.unit.is_none() && length.is_none()),
            time: match (time.role, time.time_unit) {
                (Role::Frame, _) => TimeColumn::Frame,
                (_, None) => TimeColumn::Time,
                (_, Some(unit)) => TimeColumn::Known(Some(unit)),
            },
            frame: time.index,
            rest: None,
            pedestrian,
            position,
            has_unit: is_point && matches!(length, Some(LengthUnit::PerMetre(_))),
            per_metre: if is_point { length.map_or(Some(1.0), LengthUnit::per_metre) } else { None },
            scene: self.index(Role::Scene),
            class: self.index(Role::Class).filter(|&index| !is_kept(index)).map(|index| (index, None)),
            marks: marks.filter(|&(index, _)| !is_kept(index)).collect(),
            keep,
            constants: unread.iter().copied().filter(is_group).collect(),
            unread,
            numbers: Vec::new(),
        })
    }

    /// The columns that are not read, in order: those of a box beside x and y, too.
    fn unread(&self, is_point: bool) -> Vec<usize> {
        let beside = self.found.iter().filter(|named| {
            let is_further = named.role.may_repeat() && Some(named.index) != self.index(named.role);
            is_further || is_point && named.role > Role::Class
        });
        let mut unread: Vec<usize> = beside.map(|named| named.index).chain(self.unknown.iter().copied()).collect();
        unread.sort_unstable();
        unread
    }

    /// What was chosen although it may be otherwise.
    fn remarks(&self, time: &NamedColumn, is_point: bool, is_assumed: bool) -> Vec<String> {
        let mut remarks = Vec::new();
        if let Some(frame) = self.index(Role::Frame).filter(|&frame| frame != time.index) {
            let (when, frames) = (self.quoted(time.index), column_of("frame", &self.quoted(frame)));
            remarks.push(format!("the times are those of the column {when}; {frames} takes the frames"));
        }
        let has_size = self.index(Role::Width).is_some() && self.index(Role::Height).is_some();
        if let Some(x) = self.index(Role::X).filter(|_| is_point && is_assumed && has_size) {
            let x = self.quoted(x);
            remarks.push(if x.eq_ignore_ascii_case("x") {
                let corner = Setting::Columns.to("left=x,top=y");
                format!("x and y are read as the position; if they are the corner of the box, give {corner}")
            } else {
                let (pixels, homography) = (Setting::Unit.to("px"), Setting::Homography);
                format!("{x} is read as metres; of a box in a picture, give {pixels} and {homography}")
            });
        }
        // A known name of the x coordinate, with z for x.
        let is_x = |name: &str| named(0, name).is_some_and(|named| named.role == Role::X);
        let is_height = |name: &&&str| !is_x(name) && is_x(&name.to_ascii_lowercase().replace('z', "x"));
        if let Some(z) = self.names.iter().find(is_height).filter(|_| is_point) {
            let given = column_of("y", &quoted(z));
            remarks.push(format!("{} is taken for the height; if y is, give {given}", quoted(z)));
        }
        if self.names.iter().any(|name| name.eq_ignore_ascii_case("trackLifetime")) {
            remarks.push(LIFETIME.to_owned());
        }
        remarks
    }

    fn position(&self) -> Option<PositionColumns> {
        self.point().map(PositionColumns::Point).or_else(|| self.corner())
    }

    fn point(&self) -> Option<[usize; 2]> {
        Some([self.index(Role::X)?, self.index(Role::Y)?])
    }

    /// The foot of a box.
    fn corner(&self) -> Option<PositionColumns> {
        let (left, top) = (self.index(Role::Left)?, self.index(Role::Top)?);
        if let (Some(width), Some(height)) = (self.index(Role::Width), self.index(Role::Height)) {
            return Some(PositionColumns::Foot([left, top, width, height]));
        }
        let [right, bottom] = [self.index(Role::Right)?, self.index(Role::Bottom)?];
        Some(PositionColumns::FootOfCorners([left, top, right, bottom]))
    }

    /// The column by which rows are kept, by its role or its name.
    fn kept(&self, name: &str) -> Option<usize> {
        self.index(Role::Class).filter(|_| name == "class").or_else(|| self.called(name))
    }

    /// Everything that is wrong with the columns that are there, and choices of others.
    fn faults(&self, choice: &ColumnChoice) -> Vec<Fault> {
        let mut faults = self.repeated();
        let chosen = choice.roles.iter().map(|(_, name)| name).filter(|name| self.called(name).is_none());
        let kept = choice.keep.iter().map(|(name, _)| name).filter(|name| self.kept(name).is_none());
        let absent = |name: &String| format!("there is no column {:?}", quoted(name)).into();
        faults.extend(chosen.chain(kept).map(absent));
        if let Some(&index) = self.unknown.iter().find(|&&index| self.plain[index] == "observeduntil") {
            let detail = "this is a table of forecasts; give the tracks that they were made from";
            faults.push(Fault::at(index, format!("column {:?}: {detail}", self.quoted(index))));
        }
        // A unit that is given is that of both columns.
        if let (Some(x), Some(y), None) = (self.column(Role::X), self.column(Role::Y), choice.unit)
            && !are_alike(x.length, y.length)
        {
            let (of_x, of_y, unit) = (self.quoted(x.index), self.quoted(y.index), Setting::Unit);
            let problem = format!("the columns {of_x:?} and {of_y:?} have different units; {unit} sets one for both");
            faults.push(Fault::at(y.index, problem));
        }
        faults
    }

    /// Columns that say the same.
    fn repeated(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        for again in self.found.iter().filter(|named| !named.role.may_repeat()) {
            if let Some(first) = self.index(again.role).filter(|&first| first != again.index) {
                let [first, second] = [first, again.index].map(|index| self.quoted(index));
                let problem = format!("the columns {first:?} and {second:?} both say the same");
                faults.push(Fault::at(again.index, problem));
            }
        }
        if let (Some([x, _]), Some(corner)) = (self.point(), self.corner()) {
            let [x, corner] = [x, corner.columns()[0]].map(|index| self.quoted(index));
            let of_box = column_of("left", &corner);
            faults.push(
                format!("the columns {x:?} and {corner:?} both say where: {of_box} takes the box, x={x} the point")
                    .into(),
            );
        }
        if !faults.is_empty() {
            faults.truncate(MOST_FAULTS);
            let example = Setting::Columns.to("x=NAME,y=NAME, left=NAME,...");
            faults.push(format!("leave one of two out, or choose ({example})").into());
        }
        faults
    }

    /// Whether each pedestrian has columns of its own, such as `x1,y1,x2,y2`, instead of rows.
    fn is_wide(&self) -> bool {
        let of_axis = |axis: char| {
            let numbered = self.plain.iter().filter(|name| name.contains(|c: char| c.is_ascii_digit()));
            let letters = numbered.map(|name| name.replace(|c: char| c.is_ascii_digit(), ""));
            letters.filter(|name| name.starts_with(axis) || name.ends_with(axis)).count()
        };
        // Of two pedestrians the names may be those of a box.
        let few = if self.position().is_some() { 2 } else { 1 };
        of_axis('x') > few && of_axis('x') == of_axis('y') && self.column(Role::Pedestrian).is_none()
    }

    fn missing(&self) -> Option<Fault> {
        let has = |role: Role| self.column(role).is_some();
        let has_position = self.position().is_some();
        let roles = [
            ("frame", has(Role::Time) || has(Role::Frame)),
            ("pedestrian", has(Role::Pedestrian)),
            ("x", has_position || has(Role::X)),
            ("y", has_position || has(Role::Y)),
        ];
        let missing: Vec<&str> = roles.iter().filter(|(_, is_there)| !is_there).map(|(name, _)| *name).collect();
        let (role, first) = (missing.first()?, self.unknown.first().copied());
        let unknown: Vec<String> = self.unknown.iter().map(|&index| format!("{:?}", self.quoted(index))).collect();
        let rename = first.map_or_else(String::new, |_| {
            let (name, unknown) = (column_of(role, "NAME"), first_of(&unknown));
            format!("; rename the column that holds it, or name it ({name}): unknown are {unknown}")
        });
        let problem = format!("still missing: {}{rename}", missing.join(", "));
        Some(Fault { field: first.map(Field::at), problem: problem.into() })
    }
}

/// Whether the columns of x and y have the same unit. `agent_px` beside `agent_py` is a coordinate, not a unit.
fn are_alike(x: Option<LengthUnit>, y: Option<LengthUnit>) -> bool {
    let metres = LengthUnit::PerMetre(1.0);
    match (x, y) {
        (Some(LengthUnit::Pixels), None) | (None, Some(LengthUnit::Pixels)) => true,
        _ => x.unwrap_or(metres) == y.unwrap_or(metres),
    }
}

/// The choice of a column for a role.
fn column_of(role: &str, name: &str) -> String {
    Setting::Columns.to(format!("{role}={name}"))
}

/// Whether a column tells cameras apart, which a stream does by scenes.
pub(super) fn is_camera(name: &str) -> bool {
    is_one_of(CAMERAS, &name_words(name).concat())
}

/// The names, at most five of them.
pub(super) fn first_of(names: &[String]) -> String {
    match names.len() {
        0..=NAMED => names.join(", "),
        all => format!("{} and {} more", names[..NAMED].join(", "), all - NAMED),
    }
}
