"""Answers beside odometry: the vectors that client/odometry passes too, and what a user would miss."""

import json
import math
import os
import pathlib
import unittest
from typing import Any

import maploc
import numpy as np
import numpy.typing as npt
from maploc.arrays import matrix_from_quaternion

SOURCE = pathlib.Path(os.environ["MAPLOC_SOURCE_DIR"])
VECTORS = json.loads((SOURCE / "tests/unit/client/odometry/vectors.json").read_text())
TOLERANCE = 1e-7  # the vectors are of differences and series


def matrix_of(numbers: dict[str, Any]) -> npt.NDArray[np.float64]:
    """4 x 4."""
    matrix = np.eye(4)
    matrix[:3, :3] = matrix_from_quaternion(np.array(numbers["xyzw"]))
    matrix[:3, 3] = numbers["position"]
    return matrix


def pose_of(numbers: dict[str, Any]) -> maploc.Pose:
    """With its covariance."""
    covariance = np.reshape(numbers["covariance"], (6, 6))
    return maploc.Pose(np.array(numbers["position"]), np.array(numbers["xyzw"]), covariance)


def options_of(numbers: dict[str, Any]) -> maploc.TrackerOptions:
    """A drive's."""
    drift = maploc.OdometryDrift(**{name: maploc.PoseSigmas(*sigmas) for name, sigmas in numbers["drift"].items()})
    return maploc.TrackerOptions(drift, numbers["max_sigmas"], numbers["agreeing_answers"], numbers["smooth"])


class VectorsTest(unittest.TestCase):
    """Drives of vectors.json."""

    def test_the_default_drift_is_the_one_of_cpp(self) -> None:
        self.assertEqual(options_of(VECTORS[0]["options"]), maploc.TrackerOptions())

    def test_all_drives(self) -> None:
        for drive in VECTORS:
            tracker = maploc.Tracker(options_of(drive["options"]))
            for number, step in enumerate(drive["steps"]):
                with self.subTest(drive=drive["name"], step=number):
                    self.check_step(tracker, step)

    def check_step(self, tracker: maploc.Tracker, step: dict[str, Any]) -> None:
        """One image."""
        here = matrix_of(step["odom_from_base"])
        if "answer" in step:
            decision = tracker.judge(here, pose_of(step["answer"]))
            self.assertEqual((decision.verdict.name, decision.agreeing), (step["verdict"], step["agreeing"]))
            gap = None if decision.gap is None else list(vars(decision.gap).values())
            self.assertEqual(gap is None, step["gap"] is None)
            if gap is not None:
                np.testing.assert_allclose(gap, step["gap"], rtol=1e-6, atol=TOLERANCE)
        else:
            tracker.advance(here)
        self.assertEqual(tracker.held_in_a_row, step["held_in_a_row"])
        if "map_from_odom" not in step:
            self.assertIsNone(tracker.map_from_odom())
            return
        self.check_pose(tracker.map_from_odom(), step["map_from_odom"])
        later = tracker.map_from_base(matrix_of(step["later_odom_from_base"]))
        self.check_pose(later, step["later_map_from_base"])

    def check_pose(self, found: maploc.Pose | None, expected: dict[str, Any]) -> None:
        """Within what the vectors' differences lose."""
        assert found is not None
        np.testing.assert_allclose(found.map_from_body, matrix_of(expected), atol=TOLERANCE)
        wanted = np.reshape(expected["covariance"], (6, 6))
        np.testing.assert_allclose(found.covariance, wanted, atol=TOLERANCE * float(np.abs(wanted).max()) + 1e-12)


