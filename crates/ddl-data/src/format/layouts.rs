//! Known files without a header: what their columns hold. A new format is an entry here.

use crate::format::kind::Format;
use crate::format::position_columns::Place;

/// The columns of a file without a header.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) format: Format,
    /// The names of all columns, in order, with blanks between them. A row may end with separators.
    pub(super) names: &'static str,
    pub(super) frame: usize,
    pub(super) pedestrian: usize,
    pub(super) place: Place,
    /// Units of length per metre; `None` for pixels.
    pub(super) per_metre: Option<f64>,
    /// The column whose value stays the same in all rows.
    pub(super) constant: Option<usize>,
    /// The column that says of which class a row is, and the class of pedestrians.
    pub(super) class: Option<(usize, &'static str)>,
    /// A column of 0 or 1, and which rows are left out: those with 1 (true) or those with 0 (false).
    pub(super) mark: Option<(usize, bool)>,
    /// Frames a second of all files of the format.
    pub(super) rate: Option<f64>,
    /// What the reader should know.
    pub(super) note: Option<&'static str>,
}

const METRES: Option<f64> = Some(1.0);

const PLAIN: Layout = Layout {
    format: Format::SocialGan,
    names: "frame pedestrian x y",
    frame: 0,
    pedestrian: 1,
    place: Place::Point([2, 3]),
    per_metre: METRES,
    constant: None,
    class: None,
    mark: None,
    rate: None,
    note: None,
};

pub(super) static LAYOUTS: [Layout; 11] = [
    PLAIN,
    Layout {
        format: Format::IdFirst,
        names: "pedestrian frame x y",
        frame: 1,
        pedestrian: 0,
        note: Some("read as pedestrian, frame, x, y: the second column counts the frames"),
        ..PLAIN
    },
    Layout {
        format: Format::Obsmat,
        names: "frame pedestrian x z y v_x v_z v_y",
        place: Place::Point([2, 4]),
        constant: Some(3),
        note: Some("read as obsmat.txt: frame, pedestrian, x, z, y and velocities"),
        ..PLAIN
    },
    Layout {
        format: Format::PeTrack,
        names: "pedestrian frame x y z",
        frame: 1,
        pedestrian: 0,
        note: Some("read as pedestrian, frame, x, y, z in metres (PeTrack, JuPedSim)"),
        ..PLAIN
    },
    Layout {
        format: Format::PeTrackCm,
        names: "pedestrian frame x y z",
        frame: 1,
        pedestrian: 0,
        per_metre: Some(100.0),
        note: Some("read as pedestrian, frame, x, y, z in centimetres (PeTrack): z is at least 20 in all rows"),
        ..PLAIN
    },
    Layout {
        format: Format::Sdd,
        names: "pedestrian left top right bottom frame lost occluded generated class",
        frame: 5,
        pedestrian: 0,
        place: Place::Centre([1, 2, 3, 4]),
        per_metre: None,
        class: Some((9, "Pedestrian")),
        mark: Some((6, true)),
        rate: Some(30.0),
        note: Some(
            "read as annotations of the Stanford Drone Dataset, 30 frames a second: the centres of the boxes of \
             pedestrians, without rows marked lost",
        ),
        ..PLAIN
    },
    Layout {
        format: Format::Mot,
        names: "frame pedestrian left top width height confidence x y z",
        place: Place::Foot([2, 3, 4, 5]),
        per_metre: None,
        mark: Some((6, false)),
        note: Some("read as tracks of the MOT challenge: the middle of the lower edge of each box"),
        ..PLAIN
    },
    Layout {
        format: Format::MotTruth,
        names: "frame pedestrian left top width height considered class visibility",
        place: Place::Foot([2, 3, 4, 5]),
        per_metre: None,
        class: Some((7, "1")),
        mark: Some((6, false)),
        note: Some("read as ground truth of the MOT challenge: the middle of the lower edge of each box of class 1"),
        ..PLAIN
    },
    Layout {
        format: Format::Atc,
        names: "time pedestrian x y z speed direction facing",
        per_metre: Some(1000.0),
        note: Some("read as tracks of the ATC centre: seconds and millimetres"),
        ..PLAIN
    },
    Layout {
        format: Format::Kitti,
        names: "frame pedestrian class truncated occluded alpha left top right bottom \
                height width length x down y rotation",
        place: Place::Point([13, 15]),
        class: Some((2, "Pedestrian")),
        rate: Some(10.0),
        note: Some(
            "read as tracking labels of KITTI, 10 frames a second: pedestrians on the ground, relative to the camera; \
             where it moves, forecasts are wrong",
        ),
        ..PLAIN
    },
    Layout {
        format: Format::ApolloScape,
        names: "frame pedestrian class x y z length width height heading",
        place: Place::Point([3, 4]),
        class: Some((2, "3")),
        rate: Some(2.0),
        note: Some("read as trajectories of ApolloScape, 2 frames a second: rows of class 3, pedestrians"),
        ..PLAIN
    },
];

impl Layout {
    /// The columns of a format; `None` if its files have other shapes.
    pub(super) fn of(format: Format) -> Option<&'static Self> {
        LAYOUTS.iter().find(|layout| layout.format == format)
    }
}
