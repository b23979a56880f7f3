"""Stands in for the ROS 2 calls that examples/ros_node.py makes, because ROS is not installed here.

It has the signatures and the message fields that ROS publishes (common_interfaces, rclpy, tf2_ros, rosidl_runtime_py),
and refuses what these do not have. Callbacks are called by the test.
"""

import types
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from maploc.arrays import quaternion_from_matrix

Floats = npt.NDArray[np.float64]


class Message:
    """With the fields that its kind has, and no others."""

    kinds: dict[str, Any] = {}

    def __init__(self) -> None:
        for name, kind in self.kinds.items():
            object.__setattr__(self, name, kind())

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in self.kinds:
            raise AttributeError(f"{type(self).__name__} has no field {name}")
        object.__setattr__(self, name, value)


def kind_of(name: str, /, **kinds: Any) -> Any:
    """A kind of message. ListOf is an array of messages."""
    return type(name, (Message,), {"kinds": kinds})


@dataclass
class ListOf:
    """An array of messages."""

    kind: Any

    def __call__(self) -> list[Any]:
        return []


def floats(count: int) -> Callable[[], Floats]:
    """float64[count]."""
    return lambda: np.zeros(count)


Time = kind_of("Time", sec=int, nanosec=int)
Header = kind_of("Header", stamp=Time, frame_id=str)
Vector3 = kind_of("Vector3", x=float, y=float, z=float)
Quaternion = kind_of("Quaternion", x=float, y=float, z=float, w=lambda: 1.0)
Pose = kind_of("Pose", position=Vector3, orientation=Quaternion)
PoseWithCovariance = kind_of("PoseWithCovariance", pose=Pose, covariance=floats(36))
PoseWithCovarianceStamped = kind_of("PoseWithCovarianceStamped", header=Header, pose=PoseWithCovariance)
Transform = kind_of("Transform", translation=Vector3, rotation=Quaternion)
TransformStamped = kind_of("TransformStamped", header=Header, child_frame_id=str, transform=Transform)
KeyValue = kind_of("KeyValue", key=str, value=str)
DiagnosticStatus = kind_of(
    "DiagnosticStatus", level=lambda: b"\0", name=str, message=str, hardware_id=str, values=ListOf(KeyValue)
)
DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR = b"\0", b"\1", b"\2"
DiagnosticArray = kind_of("DiagnosticArray", header=Header, status=ListOf(DiagnosticStatus))
Roi = kind_of("RegionOfInterest", x_offset=int, y_offset=int, height=int, width=int, do_rectify=bool)
CameraInfo = kind_of(
    "CameraInfo",
    **{"header": Header, "height": int, "width": int, "distortion_model": str, "d": list, "k": floats(9)},
    **{"r": floats(9), "p": floats(12), "binning_x": int, "binning_y": int, "roi": Roi},
)
Image = kind_of(
    "Image", header=Header, height=int, width=int, encoding=str, is_bigendian=int, step=int, data=bytes
)
Imu = kind_of(
    "Imu",
    **{"header": Header, "orientation": Quaternion, "orientation_covariance": floats(9), "angular_velocity": Vector3},
    **{"angular_velocity_covariance": floats(9), "linear_acceleration": Vector3},
    linear_acceleration_covariance=floats(9),
)


def set_message_fields(msg: Any, values: dict[str, Any]) -> list[Any]:
    """As rosidl_runtime_py: messages within are made of dicts."""
    for name, value in values.items():
        kind = msg.kinds[name]  # KeyError: no such field
        if isinstance(kind, ListOf):
            setattr(msg, name, [filled(kind.kind, element) for element in value])
        elif isinstance(kind, type) and issubclass(kind, Message):
            setattr(msg, name, filled(kind, value))
        else:
            kept = type(getattr(msg, name))
            setattr(msg, name, np.array(value, np.float64) if kept is np.ndarray else value)
            if type(getattr(msg, name)) is not kept:
                raise TypeError(f"{name} is a {kept.__name__}, not {value!r}")
    return []


def filled(kind: Any, values: dict[str, Any]) -> Any:
    """A message of this kind."""
    made = kind()
    set_message_fields(made, values)
    return made


class TransformException(Exception):
    """tf does not know it."""


@dataclass
class Tf:
    """What tf knows: (target, source) to 4 x 4; of an image's time, those with its nanoseconds."""

    static: dict[tuple[str, str], Floats] = field(default_factory=dict)
    at: dict[tuple[str, str, int], Floats] = field(default_factory=dict)
    sent: list[Any] = field(default_factory=list)

    def lookup_transform(self, target_frame: str, source_frame: str, time: Any, timeout: Any) -> Any:
        """As tf2_ros.Buffer."""
        assert timeout.seconds > 0
        matrix = self.static.get((target_frame, source_frame))
        if time.nanoseconds:
            matrix = self.at.get((target_frame, source_frame, time.nanoseconds))
        if matrix is None:
            raise TransformException(f"{target_frame} from {source_frame}")
        rotation = dict(zip("xyzw", map(float, quaternion_from_matrix(matrix[:3, :3]))))
        translation = dict(zip("xyz", map(float, matrix[:3, 3])))
        return filled(TransformStamped, {"transform": {"rotation": rotation, "translation": translation}})


