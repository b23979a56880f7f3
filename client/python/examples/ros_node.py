"""A ROS 2 node: image, camera_info and imu in; pose, tf (map to odom) and diagnostics out.

usage: ros_node.py --ros-args -p server:=127.0.0.1:50051 -p map:=yard -r image:=/camera/image_raw ...
Parameters: server, map, robot, map_frame, odom_frame, base_frame. tf must know odom to base (the robot's odometry), and
base to the camera's optical frame and to the IMU. The map must be metric.
"""

import contextlib
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from rosidl_runtime_py import set_message_fields
from sensor_msgs.msg import CameraInfo, Image, Imu
from tf2_ros import Buffer, TransformBroadcaster, TransformException, TransformListener

import maploc
from maploc import ros

DEFAULTS = {"server": "127.0.0.1:50051", "map": "yard", "robot": "ros-robot"}
DEFAULTS |= {"map_frame": "map", "odom_frame": "odom", "base_frame": "base_link"}  # REP-105
NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)  # a slow answer must not pile up images
TF_SECONDS = 0.05  # between broadcasts of map to odom
WAIT = Duration(seconds=0.3)  # an image may come before the odometry of its stamp
ENDED = ("SESSION_CLOSED", "SESSION_NOT_FOUND")  # idle for too long; or the server has another store
IMU_NANOS = 100_000_000  # an older sample says nothing of the image


def message(kind: type[Any], fields: dict[str, Any]) -> Any:
    """A message of that kind."""
    set_message_fields(made := kind(), fields)
    return made


class LocalizerNode:
    """Localizes each image and holds the answers against odometry."""

    def __init__(self, node: Any, client: maploc.Client, names: dict[str, str]) -> None:
        self._node, self._client, self._names = node, client, names
        self.session: maploc.Session | None = None
        self._tracker = maploc.Tracker()
        self._camera: maploc.Camera | None = None
        self._gravity: tuple[int, maploc.Gravity] | None = None  # with its stamp
        self._map_from_odom: maploc.Pose | None = None
        self._buffer = Buffer()
        self._listener = TransformListener(self._buffer, node)
        self._tf = TransformBroadcaster(node)
        self._pose = node.create_publisher(PoseWithCovarianceStamped, "pose", 10)
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        # Each in a group of its own: tf and the IMU go on while an image is being localized.
        info = CameraInfo, "camera_info", self.on_camera_info
        for kind, topic, callback in ((Image, "image", self.on_image), info, (Imu, "imu", self.on_imu)):
            node.create_subscription(kind, topic, callback, NEWEST, callback_group=MutuallyExclusiveCallbackGroup())
        node.create_timer(TF_SECONDS, self.on_timer, callback_group=MutuallyExclusiveCallbackGroup())

    def on_camera_info(self, info: Any) -> None:
        """Takes the calibration of the images as they are sent: not rectified."""
        try:
            self._camera = ros.camera(info)
        except maploc.MaplocError as error:
            self._tell(DiagnosticStatus.ERROR, str(error), ros.unix_nanos(info.header.stamp))

    def on_imu(self, imu: Any) -> None:
        """Takes gravity, in the base's frame."""
        try:
            base_from_imu = self._look_up(self._names["base_frame"], imu.header.frame_id, Time())
            self._gravity = ros.unix_nanos(imu.header.stamp), ros.gravity(imu, base_from_imu[:3, :3])
        except (maploc.MaplocError, TransformException):
            self._gravity = None  # a bump; or tf has not begun

    def on_image(self, image: Any) -> None:
        """Asks the server, and publishes the pose of the image's stamp and what became of the answer."""
        nanos, base = ros.unix_nanos(image.header.stamp), self._names["base_frame"]
        if nanos < 0:
            return self._tell(DiagnosticStatus.ERROR, "the image's stamp is negative", 0)
        try:
            odom_from_base = self._look_up(self._names["odom_frame"], base, Time.from_msg(image.header.stamp))
            camera_from_base = self._look_up(image.header.frame_id, base, Time())
        except TransformException as error:
            return self._tell(DiagnosticStatus.WARN, f"no transform: {error}", nanos)
        self._tell(*self._judge(image, nanos, odom_from_base, camera_from_base), nanos)
        pose, self._map_from_odom = self._tracker.map_from_base(odom_from_base), self._tracker.map_from_odom()
        if pose:
            stamped = ros.pose_with_covariance_stamped(pose, nanos, frame_id=self._names["map_frame"])
            self._pose.publish(message(PoseWithCovarianceStamped, stamped))

    def on_timer(self) -> None:
        """Broadcasts map to odom, ahead of the clock, so that it holds until the next time."""
        if self._map_from_odom:
            nanos = self._node.get_clock().now().nanoseconds + int(2e9 * TF_SECONDS)
            frame, child = self._names["map_frame"], self._names["odom_frame"]
            fields = ros.transform_stamped(self._map_from_odom, nanos, frame_id=frame, child_frame_id=child)
            self._tf.sendTransform(message(TransformStamped, fields))

    def _judge(self, image: Any, nanos: int, odom_from_base: Any, camera_from_base: Any) -> tuple[bytes, str]:
        self._tracker.advance(odom_from_base)
        if self._camera is None:
            return DiagnosticStatus.WARN, "no camera_info yet"
        gravity = self._gravity[1] if self._gravity and abs(self._gravity[0] - nanos) < IMU_NANOS else None
        options = maploc.QueryOptions(capture_unix_nanos=nanos)
        try:
            self.session = self.session or self._client.session(self._names["map"], self._names["robot"])
            answer = self.session.localize_photo(
                ros.pixels(image), self._camera, gravity=gravity, camera_from_body=camera_from_base, options=options
            )
            if answer.pose is None:
                return DiagnosticStatus.WARN, f"not localized: {answer.outcome.name}"
            decision = self._tracker.judge(odom_from_base, answer.pose)
        except maploc.MaplocError as error:
            if error.reason in ENDED:
                self.session = None  # the next image begins another
            return DiagnosticStatus.ERROR, str(error)
        return DiagnosticStatus.OK if decision.taken else DiagnosticStatus.WARN, decision.reason

    def _look_up(self, target: str, source: str, time: Any) -> Any:
        return ros.matrix(self._buffer.lookup_transform(target, source, time, WAIT).transform)

    def _tell(self, level: bytes, text: str, nanos: int) -> None:
        held = {"key": "held back in a row", "value": str(self._tracker.held_in_a_row)}
        status = {"level": level, "name": "maploc", "message": text, "hardware_id": "", "values": [held]}
        self._diagnostics.publish(message(DiagnosticArray, {"header": ros.header(nanos, ""), "status": [status]}))


def main() -> None:
    """Until Ctrl-C, which ends the session: what was localized counts."""
    rclpy.init()
    node = rclpy.create_node("maploc")
    names = {name: str(node.declare_parameter(name, value).value) for name, value in DEFAULTS.items()}
    with maploc.Client(names["server"]) as client:
        if not client.map(names["map"]).metric:
            raise SystemExit("the map is not metric; import it with --scale")
        localizer = LocalizerNode(node, client, names)
        executor = MultiThreadedExecutor(num_threads=4)
        executor.add_node(node)
        with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
            executor.spin()
        if localizer.session:
            localizer.session.end()
    node.destroy_node()


if __name__ == "__main__":
    main()
