//! The header of a table: what its columns hold, by the names that people give them.

use std::borrow::Cow;

use ddl_core::Setting;

use crate::clock::TimeUnit;
use crate::format::choice::ColumnChoice;
use crate::format::column_names::{
    LengthUnit, Named, Rest, Role, chosen_as, count_columns, is_known, is_one_of, named, rest_beside, words,
};
use crate::format::field::quoted;
use crate::format::layouts::Layout;
use crate::format::position_columns::Place;

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

/// The columns that a header names, or a layout.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) time: TimeColumn,
    pub(super) frame: usize,
    /// A part of a second beside whole seconds, which are the first column.
    pub(super) rest: Option<Rest>,
    pub(super) pedestrian: usize,
    pub(super) place: Place,
    /// Units of length per metre; `None` for pixels.
    pub(super) per_metre: Option<f64>,
    /// Whether the names, the layout or the user say that positions are in metres or parts of them.
    pub(super) has_unit: bool,
    pub(super) scene: Option<usize>,
    /// The column of classes (`None` in a layout, which names its own), and the one by which the user keeps rows.
    pub(super) class: Option<usize>,
    pub(super) keep: Option<usize>,
    /// The columns that mark rows, each with the mark of those that are left out.
    pub(super) marks: Vec<(usize, bool)>,
    /// Columns whose value must stay the same: others belong to other recordings.
    pub(super) groups: Vec<usize>,
    /// Further columns.
    pub(super) unread: Vec<usize>,
    /// What the reader should know of the choice of columns.
    pub(super) remarks: Vec<String>,
}

/// A fault of a header: the field, counted from 0, and the text.
pub(super) type Fault = (Option<usize>, String);

/// The columns of a header with and without a role.
struct Roles<'a> {
    names: &'a [&'a str],
    found: Vec<Named>,
    unknown: Vec<usize>,
}

impl Header {
    /// # Errors
    /// The first field that is wrong, and everything that is wrong.
    pub(super) fn of(names: &[&str], choice: &ColumnChoice) -> Result<Self, Fault> {
        let numbers = names.iter().filter(|name| name.parse::<f64>().is_ok());
        if 2 * numbers.count() > names.len() && !names.iter().any(|name| is_known(name)) {
            let count = names.len();
            let detail = if count_columns(names.iter().copied()) {
                format!(
                    "found 0, 1, 2, ...; if they count the columns, write the {count} names instead, otherwise above"
                )
            } else {
                format!("found numbers; put a line with the names of the {count} columns above them")
            };
            let example = if count == 4 { ": frame,pedestrian,x,y" } else { "" };
            return Err((None, format!("{RULE}: {detail}{example}")));
        }
        let mut roles = Roles { names, found: Vec::new(), unknown: Vec::new() };
        let plain: Vec<String> = names.iter().map(|name| words(name).concat()).collect();
        let has_no_time = !names.iter().any(|name| named(0, name).is_some_and(|named| named.role == Role::Time));
        for (index, name) in names.iter().enumerate() {
            let chosen = choice.roles.iter().find(|(_, chosen)| is_called(names, name, chosen));
            // x and y that are given stand for a box as well, and a box for x and y.
            let is_given = |role: Role| choice.roles.iter().any(|(given, _)| given.stands_for(role));
            let by_name = if has_no_time && rest_beside(&plain, index).is_some() {
                Some(chosen_as(Role::Time, index, name))
            } else {
                named(index, name)
            };
            match (chosen, by_name) {
                (Some(&(role, _)), _) => roles.found.push(chosen_as(role, index, name)),
                (None, Some(named)) if !is_given(named.role) => roles.found.push(named),
                _ if name.is_empty() => {}
                _ => roles.unknown.push(index),
            }
        }
        let mut header = roles.header(choice)?;
        if let Some(rest) = rest_beside(&plain, header.frame) {
            header.time = TimeColumn::Known(Some(TimeUnit::Seconds));
            header.rest = Some(rest);
            header.unread.retain(|&index| index != rest.0);
            let [first, rest] = [header.frame, rest.0].map(|index| quoted(names[index]));
            header.remarks.push(format!("the times are {first} and {rest} together"));
        }
        if choice.time_unit.is_some() {
            header.time = TimeColumn::Known(choice.time_unit);
        }
        if let Some(unit) = choice.unit {
            header.per_metre = unit.per_metre();
            header.has_unit = unit != LengthUnit::Pixels;
        }
        Ok(header)
    }

