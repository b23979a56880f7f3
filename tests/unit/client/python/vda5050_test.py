"""VDA 5050's mobileRobotPosition of a robot that drives along y."""

import json
import math
import unittest
from typing import Any

import maploc
import numpy as np
import numpy.typing as npt
from maploc.vda5050 import mobile_robot_position

# json_schemas/state.schema of VDA 5050 3.0: name, type, whether it is required.
SCHEMA = {
    "x": (float, True),
    "y": (float, True),
    "theta": (float, True),
    "mapId": (str, True),
    "localized": (bool, True),
    "localizationScore": (float, False),
    "deviationRange": (float, False),
}
FACING_Y = np.array([0, 0, math.sqrt(0.5), math.sqrt(0.5)])


class MobileRobotPositionTest(unittest.TestCase):
    """Odometry begins at the map's origin, and faces along x where the map's y is."""

    def setUp(self) -> None:
        self.tracker = maploc.Tracker()

    def at(self, meters: float) -> npt.NDArray[np.float64]:
        """In the odometry's frame."""
        matrix = np.eye(4)
        matrix[0, 3] = meters
        return matrix

    def answer_at(self, meters: float, off: float = 0.0) -> maploc.Decision:
        """2 cm exact."""
        covariance = np.diag([4e-4] * 3 + [1e-4] * 3)
        return self.tracker.judge(self.at(meters), maploc.Pose(np.array([off, meters, 0.0]), FACING_Y, covariance))

    def start(self) -> None:
        """With a pose."""
        for meters in (0.0, 0.3, 0.6):
            self.answer_at(meters)

    def test_there_is_none_before_the_first_pose(self) -> None:
        self.answer_at(0.0)
        self.assertIsNone(mobile_robot_position(self.tracker, self.at(0), "hall"))

    def test_the_fields_are_the_schemas(self) -> None:
        self.start()
        position = json.loads(json.dumps(mobile_robot_position(self.tracker, self.at(1.0), "hall")))
        self.assertEqual(set(position), set(SCHEMA))
        for name, (kind, _) in SCHEMA.items():
            self.assertIs(type(position[name]), kind, name)
        self.assertEqual((position["mapId"], position["localized"]), ("hall", True))
        np.testing.assert_allclose([position["x"], position["y"]], [0, 1.0], atol=1e-9)
        self.assertAlmostEqual(position["theta"], math.pi / 2)
        self.assertGreater(position["localizationScore"], 0.99)
        self.assertLessEqual(position["localizationScore"], 1)
        self.assertTrue(0.02 < position["deviationRange"] < 0.2, position)

    def test_refused_images_are_not_lost_but_a_long_way_without_answers_is(self) -> None:
        self.start()
        was_localized = []
        for meters in np.arange(1.0, 40.0):
            self.tracker.advance(self.at(meters))
            position = mobile_robot_position(self.tracker, self.at(meters), "hall")
            assert position is not None
            was_localized.append(position["localized"])
            self.assertEqual(position["localized"], position["deviationRange"] <= 0.5)
            self.assertEqual(position["localized"], position["localizationScore"] >= 0.95)
        self.assertTrue(all(was_localized[:5]))
        self.assertFalse(any(was_localized[20:]))

    def test_bounds_that_make_no_sense_are_refused_by_name(self) -> None:
        self.start()
        for name, bad in [("max_deviation_meters", math.nan), ("max_deviation_meters", -1), ("max_held_in_a_row", 0)]:
            bounds: dict[str, Any] = {name: bad}
            with self.assertRaisesRegex(maploc.MaplocError, name):
                mobile_robot_position(self.tracker, self.at(1.0), "hall", **bounds)
        position = mobile_robot_position(self.tracker, self.at(1.0), "hall", max_deviation_meters=1e200)
        assert position is not None
        self.assertEqual(position["localizationScore"], 1)

    def test_one_contradicted_answer_is_not_lost_but_ten_in_a_row_are(self) -> None:
        self.start()
        for count in range(1, 11):
            self.answer_at(0.6 + count / 10, off=3.0 * count)  # no two of them agree
            position = mobile_robot_position(self.tracker, self.at(0.6 + count / 10), "hall")
            assert position is not None
            self.assertEqual(position["localized"], count < 10, count)
        self.assertEqual(position["localizationScore"], 0)


if __name__ == "__main__":
    unittest.main()
