//! The messages, with the fields of their [definitions](crate::definition) in their order.

#![expect(missing_docs, reason = "the definitions describe the fields")]

use crate::cdr::Message;
use ddl_core::Position;
use serde::{Deserialize, Serialize};

macro_rules! messages {
    ($($name:ident { $($field:ident: $kind:ty),* $(,)? })*) => {$(
        #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
        pub struct $name { $(pub $field: $kind),* }
    )*};
}

macro_rules! types {
    ($($name:ident = $text:literal)*) => {$(
        impl Message for $name { const TYPE: &'static str = $text; }
    )*};
}

/// A square matrix of six rows. (`serde` has no arrays of 36 numbers.)
pub type Covariance = [[f64; 6]; 6];

messages! {
    Header { stamp: Time, frame_id: String }
    Color { r: f32, g: f32, b: f32, a: f32 }
    Pose { position: Point, orientation: Quaternion }
    PoseStamped { header: Header, pose: Pose }
    PoseWithCovariance { pose: Pose, covariance: Covariance }
    Twist { linear: Point, angular: Point }
    TwistWithCovariance { twist: Twist, covariance: Covariance }
    Transform { translation: Point, rotation: Quaternion }
    TransformStamped { header: Header, child_frame_id: String, transform: Transform }
    TfMessage { transforms: Vec<TransformStamped> }

    ObjectHypothesis { class_id: String, score: f64 }
    ObjectHypothesisWithPose { hypothesis: ObjectHypothesis, pose: PoseWithCovariance }
    BoundingBox3D { center: Pose, size: Point }
    Detection3D { header: Header, results: Vec<ObjectHypothesisWithPose>, bbox: BoundingBox3D, id: String }
    Detection3DArray { header: Header, detections: Vec<Detection3D> }

    Person {
        name: String,
        position: Point,
        velocity: Point,
        reliability: f64,
        tagnames: Vec<String>,
        tags: Vec<String>,
    }
    People { header: Header, people: Vec<Person> }

    TrackedPerson {
        track_id: u64,
        is_occluded: bool,
        is_matched: bool,
        detection_id: u64,
        age: Duration,
        pose: PoseWithCovariance,
        twist: TwistWithCovariance,
    }
    TrackedPersons { header: Header, tracks: Vec<TrackedPerson> }

    Path { header: Header, poses: Vec<PoseStamped> }
    MapMetaData { map_load_time: Time, resolution: f32, width: u32, height: u32, origin: Pose }
    OccupancyGrid { header: Header, info: MapMetaData, data: Vec<i8> }

    CompressedImage { header: Header, format: String, data: Vec<u8> }
    UvCoordinate { u: f32, v: f32 }
    MeshFile { filename: String, data: Vec<u8> }
    Marker {
        header: Header,
        ns: String,
        id: i32,
        r#type: i32,
        action: i32,
        pose: Pose,
        scale: Point,
        color: Color,
        lifetime: Duration,
        frame_locked: bool,
        points: Vec<Point>,
        colors: Vec<Color>,
        texture_resource: String,
        texture: CompressedImage,
        uv_coordinates: Vec<UvCoordinate>,
        text: String,
        mesh_resource: String,
        mesh_file: MeshFile,
        mesh_use_embedded_materials: bool,
    }
    MarkerArray { markers: Vec<Marker> }

    KeyValue { key: String, value: String }
    DiagnosticStatus { level: u8, name: String, message: String, hardware_id: String, values: Vec<KeyValue> }
    DiagnosticArray { header: Header, status: Vec<DiagnosticStatus> }

    Hypothesis { weight: f64, certified: bool, goal: Point, x: Vec<f64>, y: Vec<f64> }
    PedestrianForecast {
        id: String,
        position: Point,
        age: f64,
        familiarity: f64,
        scales: Vec<f64>,
        hypotheses: Vec<Hypothesis>,
    }
    Forecasts { header: Header, time_step: f64, joint: bool, pedestrians: Vec<PedestrianForecast> }
}

types! {
    Detection3DArray = "vision_msgs/msg/Detection3DArray"
    People = "people_msgs/msg/People"
    TrackedPersons = "spencer_tracking_msgs/msg/TrackedPersons"
    TfMessage = "tf2_msgs/msg/TFMessage"
    Path = "nav_msgs/msg/Path"
    OccupancyGrid = "nav_msgs/msg/OccupancyGrid"
    MarkerArray = "visualization_msgs/msg/MarkerArray"
    DiagnosticArray = "diagnostic_msgs/msg/DiagnosticArray"
    Forecasts = "ddl_msgs/msg/Forecasts"
}

/// A moment, since 1970 or since the simulation began.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

impl Time {
    /// Whole microseconds.
    pub fn microseconds(self) -> i64 {
        i64::from(self.sec) * 1_000_000 + i64::from(self.nanosec / 1000)
    }

    /// The moment of so many microseconds; seconds beyond 32 bits are cut off, as ROS 2 has no room for them.
    #[must_use]
    pub fn of_microseconds(microseconds: i64) -> Self {
        Self {
            sec: microseconds.div_euclid(1_000_000) as i32,
            nanosec: microseconds.rem_euclid(1_000_000) as u32 * 1000,
        }
    }

    /// The moment so many seconds later, to the microsecond.
    #[must_use]
    pub fn after(self, seconds: f64) -> Self {
        Self::of_microseconds(self.microseconds() + (1e6 * seconds).round() as i64)
    }
}

/// A length of time, with the same fields.
pub type Duration = Time;

/// `geometry_msgs/Point`, and `geometry_msgs/Vector3`, which has the same fields (m).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

impl From<Position> for Point {
    fn from([x, y]: Position) -> Self {
        Self { x, y, z: 0.0 }
    }
}

/// A rotation; by default none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

impl Default for Quaternion {
    fn default() -> Self {
        let [x, y, z, w] = [0.0, 0.0, 0.0, 1.0];
        Self { x, y, z, w }
    }
}