@dataclass
class Clock:
    """Of the node."""

    nanoseconds: int = 5_000_000_000

    def now(self) -> Any:
        """As rclpy.time.Time."""
        return self


class Node:
    """What the test plays with."""

    def __init__(self, parameters: dict[str, Any]) -> None:
        self.parameters = parameters
        self.callbacks: dict[str, Callable[[Any], None]] = {}
        self.timers: list[Callable[[], None]] = []
        self.published: dict[str, list[Any]] = {}
        self.groups: list[Any] = []

    def create_subscription(
        self, msg_type: Any, topic: str, callback: Any, qos_profile: Any, *, callback_group: Any
    ) -> None:
        """The test calls back."""
        assert qos_profile.depth == 1 and issubclass(msg_type, Message)
        self.callbacks[topic] = callback
        self.groups.append(callback_group)

    def create_publisher(self, msg_type: Any, topic: str, qos_profile: int) -> Any:
        """Publishes into `published`."""
        messages = self.published.setdefault(topic, [])

        def publish(msg: Any) -> None:
            assert type(msg) is msg_type
            messages.append(msg)

        return types.SimpleNamespace(publish=publish)

    def create_timer(self, timer_period_sec: float, callback: Callable[[], None], callback_group: Any) -> None:
        """Runs when the test says so."""
        assert timer_period_sec > 0
        self.timers.append(callback)
        self.groups.append(callback_group)

    def declare_parameter(self, name: str, value: Any) -> Any:
        """Set on the command line, or as declared."""
        return types.SimpleNamespace(value=self.parameters.get(name, value))

    def get_clock(self) -> Clock:
        """The time."""
        return Clock()

    def destroy_node(self) -> None:
        """The end."""


@dataclass
class Ros:
    """The modules, and what happens when the executor spins."""

    parameters: dict[str, Any]
    spin: Callable[[Node], None]
    tf: Tf = field(default_factory=Tf)

    def modules(self) -> dict[str, types.ModuleType]:
        """For sys.modules."""
        node, tf = Node(self.parameters), self.tf

        class Executor:
            def __init__(self, num_threads: int) -> None:
                # One for each group, and one for tf's listener: else an image blocks what it waits for.
                assert num_threads >= 4

            def add_node(self, added: Node) -> None:
                assert added is node

            def spin(self_executor) -> None:
                assert len(set(map(id, node.groups))) == len(node.groups)
                self.spin(node)
                raise KeyboardInterrupt

        def made(name: str, **values: Any) -> types.ModuleType:
            module = types.ModuleType(name)
            vars(module).update(values)
            return module

        class Moment:
            def __init__(self, nanoseconds: int = 0) -> None:
                self.nanoseconds = nanoseconds

            @classmethod
            def from_msg(cls, stamp: Any) -> "Moment":
                return cls(stamp.sec * 10**9 + stamp.nanosec)

        simple = types.SimpleNamespace
        broadcaster = simple(sendTransform=tf.sent.append)
        return {
            "rclpy": made("rclpy", init=lambda: None, create_node=lambda name: node),
            "rclpy.callback_groups": made("rclpy.callback_groups", MutuallyExclusiveCallbackGroup=lambda: object()),
            "rclpy.duration": made("rclpy.duration", Duration=lambda seconds: simple(seconds=seconds)),
            "rclpy.executors": made(
                "rclpy.executors",
                MultiThreadedExecutor=Executor,
                ExternalShutdownException=type("ExternalShutdownException", (Exception,), {}),
            ),
            "rclpy.qos": made(
                "rclpy.qos",
                QoSProfile=lambda depth, reliability: simple(depth=depth),
                ReliabilityPolicy=simple(BEST_EFFORT=2),
            ),
            "rclpy.time": made("rclpy.time", Time=Moment),
            "rosidl_runtime_py": made("rosidl_runtime_py", set_message_fields=set_message_fields),
            "tf2_ros": made(
                "tf2_ros",
                Buffer=lambda: tf,
                TransformListener=lambda buffer, node: None,
                TransformBroadcaster=lambda node: broadcaster,
                TransformException=TransformException,
            ),
            "sensor_msgs": made("sensor_msgs"),
            "sensor_msgs.msg": made("sensor_msgs.msg", CameraInfo=CameraInfo, Image=Image, Imu=Imu),
            "geometry_msgs": made("geometry_msgs"),
            "geometry_msgs.msg": made(
                "geometry_msgs.msg",
                PoseWithCovarianceStamped=PoseWithCovarianceStamped,
                TransformStamped=TransformStamped,
            ),
            "diagnostic_msgs": made("diagnostic_msgs"),
            "diagnostic_msgs.msg": made(
                "diagnostic_msgs.msg", DiagnosticArray=DiagnosticArray, DiagnosticStatus=DiagnosticStatus
            ),
        }