    /// Moves names of columns that may tell rows apart before those of measurements, as the first row shows.
    pub(super) fn name_words_first(&mut self, fields: &[Cow<'_, str>], names: &[String]) {
        if self.unread.len() > NAMED {
            let is_number = |index: &usize| fields[*index].parse::<f64>().is_ok();
            self.unread.sort_by_key(|index| is_number(index) && !is_one_of(PARTS, &words(&names[*index]).concat()));
        }
    }

    /// The columns of a layout.
    ///
    /// # Errors
    /// When the user keeps rows by a column that is not there.
    pub(super) fn of_layout(layout: &Layout, choice: &ColumnChoice, remarks: Vec<String>) -> Result<Self, String> {
        let index = |name: &String| {
            let mut names = layout.names.split(' ');
            names.position(|column| column.eq_ignore_ascii_case(name)).ok_or_else(|| {
                let names = layout.names.replace(' ', ", ");
                format!("there is no column {:?} among {names}", quoted(name))
            })
        };
        let is_timed = layout.names.starts_with("time ");
        let has_unit = layout.note.is_some() && layout.per_metre.is_some();
        Ok(Self {
            time: if is_timed { TimeColumn::Known(Some(TimeUnit::Seconds)) } else { TimeColumn::Frame },
            frame: layout.frame,
            rest: None,
            pedestrian: layout.pedestrian,
            place: layout.place,
            per_metre: choice.unit.map_or(layout.per_metre, LengthUnit::per_metre),
            has_unit: choice.unit.map_or(has_unit, |unit| unit != LengthUnit::Pixels),
            scene: None,
            class: None,
            keep: choice.keep.as_ref().map(|(name, _)| index(name)).transpose()?,
            marks: layout.mark.into_iter().collect(),
            groups: layout.constant.into_iter().collect(),
            unread: Vec::new(),
            remarks,
        })
    }
}

impl Roles<'_> {
    /// The column of that role; of several class columns, the first whose name does not end in `id`.
    fn of(&self, role: Role) -> Option<&Named> {
        let mut found = self.found.iter().filter(|named| named.role == role);
        let is_id =
            |named: &&Named| role == Role::Class && self.names[named.index].to_ascii_lowercase().ends_with("id");
        found.clone().find(|named| !is_id(named)).or(found.next())
    }

    fn header(&self, choice: &ColumnChoice) -> Result<Header, Fault> {
        if self.place().is_none() && self.names[0].starts_with(['{', '[']) {
            let detail = "this is not a table; tracks as JSON must be TrajNet++ ndjson, one object per line";
            return Err((Some(0), detail.to_owned()));
        }
        if let Some(detail) = self.wide() {
            return Err((None, detail));
        }
        let mut faults = self.repeated();
        faults.extend(self.not_there(choice));
        faults.extend(self.other_rows());
        // A unit that is given is that the unit of both columns.
        faults.extend(self.mixed_units().filter(|_| choice.unit.is_none()));
        let time = self.of(Role::Time).or(self.of(Role::Frame));
        let parts = time.zip(self.of(Role::Pedestrian)).zip(self.place());
        let Some(((time, pedestrian), place)) = parts.filter(|_| faults.is_empty()) else {
            faults.extend(self.missing());
            let field = faults.iter().find_map(|(field, _)| *field);
            let details: Vec<String> = faults.into_iter().map(|(_, detail)| detail).collect();
            return Err((field, format!("{RULE}: {}", details.join("; "))));
        };
        let is_point = matches!(place, Place::Point(_));
        let of_length = self.of(Role::X).and_then(|named| named.length);
        let of_length = of_length.or(self.of(Role::Y).and_then(|named| named.length));
        let unread = self.unread(is_point);
        Ok(Header {
            remarks: self.remarks(time, is_point, choice.unit.is_none() && of_length.is_none()),
            time: match (time.role, time.time_unit) {
                (Role::Frame, _) => TimeColumn::Frame,
                (_, None) => TimeColumn::Time,
                (_, Some(unit)) => TimeColumn::Known(Some(unit)),
            },
            frame: time.index,
            rest: None,
            pedestrian: pedestrian.index,
            place,
            has_unit: is_point && matches!(of_length, Some(LengthUnit::PerMetre(_))),
            per_metre: match of_length {
                _ if !is_point => None,
                None => Some(1.0),
                Some(unit) => unit.per_metre(),
            },
            scene: self.index(Role::Scene),
            class: self.index(Role::Class),
            marks: [(Role::Lost, true), (Role::Valid, false)]
                .into_iter()
                .filter_map(|(role, left_out)| Some((self.index(role)?, left_out)))
                .collect(),
            groups: match self.of(Role::Scene) {
                Some(_) => Vec::new(),
                None => unread.iter().copied().filter(|&index| self.is_group(index)).collect(),
            },
            keep: choice.keep.as_ref().and_then(|(name, _)| self.kept(name)),
            unread,
        })
    }

