"""Messages of ROS 2 for an independent DDS: fields written by hand, with the names that ROS 2 gives the types."""

from cyclonedds.idl import make_idl_struct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import array, byte, float32, float64, int8, int32, sequence, uint32, uint64


def message(name, /, **fields):
    package, short = name.split("/")
    return final(make_idl_struct(short, f"{package}::msg::dds_::{short}_", fields))


Time = message("builtin_interfaces/Time", sec=int32, nanosec=uint32)
Duration = message("builtin_interfaces/Duration", sec=int32, nanosec=uint32)
Header = message("std_msgs/Header", stamp=Time, frame_id=str)
Color = message("std_msgs/ColorRGBA", r=float32, g=float32, b=float32, a=float32)
Point = message("geometry_msgs/Point", x=float64, y=float64, z=float64)
Vector = message("geometry_msgs/Vector3", x=float64, y=float64, z=float64)
Quaternion = message("geometry_msgs/Quaternion", x=float64, y=float64, z=float64, w=float64)
Pose = message("geometry_msgs/Pose", position=Point, orientation=Quaternion)
PoseStamped = message("geometry_msgs/PoseStamped", header=Header, pose=Pose)
UncertainPose = message("geometry_msgs/PoseWithCovariance", pose=Pose, covariance=array[float64, 36])
Twist = message("geometry_msgs/Twist", linear=Vector, angular=Vector)
UncertainTwist = message("geometry_msgs/TwistWithCovariance", twist=Twist, covariance=array[float64, 36])
Transform = message("geometry_msgs/Transform", translation=Vector, rotation=Quaternion)
TransformStamped = message(
    "geometry_msgs/TransformStamped", header=Header, child_frame_id=str, transform=Transform
)
TFMessage = message("tf2_msgs/TFMessage", transforms=sequence[TransformStamped])

Guess = message("vision_msgs/ObjectHypothesis", class_id=str, score=float64)
PlacedGuess = message("vision_msgs/ObjectHypothesisWithPose", hypothesis=Guess, pose=UncertainPose)
Box = message("vision_msgs/BoundingBox3D", center=Pose, size=Vector)
Detection = message(
    "vision_msgs/Detection3D", header=Header, results=sequence[PlacedGuess], bbox=Box, id=str
)
Detections = message("vision_msgs/Detection3DArray", header=Header, detections=sequence[Detection])
Person = message(
    "people_msgs/Person",
    name=str,
    position=Point,
    velocity=Point,
    reliability=float64,
    tagnames=sequence[str],
    tags=sequence[str],
)
People = message("people_msgs/People", header=Header, people=sequence[Person])
TrackedPerson = message(
    "spencer_tracking_msgs/TrackedPerson",
    track_id=uint64,
    is_occluded=bool,
    is_matched=bool,
    detection_id=uint64,
    age=Duration,
    pose=UncertainPose,
    twist=UncertainTwist,
)
TrackedPersons = message("spencer_tracking_msgs/TrackedPersons", header=Header, tracks=sequence[TrackedPerson])

Path = message("nav_msgs/Path", header=Header, poses=sequence[PoseStamped])
MapMetaData = message(
    "nav_msgs/MapMetaData", map_load_time=Time, resolution=float32, width=uint32, height=uint32, origin=Pose
)
OccupancyGrid = message("nav_msgs/OccupancyGrid", header=Header, info=MapMetaData, data=sequence[int8])
Image = message("sensor_msgs/CompressedImage", header=Header, format=str, data=sequence[byte])
UV = message("visualization_msgs/UVCoordinate", u=float32, v=float32)
Mesh = message("visualization_msgs/MeshFile", filename=str, data=sequence[byte])
Marker = message(
    "visualization_msgs/Marker",
    header=Header,
    ns=str,
    id=int32,
    type=int32,
    action=int32,
    pose=Pose,
    scale=Vector,
    color=Color,
    lifetime=Duration,
    frame_locked=bool,
    points=sequence[Point],
    colors=sequence[Color],
    texture_resource=str,
    texture=Image,
    uv_coordinates=sequence[UV],
    text=str,
    mesh_resource=str,
    mesh_file=Mesh,
    mesh_use_embedded_materials=bool,
)
MarkerArray = message("visualization_msgs/MarkerArray", markers=sequence[Marker])
KeyValue = message("diagnostic_msgs/KeyValue", key=str, value=str)
Status = message(
    "diagnostic_msgs/DiagnosticStatus",
    level=byte,
    name=str,
    message=str,
    hardware_id=str,
    values=sequence[KeyValue],
)
Diagnostics = message("diagnostic_msgs/DiagnosticArray", header=Header, status=sequence[Status])

Hypothesis = message(
    "ddl_msgs/Hypothesis", weight=float64, certified=bool, goal=Point, x=sequence[float64], y=sequence[float64]
)
Forecast = message(
    "ddl_msgs/PedestrianForecast",
    id=str,
    position=Point,
    age=float64,
    familiarity=float64,
    scales=sequence[float64],
    hypotheses=sequence[Hypothesis],
)
Forecasts = message(
    "ddl_msgs/Forecasts", header=Header, time_step=float64, joint=bool, pedestrians=sequence[Forecast]
)
