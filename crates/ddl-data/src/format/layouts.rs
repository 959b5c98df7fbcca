//! Known files without a header: what their columns hold. A new format is an entry here.

use crate::format::kind::Format;
use crate::format::position_columns::PositionColumns;

/// The columns of a file without a header.
#[derive(Debug)]
pub(super) struct FileLayout {
    pub(super) format: Format,
    /// The names of all columns, in order, with blanks between them. A row may end with separators.
    pub(super) names: &'static str,
    pub(super) frame: usize,
    pub(super) pedestrian: usize,
    pub(super) position: PositionColumns,
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

const PLAIN: FileLayout = FileLayout {
    format: Format::SocialGan,
    names: "frame pedestrian x y",
    frame: 0,
    pedestrian: 1,
    position: PositionColumns::Point([2, 3]),
    per_metre: METRES,
    constant: None,
    class: None,
    mark: None,
    rate: None,
    note: None,
};

pub(super) static LAYOUTS: [FileLayout; 11] = [
    PLAIN,
    FileLayout {
        format: Format::IdFirst,
        names: "pedestrian frame x y",
        frame: 1,
        pedestrian: 0,
        note: Some("read as pedestrian, frame, x, y: the second column counts the frames"),
        ..PLAIN
    },
    FileLayout {
        format: Format::Obsmat,
        names: "frame pedestrian x z y v_x v_z v_y",
        position: PositionColumns::Point([2, 4]),
        constant: Some(3),
        note: Some("read as obsmat.txt: frame, pedestrian, x, z, y and velocities"),
        ..PLAIN
    },
    FileLayout {
        format: Format::PeTrack,
        names: "pedestrian frame x y z",
        frame: 1,
        pedestrian: 0,
        note: Some("read as pedestrian, frame, x, y, z in metres (PeTrack, JuPedSim)"),
        ..PLAIN
    },
    FileLayout {
        format: Format::PeTrackCm,
        names: "pedestrian frame x y z",
        frame: 1,
        pedestrian: 0,
        per_metre: Some(100.0),
        note: Some("read as pedestrian, frame, x, y, z in centimetres (PeTrack): z is at least 20 in all rows"),
        ..PLAIN
    },
    FileLayout {
        format: Format::Sdd,
        names: "pedestrian left top right bottom frame lost occluded generated class",
        frame: 5,
        pedestrian: 0,
        position: PositionColumns::Centre([1, 2, 3, 4]),
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
    FileLayout {
        format: Format::Mot,
        names: "frame pedestrian left top width height confidence x y z",
        position: PositionColumns::Foot([2, 3, 4, 5]),
        per_metre: None,
        mark: Some((6, false)),
        note: Some("read as tracks of the MOT challenge: the middle of the lower edge of each box"),
        ..PLAIN
    },
    FileLayout {
        format: Format::MotTruth,
        names: "frame pedestrian left top width height considered class visibility",
        position: PositionColumns::Foot([2, 3, 4, 5]),
        per_metre: None,
        class: Some((7, "1")),
        mark: Some((6, false)),
        note: Some("read as ground truth of the MOT challenge: the middle of the lower edge of each box of class 1"),
        ..PLAIN
    },
    FileLayout {
        format: Format::Atc,
        names: "time pedestrian x y z speed direction facing",
        per_metre: Some(1000.0),
        note: Some("read as tracks of the ATC centre: seconds and millimetres"),
        ..PLAIN
    },
    FileLayout {
        format: Format::Kitti,
        names: "frame pedestrian class truncated occluded alpha left top right bottom \
                height width length x down y rotation",
        position: PositionColumns::Point([13, 15]),
        class: Some((2, "Pedestrian")),
        rate: Some(10.0),
        note: Some(
            "read as tracking labels of KITTI, 10 frames a second: pedestrians on the ground, relative to the camera; \
             where it moves, forecasts are wrong",
        ),
        ..PLAIN
    },
    FileLayout {
        format: Format::ApolloScape,
        names: "frame pedestrian class x y z length width height heading",
        position: PositionColumns::Point([3, 4]),
        class: Some((2, "3")),
        rate: Some(2.0),
        note: Some("read as trajectories of ApolloScape, 2 frames a second: rows of class 3, pedestrians"),
        ..PLAIN
    },
];

impl FileLayout {
    /// The columns of a format; `None` if its files have other shapes.
    pub(super) fn of(format: Format) -> Option<&'static Self> {
        LAYOUTS.iter().find(|layout| layout.format == format)
    }
}
