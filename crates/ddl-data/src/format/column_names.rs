//! What the names of columns say: their role and their unit.

use crate::class::{is_one_of, name_words};
use crate::clock::TimeUnit;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    Frame,
    Time,
    Pedestrian,
    X,
    Y,
    Scene,
    /// 1 where the position is not seen.
    Lost,
    /// 0 where it is not seen.
    Valid,
    /// From here on columns may be there and not be read.
    Class,
    Left,
    Top,
    Right,
    Bottom,
    Width,
    Height,
}

/// The roles with their names, in small letters without blanks and signs. Users choose a role by the first one.
const NAMES: [(Role, &str); 15] = [
    (Role::Frame, "frame bild frames frameid frameidx frameindex framenumber frameno framenum framenr fr"),
    (Role::Time, "time zeit t ts timestamp stamp headerstamp seconds milliseconds microseconds nanoseconds datetime"),
    (
        Role::Pedestrian,
        "pedestrian pedestrianid ped pedid persid id agent agentid track trackid trackerid tid person personid \
         object objectid obj objid identity subject participant",
    ),
    (
        Role::X,
        "x posx posex posepositionx poseposepositionx xpos positionx xposition centerx xcenter centrex xcentre \
         worldx xworld px xest coordx xcoord locx xloc easting",
    ),
    (
        Role::Y,
        "y posy posey posepositiony poseposepositiony ypos positiony yposition centery ycenter centrey ycentre \
         worldy yworld py yest coordy ycoord locy yloc northing",
    ),
    (
        Role::Class,
        "class classname classid classlabel cls label type agenttype agentclass actortype objecttype objectclass \
         objectcategory objtype detclass trackclass vehicletype roadusertype category categoryname",
    ),
    (Role::Scene, "scene"),
    (Role::Lost, "lost"),
    (Role::Valid, "valid isvalid"),
    (Role::Left, "left xmin x1 bbleft bboxleft"),
    (Role::Top, "top ymin y1 bbtop bboxtop"),
    (Role::Right, "right xmax x2 bbright bboxright"),
    (Role::Bottom, "bottom ymax y2 bbbottom bboxbottom"),
    (Role::Width, "width w bbwidth bboxwidth"),
    (Role::Height, "height h bbheight bboxheight"),
];

/// The last word of a name, if it is a unit.
const TIME_UNITS: [(&str, TimeUnit); 4] = [
    ("s sec seconds", TimeUnit::Seconds),
    ("ms milliseconds", TimeUnit::Milliseconds),
    ("us microseconds", TimeUnit::Microseconds),
    ("ns nanoseconds", TimeUnit::Nanoseconds),
];
/// Parts of a second: their names, and how many make one.
const RESTS: [(&str, (&str, i64)); 3] = [
    ("nanosec nanosecs nsec nsecs", ("nanoseconds", 1_000_000_000)),
    ("microsec microsecs usec usecs", ("microseconds", 1_000_000)),
    ("millisec millisecs msec msecs", ("milliseconds", 1_000)),
];
const LENGTH_UNITS: [(&str, LengthUnit); 7] = [
    ("m metre metres meter meters", LengthUnit::PerMetre(1.0)),
    ("cm centimetres centimeters", LengthUnit::PerMetre(100.0)),
    ("mm millimetres millimeters", LengthUnit::PerMetre(1000.0)),
    ("km kilometres kilometers", LengthUnit::PerMetre(0.001)),
    ("ft feet foot", LengthUnit::PerMetre(3.280_839_895_013_123)),
    ("in inches inch", LengthUnit::PerMetre(39.370_078_740_157_48)),
    ("px pix pixel pixels", LengthUnit::Pixels),
];

/// A unit of length that a name gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LengthUnit {
    PerMetre(f64),
    Pixels,
}

/// A column of a part of a second, its unit, and how many make one.
pub(super) type Rest = (usize, &'static str, i64);

/// A column of a header.
pub(super) struct NamedColumn {
    pub(super) index: usize,
    pub(super) role: Role,
    pub(super) time_unit: Option<TimeUnit>,
    pub(super) length: Option<LengthUnit>,
}

impl LengthUnit {
    /// The name of the unit of which so many make a metre; `None` for metres.
    pub(super) fn name_of(per_metre: f64) -> Option<&'static str> {
        let others = &LENGTH_UNITS[1..];
        let (names, _) = others.iter().find(|(_, unit)| *unit == Self::PerMetre(per_metre))?;
        names.split(' ').nth(1)
    }

    /// Units per metre; `None` for pixels.
    pub(super) fn per_metre(self) -> Option<f64> {
        match self {
            Self::PerMetre(count) => Some(count),
            Self::Pixels => None,
        }
    }
}

