"""examples/ros_node.py over a stand-in of ROS, on the painted room."""

import runpy
import unittest
from typing import Any
from unittest import mock

import cv2
import maploc
import numpy as np
import numpy.typing as npt
from maploc import ros
from painted_room import FOCAL, HEIGHT, WIDTH, Shot
from room_test_case import RoomTestCase
from ros_stand_in import CameraInfo, Image, Imu, Node, Ros, filled
from running_server import SOURCE, run

NODE = SOURCE / "client" / "python" / "examples" / "ros_node.py"
Floats = npt.NDArray[np.float64]
# The camera looks along the base's x, 20 cm above it; the IMU lies upside down in the base.
CAMERA_FROM_BASE = np.array([[0, -1, 0, 0], [0, 0, -1, 0.2], [1, 0, 0, 0], [0, 0, 0, 1.0]])
BASE_FROM_IMU = np.diag([1.0, -1, -1, 1])
MAP_FROM_ODOM = np.array([[0, -1, 0, 7.0], [1, 0, 0, -3.0], [0, 0, 1, 0.4], [0, 0, 0, 1]])


def room_from_base(shot: Shot) -> Floats:
    """The truth."""
    camera_from_room = np.eye(4)
    camera_from_room[:3] = shot.camera_from_room
    matrix: Floats = np.linalg.inv(camera_from_room) @ CAMERA_FROM_BASE
    return matrix


