"""Fields of ROS 2 messages. Nothing here imports ROS.

Incoming messages are read by their fields' names, so that any object with these will do. Outgoing ones are dicts, for
rosidl_runtime_py.set_message_fields(message, fields).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from maploc.answer import Pose
from maploc.arrays import Floats, matrix_from_quaternion, numbers
from maploc.camera import Camera
from maploc.errors import invalid
from maploc.gravity import Gravity

_CAMERA_INFO_FIELDS = ("height", "width", "distortion_model", "d", "k", "p", "binning_x", "binning_y")
_ROI_FIELDS = ("x_offset", "y_offset", "height", "width")
_CHANNELS = {"mono8": 1, "bgr8": 3, "rgb8": 3}


def camera(info: Any, *, rectified: bool = False) -> Camera:
    """Of a sensor_msgs/CameraInfo. `rectified` as in Camera.from_ros."""
    fields = {name: getattr(info, name) for name in _CAMERA_INFO_FIELDS}
    fields["roi"] = {name: getattr(info.roi, name) for name in _ROI_FIELDS}
    return Camera.from_ros(fields, rectified=rectified)


def pixels(image: Any) -> npt.NDArray[np.uint8]:
    """Of a sensor_msgs/Image, as localize_photo takes them: grey, or blue-green-red."""
    channels = _CHANNELS.get(image.encoding)
    if channels is None:
        invalid("image.encoding", f"{image.encoding!r} is not supported; convert it to {', '.join(_CHANNELS)}")
    data = np.frombuffer(image.data, np.uint8)
    if image.step < image.width * channels or data.size != image.height * image.step:
        invalid("image.data", f"holds {data.size} bytes, not height times step", "COUNT_MISMATCH")
    rows = data.reshape(image.height, image.step)[:, : image.width * channels]
    if channels == 1:
        return rows
    colours = rows.reshape(image.height, image.width, 3)
    return colours if image.encoding == "bgr8" else colours[:, :, ::-1]


def gravity(imu: Any, body_from_imu: npt.ArrayLike, *, sigma_degrees: float = 2.0) -> Gravity:
    """Of a sensor_msgs/Imu whose robot stands or drives evenly. `body_from_imu` is a 3 x 3 rotation."""
    if imu.linear_acceleration_covariance[0] == -1:
        invalid("imu.linear_acceleration", "is not measured, says its covariance; use another IMU, or none")
    up = [imu.linear_acceleration.x, imu.linear_acceleration.y, imu.linear_acceleration.z]
    return Gravity.from_accelerometer_at_rest(up, body_from_imu=body_from_imu, sigma_degrees=sigma_degrees)


def matrix(transform: Any) -> Floats:
    """4 x 4 of a geometry_msgs/Transform: that of `lookup_transform(target, source, stamp)` is target_from_source."""
    q, t = transform.rotation, transform.translation
    xyzw = numbers("transform.rotation", [q.x, q.y, q.z, q.w], (4,))
    norm = float(np.linalg.norm(xyzw))
    if abs(norm - 1) > 1e-3:
        invalid("transform.rotation", f"has the norm {norm:g}, but must be a unit quaternion", "NOT_A_ROTATION")
    result = np.eye(4)
    result[:3, :3] = matrix_from_quaternion(xyzw / norm)
    result[:3, 3] = numbers("transform.translation", [t.x, t.y, t.z], (3,))
    return result


def unix_nanos(stamp: Any) -> int:
    """Of a builtin_interfaces/Time."""
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


def header(nanos: int, frame_id: str) -> dict[str, Any]:
    """A std_msgs/Header."""
    return {"stamp": {"sec": nanos // 10**9, "nanosec": nanos % 10**9}, "frame_id": frame_id}


def pose_with_covariance_stamped(pose: Pose, nanos: int, *, frame_id: str = "map") -> dict[str, Any]:
    """A geometry_msgs/PoseWithCovarianceStamped.

    Its covariance has the order of maploc's, row-major, and rotations about the fixed axes of frame_id: so nothing is
    converted. It is not the covariance of roll, pitch and yaw, which differ from these by a turn by the robot's yaw.
    """
    placed = {"position": _xyz(pose.position_in_map), "orientation": _xyzw(pose.orientation_xyzw)}
    covariance = [float(value) for value in pose.covariance.ravel()]
    return {"header": header(nanos, frame_id), "pose": {"pose": placed, "covariance": covariance}}


def transform_stamped(
    map_from_odom: Pose, nanos: int, *, frame_id: str = "map", child_frame_id: str = "odom"
) -> dict[str, Any]:
    """A geometry_msgs/TransformStamped, for tf: REP-105 has the pose of `odom` in `map`."""
    transform = {"translation": _xyz(map_from_odom.position_in_map), "rotation": _xyzw(map_from_odom.orientation_xyzw)}
    return {"header": header(nanos, frame_id), "child_frame_id": child_frame_id, "transform": transform}


def _xyz(values: Sequence[float] | Floats) -> dict[str, float]:
    return dict(zip("xyz", map(float, values)))


def _xyzw(values: Sequence[float] | Floats) -> dict[str, float]:
    return dict(zip("xyzw", map(float, values)))