    /// The columns that are not read, in order: those of a box beside x and y, too.
    fn unread(&self, is_point: bool) -> Vec<usize> {
        let beside = self.found.iter().filter(|named| {
            let is_further = named.role.may_repeat() && Some(named.index) != self.index(named.role);
            is_further || is_point && named.role > Role::Class
        });
        let beside = beside.map(|named| named.index);
        let mut unread: Vec<usize> = beside.chain(self.unknown.iter().copied()).collect();
        unread.sort_unstable();
        unread
    }

    /// What was chosen although it may be otherwise.
    fn remarks(&self, time: &Named, is_point: bool, is_assumed: bool) -> Vec<String> {
        let mut remarks = Vec::new();
        if let Some(frame) = self.of(Role::Frame).filter(|frame| frame.index != time.index) {
            let [when, other] = [time, frame].map(|named| quoted(self.names[named.index]));
            let frames = Setting::Columns.to(format!("frame={other}"));
            remarks.push(format!("the times are those of the column {when}; {frames} takes the frames"));
        }
        let size = self.index(Role::Width).zip(self.index(Role::Height));
        if let Some(x) = self.index(Role::X).filter(|_| is_point && is_assumed && size.is_some()) {
            let x = quoted(self.names[x]);
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
            let z = quoted(z);
            let given = Setting::Columns.to(format!("y={z}"));
            remarks.push(format!("{z} is taken for the height; if y is, give {given}"));
        }
        if self.names.iter().any(|name| name.eq_ignore_ascii_case("trackLifetime")) {
            remarks
                .push("the classes of the tracks are in another file (tracksMeta): vehicles are read too".to_owned());
        }
        remarks
    }

    fn place(&self) -> Option<Place> {
        self.point().or_else(|| self.corner())
    }

    fn is_group(&self, index: usize) -> bool {
        is_one_of(GROUPS, &words(self.names[index]).concat())
    }

    fn index(&self, role: Role) -> Option<usize> {
        self.of(role).map(|named| named.index)
    }

    fn point(&self) -> Option<Place> {
        Some(Place::Point([self.index(Role::X)?, self.index(Role::Y)?]))
    }

    /// The foot of a box.
    fn corner(&self) -> Option<Place> {
        let (left, top) = (self.index(Role::Left)?, self.index(Role::Top)?);
        let size = self.index(Role::Width).zip(self.index(Role::Height));
        let other = self.index(Role::Right).zip(self.index(Role::Bottom));
        let foot = size.map(|(width, height)| Place::Foot([left, top, width, height]));
        foot.or(other.map(|(right, bottom)| Place::FootOfCorners([left, top, right, bottom])))
    }

    /// The column by which rows are kept, by its role or its name.
    fn kept(&self, name: &str) -> Option<usize> {
        let of_role = self.index(Role::Class).filter(|_| name == "class");
        of_role.or_else(|| (self.names.iter()).position(|column| is_called(self.names, column, name)))
    }

    /// Columns that are named and not there.
    fn not_there(&self, choice: &ColumnChoice) -> Vec<Fault> {
        let is_there = |name: &str| self.names.iter().any(|column| is_called(self.names, column, name));
        let chosen = choice.roles.iter().map(|(_, name)| name).filter(|name| !is_there(name));
        let keep = choice.keep.iter().map(|(name, _)| name);
        let kept = keep.filter(|name| self.kept(name).is_none());
        let fault = |name: &String| (None, format!("there is no column {:?}", quoted(name)));
        chosen.chain(kept).map(fault).collect()
    }

    /// Columns that say the same.
    fn repeated(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        for named in &self.found {
            let first = self.of(named.role).filter(|_| !named.role.may_repeat());
            if let Some(first) = first.filter(|first| first.index != named.index) {
                let [first, again] = [first, named].map(|named| quoted(self.names[named.index]));
                let fault = format!("the columns {first:?} and {again:?} both say the same");
                faults.push((Some(named.index), fault));
            }
        }
        if let (Some(Place::Point([x, _])), Some(corner)) = (self.point(), self.corner()) {
            let [x, corner] = [x, corner.columns()[0]].map(|index| quoted(self.names[index]));
            let of_box = Setting::Columns.to(format!("left={corner}"));
            let fault =
                format!("the columns {x:?} and {corner:?} both say where: {of_box} takes the box, x={x} the point");
            faults.push((None, fault));
        }
        if !faults.is_empty() {
            faults.truncate(MOST_FAULTS);
            let example = Setting::Columns.to("x=NAME,y=NAME, left=NAME,...");
            faults.push((None, format!("leave one of two out, or choose ({example})")));
        }
        faults
    }

