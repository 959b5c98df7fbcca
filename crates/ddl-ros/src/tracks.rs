//! Observed pedestrians, from the three messages in which trackers publish them.

use crate::cdr::{Message, read};
use crate::error::RosError;
use crate::msg::{Detection3DArray, Header, People, Point, TrackedPersons};
use ddl_core::{COORDINATE_LIMIT, Numbering, PedestrianId, PedestrianName, PedestrianNames, Position};
use std::collections::BTreeMap;

/// The pedestrians of one message.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// The moment, and the frame of the positions.
    pub header: Header,
    /// In the order of the message.
    pub pedestrians: Vec<SeenPedestrian>,
    /// Why rows are left out, and how many.
    pub left_out: BTreeMap<&'static str, usize>,
}

impl Observed {
    /// The pedestrians of a message without those that cannot be used, which are counted.
    pub fn new(header: Header, pedestrians: Vec<SeenPedestrian>) -> Self {
        let (frame, left_out) = (header.frame_id.clone(), BTreeMap::new());
        let mut observed = Self { header, pedestrians, left_out };
        observed.keep("occluded", |seen| !seen.is_occluded);
        let is_alike = |seen: &SeenPedestrian| seen.frame_id.is_empty() || seen.frame_id == frame;
        observed.keep("in another frame", is_alike);
        observed.keep_finite();
        observed
    }

    /// Leaves out rows whose x or y is not finite, or beyond [`COORDINATE_LIMIT`].
    pub fn keep_finite(&mut self) {
        let is_near = |coordinate: f64| coordinate.abs() <= COORDINATE_LIMIT;
        self.keep("x or y is not finite, or beyond 10,000 km", |seen| {
            is_near(seen.position.x) && is_near(seen.position.y)
        });
    }

    /// Leaves out the other rows, and counts them under this reason.
    pub fn keep(&mut self, reason: &'static str, is_kept: impl Fn(&SeenPedestrian) -> bool) {
        let left_out = self.pedestrians.extract_if(.., |seen| !is_kept(seen)).count();
        if left_out > 0 {
            *self.left_out.entry(reason).or_default() += left_out;
        }
    }

    /// Numbers and places (m) of the pedestrians, and the names of those that are not named by a number.
    pub fn numbered(&self, numbering: &mut Numbering) -> (Vec<(PedestrianId, Position)>, PedestrianNames) {
        let mut words = BTreeMap::new();
        let seen = self.pedestrians.iter().map(|SeenPedestrian { name, position, .. }| {
            let id = match PedestrianName::of_text(name) {
                PedestrianName::Number(number) => PedestrianId(number),
                PedestrianName::Word(_) => {
                    let (id, word) = numbering.number(name);
                    words.insert(id, word);
                    id
                }
            };
            (id, [position.x, position.y])
        });
        (seen.collect(), PedestrianNames::new(words))
    }
}

/// One pedestrian of a message.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeenPedestrian {
    /// Its id or name; never empty.
    pub name: String,
    /// The likeliest class; empty if the message has none.
    pub class: String,
    /// Position (m) in the frame of the header.
    pub position: Point,
    /// The frame in a header of its own; mostly empty.
    pub frame_id: String,
    /// Whether the tracker only guessed where it is.
    pub is_occluded: bool,
}

/// A message with tracks.
pub trait Tracks: Message {
    /// Its pedestrians.
    ///
    /// # Errors
    /// The header has no time, a pedestrian has no id.
    fn observed(self) -> Result<Observed, RosError>;
}

/// Reads the pedestrians of a message of a type such as `people_msgs/msg/People`.
///
/// # Errors
/// The type is none of tracks; as [`read`]; as [`Tracks::observed`].
pub fn read_tracks(type_name: &str, cdr: &[u8]) -> Result<Observed, RosError> {
    match type_name {
        Detection3DArray::TYPE => read::<Detection3DArray>(cdr)?.observed(),
        People::TYPE => read::<People>(cdr)?.observed(),
        TrackedPersons::TYPE => read::<TrackedPersons>(cdr)?.observed(),
        _ => Err(RosError::UnknownType {
            type_name: type_name.to_owned(),
            known: [Detection3DArray::TYPE, People::TYPE, TrackedPersons::TYPE].join(", "),
        }),
    }
}

impl Tracks for Detection3DArray {
    fn observed(self) -> Result<Observed, RosError> {
        let detections = self.detections.into_iter();
        let seen = detections.map(|detection| {
            let results = detection.results.into_iter().map(|result| result.hypothesis);
            let likeliest = results.max_by(|a, b| a.score.total_cmp(&b.score));
            SeenPedestrian {
                name: detection.id,
                class: likeliest.map(|hypothesis| hypothesis.class_id).unwrap_or_default(),
                position: detection.bbox.center.position,
                frame_id: detection.header.frame_id,
                is_occluded: false,
            }
        });
        checked::<Self>(self.header, seen.collect(), ["detections", "id"])
    }
}

impl Tracks for People {
    fn observed(self) -> Result<Observed, RosError> {
        let seen = self.people.into_iter().map(|person| SeenPedestrian {
            name: person.name,
            position: person.position,
            ..SeenPedestrian::default()
        });
        checked::<Self>(self.header, seen.collect(), ["people", "name"])
    }
}

impl Tracks for TrackedPersons {
    fn observed(self) -> Result<Observed, RosError> {
        let seen = self.tracks.into_iter().map(|track| SeenPedestrian {
            name: track.track_id.to_string(),
            position: track.pose.pose.position,
            is_occluded: track.is_occluded,
            ..SeenPedestrian::default()
        });
        checked::<Self>(self.header, seen.collect(), ["tracks", "track_id"])
    }
}

fn checked<M: Message>(
    header: Header,
    pedestrians: Vec<SeenPedestrian>,
    [field, id]: [&'static str; 2],
) -> Result<Observed, RosError> {
    let type_name = M::TYPE;
    if header.stamp.microseconds() == 0 {
        return Err(RosError::NoTime { type_name });
    }
    if let Some(index) = pedestrians.iter().position(|seen| seen.name.is_empty()) {
        return Err(RosError::NoId { type_name, field, index, id });
    }
    Ok(Observed::new(header, pedestrians))
}