impl Role {
    /// Whether several columns may have the role; one of them is read.
    pub(super) fn may_repeat(self) -> bool {
        matches!(self, Self::Class | Self::Valid)
    }

    /// Whether a column of this role takes the place of one of the other.
    pub(super) fn stands_for(self, other: Self) -> bool {
        let is_time = |role: Self| matches!(role, Self::Frame | Self::Time);
        let is_point = |role: Self| matches!(role, Self::X | Self::Y);
        let is_corner = |role: Self| matches!(role, Self::Left | Self::Top);
        let both = |is: &dyn Fn(Self) -> bool, of: &dyn Fn(Self) -> bool| is(self) && of(other);
        self == other || both(&is_time, &is_time) || both(&is_point, &is_corner) || both(&is_corner, &is_point)
    }
}

/// The roles that can be given, each with its name.
pub(super) fn role_names() -> impl Iterator<Item = (Role, &'static str)> {
    let first = |names: &'static str| names.split_once(' ').map_or(names, |(first, _)| first);
    NAMES.iter().map(move |(role, names)| (*role, first(names)))
}

fn unit_of<T: Copy>(units: &[(&str, T)], name: &str) -> Option<T> {
    units.iter().find(|(names, _)| is_one_of(names, name)).map(|(_, unit)| *unit)
}

/// The unit of a role such as `time_ms`.
pub(super) fn unit_of_role(role: &str) -> Option<TimeUnit> {
    unit_of(&TIME_UNITS, role.strip_prefix("time_")?)
}

/// The inverse of [`unit_of_role`]; `None` for dates.
pub(super) fn role_of_unit(unit: TimeUnit) -> Option<String> {
    let (names, _) = TIME_UNITS.iter().find(|(_, other)| *other == unit)?;
    Some(format!("time_{}", names.split(' ').next()?))
}

/// The column of that name with a role that the user gives. The last word of its name may be a unit.
pub(super) fn chosen_as(role: Role, index: usize, name: &str) -> NamedColumn {
    let words = name_words(name);
    let last = words.last().map_or("", String::as_str);
    let of_time = [words.concat().as_str(), last].iter().find_map(|unit| unit_of(&TIME_UNITS, unit));
    NamedColumn {
        index,
        role,
        time_unit: of_time.filter(|_| role == Role::Time),
        // A column called `px` is a coordinate; only a further word, as in `x_px`, is a unit. `x_in` may be where
        // somebody enters; only `x [in]` is in inches.
        length: unit_of(&LENGTH_UNITS, last).filter(|_| {
            let is_unit = last != "in" || name.ends_with([']', ')']);
            is_unit && matches!(role, Role::X | Role::Y) && words.len() > 1
        }),
    }
}

/// Whether a column of that name is known.
pub(super) fn is_known(name: &str) -> bool {
    named(0, name).is_some()
}

/// The column of that name; `None` for an unknown one.
pub(super) fn named(index: usize, name: &str) -> Option<NamedColumn> {
    let mut words = name_words(name);
    // `rostopic echo -p` writes the fields of a message as `field.pose.position.x`.
    if words.first().is_some_and(|word| word == "field") {
        words.remove(0);
    }
    let role = |words: &[String]| {
        let plain = words.concat();
        let mut names = NAMES.iter();
        let (role, _) = names.find(|(_, names)| is_one_of(names, &plain))?;
        Some(*role)
    };
    let whole = role(&words);
    let named = chosen_as(whole.or_else(|| role(words.split_last()?.1))?, index, name);
    // A word beside the name of a role is its unit.
    (whole.is_some() || named.time_unit.is_some() || named.length.is_some()).then_some(named)
}

/// The column of a part of a second beside this one of whole seconds, as in stamps of ROS: its first words are the
/// same. The words of the names are written together.
pub(super) fn rest_beside(names: &[String], seconds: usize) -> Option<Rest> {
    let stem = names[seconds].strip_suffix("secs").or(names[seconds].strip_suffix("sec"))?;
    names.iter().enumerate().find_map(|(index, name)| {
        let (unit, a_second) = unit_of(&RESTS, name.strip_prefix(stem)?)?;
        Some((index, unit, a_second))
    })
}

/// Whether these are 0, 1, 2, ..., as in the first line of a table whose columns have no names.
pub(super) fn count_columns<'a>(names: impl Iterator<Item = &'a str>) -> bool {
    let names: Vec<&str> = names.skip_while(|name| name.is_empty()).collect();
    names.len() > 2 && names.iter().enumerate().all(|(index, name)| *name == index.to_string())
}

/// Whether the last word of a name is a unit of time.
pub(super) fn is_of_time(name: &str) -> bool {
    name_words(name).last().is_some_and(|unit| unit_of(&TIME_UNITS, unit).is_some() || unit_of(&RESTS, unit).is_some())
}