    /// The column of a table of forecasts.
    fn other_rows(&self) -> Option<Fault> {
        let mut unknown = self.unknown.iter();
        let index = *unknown.find(|&&index| words(self.names[index]).concat() == "observeduntil")?;
        let detail = "this is a table of forecasts; give the tracks that they were made from";
        Some((Some(index), format!("column {:?}: {detail}", quoted(self.names[index]))))
    }

    /// Columns for each pedestrian, such as `x1,y1,x2,y2`, instead of rows.
    fn wide(&self) -> Option<String> {
        let of_axis = |axis: char| {
            let names = self.names.iter().map(|name| words(name).concat());
            let numbered = names.filter(|name| name.contains(|c: char| c.is_ascii_digit()));
            let letters = numbered.map(|name| name.replace(|c: char| c.is_ascii_digit(), ""));
            letters.filter(|name| name.starts_with(axis) || name.ends_with(axis)).count()
        };
        // Of two pedestrians the names may be those of a box.
        let is_wide = of_axis('x') > if self.place().is_some() { 2 } else { 1 };
        (is_wide && of_axis('x') == of_axis('y') && self.of(Role::Pedestrian).is_none()).then(|| {
            let detail = "each pedestrian has columns of its own; write a row for each frame and pedestrian: python -c \
                          \"import pandas; pandas.wide_to_long(pandas.read_csv('FILE'), ['x', 'y'], 'frame', \
                          'pedestrian').dropna().to_csv('rows.csv')\"";
            detail.to_owned()
        })
    }

    fn mixed_units(&self) -> Option<Fault> {
        let [x, y] = [self.of(Role::X)?, self.of(Role::Y)?];
        // `agent_px` beside `agent_py` is a coordinate, not a unit.
        let are_alike = match [x.length, y.length] {
            [Some(LengthUnit::Pixels), None] | [None, Some(LengthUnit::Pixels)] => true,
            lengths => {
                let [of_x, of_y] = lengths.map(|length| length.unwrap_or(LengthUnit::PerMetre(1.0)));
                of_x == of_y
            }
        };
        (!are_alike).then(|| {
            let [of_x, of_y] = [x, y].map(|named| quoted(self.names[named.index]));
            let unit = Setting::Unit;
            (Some(y.index), format!("the columns {of_x:?} and {of_y:?} have different units; {unit} sets one for both"))
        })
    }

    fn missing(&self) -> Option<Fault> {
        let has = |role: Role| self.of(role).is_some();
        let has_place = self.place().is_some();
        let roles = [
            ("frame", has(Role::Time) || has(Role::Frame)),
            ("pedestrian", has(Role::Pedestrian)),
            ("x", has_place || has(Role::X)),
            ("y", has_place || has(Role::Y)),
        ];
        let missing = roles.into_iter().filter(|(_, is_there)| !is_there);
        let missing: Vec<&str> = missing.map(|(name, _)| name).collect();
        let role = missing.first()?;
        let unknown = self.unknown.iter().map(|&index| quoted(self.names[index]));
        let unknown: Vec<String> = unknown.map(|name| format!("{name:?}")).collect();
        let mut rename = String::new();
        if !unknown.is_empty() {
            let (name, unknown) = (Setting::Columns.to(format!("{role}=NAME")), first_of(&unknown));
            rename = format!("; rename the column that holds it, or name it ({name}): unknown are {unknown}");
        }
        Some((self.unknown.first().copied(), format!("still missing: {}{rename}", missing.join(", "))))
    }
}

/// Whether this is the column that is asked for. Large and small letters count where a column has just that name.
fn is_called(names: &[&str], column: &str, asked: &str) -> bool {
    column == asked || column.eq_ignore_ascii_case(asked) && !names.contains(&asked)
}

/// Whether a column tells cameras apart, which a stream does by scenes.
pub(super) fn is_camera(name: &str) -> bool {
    is_one_of(CAMERAS, &words(name).concat())
}

/// The names, at most five of them.
pub(super) fn first_of(names: &[String]) -> String {
    match names.len() {
        0..=NAMED => names.join(", "),
        all => format!("{} and {} more", names[..NAMED].join(", "), all - NAMED),
    }
}