class RosNodeTest(RoomTestCase):
    """A cart that sees the room's query shots, one every second."""

    def setUp(self) -> None:
        self.ros = Ros({"server": self.server.address, "map": "room", "robot": "cart"}, self.drive)
        self.ros.tf.static[("camera", "base_link")] = CAMERA_FROM_BASE
        self.ros.tf.static[("base_link", "imu")] = BASE_FROM_IMU

    def run_node(self) -> None:
        """Until the executor's end."""
        with mock.patch.dict("sys.modules", self.ros.modules()):
            runpy.run_path(str(NODE), run_name="__main__")

    def test_it_is_short(self) -> None:
        self.assertLessEqual(len(NODE.read_text().splitlines()), 150)

    def test_images_become_poses_tf_and_diagnostics(self) -> None:
        self.run_node()
        self.assertEqual(self.segment_counts()[1], 2)  # both sessions count

    def drive(self, node: Node) -> None:
        """What ROS would call, and what comes of it."""
        self.check_before_there_is_all_that_it_takes(node)
        self.see_camera_info(node)
        for second, shot in enumerate([*self.shots, self.shots[0]], 1):
            self.see(node, shot, second)
        said = [(array.status[0].level, array.status[0].message) for array in node.published["/diagnostics"][2:]]
        self.assertEqual([level for level, _ in said], [b"\1", b"\1", b"\0", b"\0"], said)
        self.assertRegex(said[0][1], "no pose yet; 1 on this place")
        self.check_pose(node.published["pose"][-1], self.shots[0])
        self.check_tf(node)
        self.check_a_wrong_answer_is_held_back(node)
        self.check_a_session_that_was_ended_is_begun_anew(node)
        self.check_a_negative_stamp_is_told(node)

    def check_before_there_is_all_that_it_takes(self, node: Node) -> None:
        """Told, and no pose."""
        node.callbacks["image"](self.image(self.shots[0], 1))
        self.know_odometry(self.shots[0], 1)
        node.callbacks["image"](self.image(self.shots[0], 1))
        said = [array.status[0].message for array in node.published["/diagnostics"]]
        self.assertRegex(said[0], "no transform: odom from base_link")
        self.assertEqual(said[1], "no camera_info yet")
        node.timers[0]()
        self.assertEqual((node.published["pose"], self.ros.tf.sent), ([], []))

    def check_a_wrong_answer_is_held_back(self, node: Node) -> None:
        """Odometry says that the robot stands still, the image is of another place."""
        self.ros.tf.at[("odom", "base_link", 9 * 10**9)] = self.ros.tf.at[("odom", "base_link", 4 * 10**9)]
        node.callbacks["image"](self.image(self.shots[2], 9))
        status = node.published["/diagnostics"][-1].status[0]
        self.assertEqual(status.level, b"\1")
        self.assertRegex(status.message, "odometry contradicts its position")
        self.assertEqual(vars(status.values[0]), {"key": "held back in a row", "value": "1"})
        self.check_pose(node.published["pose"][-1], self.shots[0])

    def check_a_session_that_was_ended_is_begun_anew(self, node: Node) -> None:
        """One image is lost."""
        (ended,) = run("maploc-map", "sessions", "--store", str(self.folder / "store.db"))
        self.client.end_session(ended["session"])
        for second in (20, 21):
            self.see(node, self.shots[0], second)
        said = [(array.status[0].level, array.status[0].message) for array in node.published["/diagnostics"][-2:]]
        self.assertIn("SESSION_CLOSED", said[0][1])
        self.assertEqual(said[1][0], b"\0", said)

    def check_a_negative_stamp_is_told(self, node: Node) -> None:
        """No exception leaves the callback."""
        node.callbacks["image"](self.image(self.shots[0], -1))
        self.assertIn("negative", node.published["/diagnostics"][-1].status[0].message)

    def see(self, node: Node, shot: Shot, second: int) -> None:
        """Gravity, odometry and the image."""
        self.know_odometry(shot, second)
        up_in_base = -CAMERA_FROM_BASE[:3, :3].T @ shot.down_in_camera
        acceleration = dict(zip("xyz", map(float, 9.81 * BASE_FROM_IMU[:3, :3].T @ up_in_base)))
        header = ros.header(second * 10**9, "imu")
        node.callbacks["imu"](filled(Imu, {"header": header, "linear_acceleration": acceleration}))
        node.callbacks["image"](self.image(shot, second))

    def know_odometry(self, shot: Shot, second: int) -> None:
        """Without drift."""
        odom_from_base = np.linalg.inv(MAP_FROM_ODOM) @ room_from_base(shot)
        self.ros.tf.at[("odom", "base_link", second * 10**9)] = odom_from_base

    def see_camera_info(self, node: Node) -> None:
        """Of the painted room's camera. The centre of the first pixel is (0, 0)."""
        k = [FOCAL, 0, (WIDTH - 1) / 2, 0, FOCAL, (HEIGHT - 1) / 2, 0, 0, 1]
        fields = {"height": HEIGHT, "width": WIDTH, "distortion_model": "plumb_bob", "d": [0.0] * 5, "k": k}
        node.callbacks["camera_info"](filled(CameraInfo, fields))

    def image(self, shot: Shot, second: int) -> Any:
        """As a camera's driver sends it."""
        photo = cv2.cvtColor(maploc.load_gray(shot.path), cv2.COLOR_GRAY2RGB)
        fields = {"header": ros.header(second * 10**9, "camera"), "height": HEIGHT, "width": WIDTH, "encoding": "rgb8"}
        return filled(Image, {**fields, "step": 3 * WIDTH, "data": photo.tobytes()})

    def check_pose(self, found: Any, shot: Shot) -> None:
        """Of the base, within 2 cm and half a degree, and its covariance says so."""
        self.assertEqual(found.header.frame_id, "map")
        truth = room_from_base(shot)
        position = found.pose.pose.position
        np.testing.assert_allclose([position.x, position.y, position.z], truth[:3, 3], atol=0.02)
        transform = ros.matrix(mock.Mock(rotation=found.pose.pose.orientation, translation=position))
        self.assertGreater(np.trace(transform[:3, :3].T @ truth[:3, :3]), 1 + 2 * np.cos(np.radians(0.5)))
        self.assertLess(found.pose.covariance[0], 0.05**2)
        self.assertGreater(found.pose.covariance[0], 0)

    def check_tf(self, node: Node) -> None:
        """Map to odom, ahead of the clock."""
        node.timers[0]()
        (sent,) = self.ros.tf.sent
        self.assertEqual((sent.header.frame_id, sent.child_frame_id), ("map", "odom"))
        self.assertGreater(ros.unix_nanos(sent.header.stamp), node.get_clock().nanoseconds)
        found = ros.matrix(sent.transform) @ self.ros.tf.at[("odom", "base_link", 4 * 10**9)]
        np.testing.assert_allclose(found, room_from_base(self.shots[0]), atol=0.02)


if __name__ == "__main__":
    unittest.main()