class TrackerTest(unittest.TestCase):
    """A robot that drives along x."""

    def setUp(self) -> None:
        self.tracker = maploc.Tracker()
        for meters in (0.0, 0.5, 1.0):
            self.answer_at(meters)

    def answer_at(self, meters: float, off: float = 0.0) -> maploc.Decision:
        """The odometry's frame is the map's."""
        pose = maploc.Pose(np.array([meters, off, 0]), np.array([0, 0, 0, 1.0]), 1e-3 * np.eye(6))
        return self.tracker.judge(self.at(meters), pose)

    def at(self, meters: float) -> npt.NDArray[np.float64]:
        """In the odometry's frame."""
        matrix = np.eye(4)
        matrix[0, 3] = meters
        return matrix

    def test_a_contradicted_answer_is_held_back_with_its_reason(self) -> None:
        decision = self.answer_at(1.5, off=2.0)
        self.assertFalse(decision.taken)
        self.assertRegex(decision.reason, r"contradicts its position by 2\.00 m \(\d+\.\d sigma\); 1 on this place")
        pose = self.tracker.map_from_base(self.at(1.5))
        assert pose is not None
        np.testing.assert_allclose(pose.position_in_map, [1.5, 0, 0], atol=1e-9)

    def test_each_verdict_tells_its_reason(self) -> None:
        self.assertEqual(self.answer_at(1.5).reason, "taken: odometry agrees")
        turned = maploc.Pose(np.array([2.0, 0, 0]), np.array([0, 0, math.sin(0.5), math.cos(0.5)]), 1e-3 * np.eye(6))
        reason = self.tracker.judge(self.at(2.0), turned).reason
        self.assertTrue(reason.startswith("held back: odometry contradicts its rotation by 57.3 degrees ("), reason)
        for meters in (2.5, 3.0):
            self.assertFalse(self.answer_at(meters, off=4.0).taken)
        reason = self.answer_at(3.5, off=4.0).reason
        self.assertEqual(reason, "taken: enough answers agree on a place 4.00 m and 0.0 degrees away")
        self.tracker = maploc.Tracker(maploc.TrackerOptions(agreeing_answers=2))
        self.assertEqual(self.answer_at(0.0).reason, "held back: there is no pose yet; 1 on this place so far")
        self.assertEqual(self.answer_at(0.0).reason, "taken: enough answers agree on a first place")

    def test_refused_images_leave_the_pose_and_widen_it(self) -> None:
        before = self.tracker.map_from_base(self.at(1.0))
        for meters in (2.0, 3.0):
            self.tracker.advance(self.at(meters))
        after = self.tracker.map_from_base(self.at(3.0))
        assert before is not None and after is not None
        np.testing.assert_allclose(after.position_in_map, [3, 0, 0], atol=1e-9)
        self.assertGreater(after.covariance[0, 0], before.covariance[0, 0] + 0.03**2)
        self.assertEqual(self.tracker.held_in_a_row, 0)

    def test_a_standing_robot_gets_no_more_certain_than_its_answers_are(self) -> None:
        self.tracker = maploc.Tracker()
        for _ in range(200):
            self.answer_at(0.0)
        pose = self.tracker.map_from_base(self.at(0.0))
        assert pose is not None
        self.assertGreaterEqual(np.diag(pose.covariance).min(), 1e-3)

    def test_what_is_no_input_is_refused_by_name(self) -> None:
        good = maploc.Pose(np.zeros(3), np.array([0, 0, 0, 1.0]), np.eye(6))
        skew = np.eye(6)
        skew[0, 1] = 0.5
        hidden = np.diag([1e10, 1e10, 1e10, 1e-5, 1e-5, -5e-3])  # metres that hide radians
        far = np.eye(4)
        far[0, 3] = 1e200
        for here, pose, field in [
            (np.full((4, 4), math.nan), good, "odom_from_base"),
            (np.eye(3), good, "odom_from_base"),
            (far, good, "odom_from_base"),
            (np.eye(4), maploc.Pose(np.zeros(3), good.orientation_xyzw, hidden), "answer.covariance"),
            (np.eye(4), maploc.Pose(np.zeros(3), good.orientation_xyzw, np.zeros((6, 6))), "answer.covariance"),
            (np.eye(4), maploc.Pose(np.zeros(3), good.orientation_xyzw, -np.eye(6)), "answer.covariance"),
            (np.eye(4), maploc.Pose(np.zeros(3), good.orientation_xyzw, skew), "answer.covariance"),
            (np.eye(4), maploc.Pose(np.full(3, math.inf), good.orientation_xyzw, np.eye(6)), "answer.position_in_map"),
            (np.eye(4), maploc.Pose(np.zeros(3), 2 * good.orientation_xyzw, np.eye(6)), "answer.orientation_xyzw"),
        ]:
            with self.subTest(field=field), self.assertRaises(maploc.MaplocError) as raised:
                self.tracker.judge(here, pose)
            self.assertEqual(raised.exception.field, field)
        with self.assertRaisesRegex(maploc.MaplocError, "at_rest"):
            maploc.OdometryDrift(at_rest=maploc.PoseSigmas(0, 0, 0, 0))
        for bad in (-1.0, math.nan):
            with self.assertRaisesRegex(maploc.MaplocError, "per_meter"):
                maploc.OdometryDrift(per_meter=maploc.PoseSigmas(0, bad, 0, 0))
        with self.assertRaisesRegex(maploc.MaplocError, "max_sigmas"):
            maploc.TrackerOptions(max_sigmas=0)
        for wrong in (0, 2.5, "3"):
            with self.assertRaisesRegex(maploc.MaplocError, "agreeing_answers"):
                maploc.TrackerOptions(agreeing_answers=wrong)  # type: ignore[arg-type]
        with self.assertRaisesRegex(maploc.MaplocError, "max_sigmas"):
            maploc.TrackerOptions(max_sigmas="3")  # type: ignore[arg-type]

    def test_odometry_that_is_a_rotation_but_for_rounding_stays_one(self) -> None:
        rounded = np.diag([1.0004, 1.0004, 1.0004, 1])
        answer = maploc.Pose(np.zeros(3), np.array([0, 0, 0, 1.0]), 1e-3 * np.eye(6))
        self.assertTrue(self.tracker.judge(rounded, answer).taken)
        pose = self.tracker.map_from_base(rounded)
        assert pose is not None
        np.testing.assert_allclose(pose.map_from_body[:3, :3], np.eye(3), atol=1e-9)


if __name__ == "__main__":
    unittest.main()
