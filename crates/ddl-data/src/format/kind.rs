//! The supported formats.

/// Format of a file of tracks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Four lines of comma-separated numbers, one field per observation: frame, pedestrian, **y**, **x** (m). The files
    /// of the `star` convention.
    StarCsv,
    /// One observation per line, four fields separated by tabs or blanks: frame, pedestrian, x, y (m).
    /// The files of the `social-gan` convention, and those of TrajNet, in which rows with `?` are to be forecast.
    SocialGan,
    /// A table whose header names frame (or time), pedestrian, x and y in any order, by their usual names, with any
    /// further columns. Commas, semicolons, tabs or blanks stand between the fields; lines that begin with `#` are
    /// comments. Without x and y, the columns of a box (left, top, and width, height or right, bottom) give the middle
    /// of its lower edge.
    Table,
    /// The newline-delimited JSON of TrajNet++, with one `{"track": {"f", "p", "x", "y"}}` per line (frame, pedestrian,
    /// metres). Lines of forecasts (with `prediction_number`), of scenes and of other kinds are skipped.
    TrajNet,
    /// The `obsmat.txt` of the ETH recordings: frame, pedestrian, x, z, **y** (m) and three velocities, separated by
    /// blanks. z stays the same.
    Obsmat,
    /// Pedestrian, frame, x, y (m).
    IdFirst,
    /// `PeTrack` and `JuPedSim` without a header: pedestrian, frame, x, y, z (m).
    PeTrack,
    /// The same in centimetres.
    PeTrackCm,
    /// `annotations.txt` of the Stanford Drone Dataset: pedestrian, box, frame, lost, occluded, generated, class.
    Sdd,
    /// Tracks of the MOT challenge: frame, pedestrian, left, top, width, height and four more (pixels).
    Mot,
    /// The ground truth of the MOT challenge, with nine columns.
    MotTruth,
    /// Tracks of the ATC shopping centre: time (s), pedestrian, x, y, z (mm), speed and two angles.
    Atc,
    /// Tracking labels of KITTI, with 17 columns or more.
    Kitti,
    /// Trajectories of `ApolloScape`: frame, object, class, x, y, z (m), sizes, heading.
    ApolloScape,
    /// The `.vsp` annotations of UCY: splines with control points of x, y (pixels from the middle), frame and gaze.
    Vsp,
    /// Tracks of the Edinburgh forum: `TRACK.R1=[[x y frame];...];`, in pixels of 24.7 mm.
    Edinburgh,
}

ddl_core::named!(
    Format, "format",
    StarCsv => "star-csv", SocialGan => "social-gan", Table => "table", TrajNet => "trajnet", Obsmat => "obsmat",
    IdFirst => "id-first", PeTrack => "petrack", PeTrackCm => "petrack-cm", Sdd => "sdd", Mot => "mot",
    MotTruth => "mot-truth", Atc => "atc", Kitti => "kitti", ApolloScape => "apolloscape", Vsp => "vsp",
    Edinburgh => "edinburgh"
);

impl Format {
    /// Every format that is also written.
    pub const WRITTEN: [Self; 5] = [Self::StarCsv, Self::SocialGan, Self::Table, Self::TrajNet, Self::Obsmat];
}
