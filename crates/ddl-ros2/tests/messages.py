"""Messages of ROS 2 for an independent DDS: fields written by hand, with the names that ROS 2 gives the types."""

from cyclonedds.idl import make_idl_struct
from cyclonedds.idl import types as idl
from cyclonedds.idl.annotations import final

KINDS = {name: getattr(idl, name) for name in "byte float32 float64 int8 int32 uint32 uint64".split()}
KINDS |= {"string": str, "bool": bool, "covariance": idl.array[idl.float64, 36]}

TEXT = """
builtin_interfaces/Time: int32 sec, uint32 nanosec
builtin_interfaces/Duration: int32 sec, uint32 nanosec
std_msgs/Header: Time stamp, string frame_id
std_msgs/ColorRGBA: float32 r, float32 g, float32 b, float32 a
geometry_msgs/Point: float64 x, float64 y, float64 z
geometry_msgs/Vector3: float64 x, float64 y, float64 z
geometry_msgs/Quaternion: float64 x, float64 y, float64 z, float64 w
geometry_msgs/Pose: Point position, Quaternion orientation
geometry_msgs/PoseStamped: Header header, Pose pose
geometry_msgs/PoseWithCovariance: Pose pose, covariance covariance
geometry_msgs/Twist: Vector3 linear, Vector3 angular
geometry_msgs/TwistWithCovariance: Twist twist, covariance covariance
geometry_msgs/Transform: Vector3 translation, Quaternion rotation
geometry_msgs/TransformStamped: Header header, string child_frame_id, Transform transform
tf2_msgs/TFMessage: TransformStamped[] transforms
vision_msgs/ObjectHypothesis: string class_id, float64 score
vision_msgs/ObjectHypothesisWithPose: ObjectHypothesis hypothesis, PoseWithCovariance pose
vision_msgs/BoundingBox3D: Pose center, Vector3 size
vision_msgs/Detection3D: Header header, ObjectHypothesisWithPose[] results, BoundingBox3D bbox, string id
vision_msgs/Detection3DArray: Header header, Detection3D[] detections
people_msgs/Person: string name, Point position, Point velocity, float64 reliability, string[] tagnames, string[] tags
people_msgs/People: Header header, Person[] people
spencer_tracking_msgs/TrackedPerson: uint64 track_id, bool is_occluded, bool is_matched, uint64 detection_id, \
Duration age, PoseWithCovariance pose, TwistWithCovariance twist
spencer_tracking_msgs/TrackedPersons: Header header, TrackedPerson[] tracks
nav_msgs/Path: Header header, PoseStamped[] poses
nav_msgs/MapMetaData: Time map_load_time, float32 resolution, uint32 width, uint32 height, Pose origin
nav_msgs/OccupancyGrid: Header header, MapMetaData info, int8[] data
sensor_msgs/CompressedImage: Header header, string format, byte[] data
visualization_msgs/UVCoordinate: float32 u, float32 v
visualization_msgs/MeshFile: string filename, byte[] data
visualization_msgs/Marker: Header header, string ns, int32 id, int32 type, int32 action, Pose pose, Vector3 scale, \
ColorRGBA color, Duration lifetime, bool frame_locked, Point[] points, ColorRGBA[] colors, string texture_resource, \
CompressedImage texture, UVCoordinate[] uv_coordinates, string text, string mesh_resource, MeshFile mesh_file, \
bool mesh_use_embedded_materials
visualization_msgs/MarkerArray: Marker[] markers
diagnostic_msgs/KeyValue: string key, string value
diagnostic_msgs/DiagnosticStatus: byte level, string name, string message, string hardware_id, KeyValue[] values
diagnostic_msgs/DiagnosticArray: Header header, DiagnosticStatus[] status
ddl_msgs/Hypothesis: float64 weight, bool certified, Point goal, float64[] x, float64[] y
ddl_msgs/PedestrianForecast: string id, Point position, float64 age, float64 familiarity, float64[] scales, \
Hypothesis[] hypotheses
ddl_msgs/Forecasts: Header header, float64 time_step, bool joint, PedestrianForecast[] pedestrians
"""


def message(line):
    """The type of a line `package/Name: kind field, kind field`."""
    name, fields = line.split(": ")
    package, short = name.split("/")

    def kind(text):
        element = KINDS[text.removesuffix("[]")]
        return idl.sequence[element] if text.endswith("[]") else element

    fields = [field.split(" ") for field in fields.split(", ")]
    types = {name: kind(text) for text, name in fields}
    return final(make_idl_struct(short, f"{package}::msg::dds_::{short}_", types))


for line in TEXT.strip().splitlines():
    made = message(line)
    KINDS[made.__name__] = globals()[made.__name__] = made
