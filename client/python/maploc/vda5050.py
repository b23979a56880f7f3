"""What a fleet's control wants to know: `mobileRobotPosition` of a VDA 5050 3.0 state or visualization message."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from maploc.arrays import is_number, is_whole
from maploc.errors import invalid
from maploc.odometry import Tracker

# Of a horizontal error whose two directions have the larger of the standard deviations: 95% are nearer.
_SIGMAS_OF_95_PERCENT = math.sqrt(-2 * math.log(0.05))


def mobile_robot_position(
    tracker: Tracker,
    odom_from_base: npt.ArrayLike,
    map_id: str,
    *,
    max_deviation_meters: float = 0.5,
    max_held_in_a_row: int = 10,
) -> dict[str, Any] | None:
    """For json.dumps. None before the first pose: the field is optional, and there is no x to be told.

    `localized` does not follow single images: it turns false when odometry alone has led so far that the robot may be
    more than max_deviation_meters off (95%), or when max_held_in_a_row answers, one after the other, contradict it.
    `deviationRange` is the radius of these 95%; `localizationScore` the probability to be within max_deviation_meters,
    0 with too many contradictions.

    Args:
        tracker: the robot's.
        odom_from_base: 4 x 4, of the message's moment.
        map_id: as the fleet's control calls the map. Its coordinates must be maploc's.
        max_deviation_meters: how exact the site wants its robots to be.
        max_held_in_a_row: Tracker.held_in_a_row from which on the pose is not trusted.
    """
    if not (is_number(max_deviation_meters) and math.isfinite(max_deviation_meters) and max_deviation_meters > 0):
        invalid("max_deviation_meters", "must be finite and positive", "OUT_OF_RANGE")
    if not (is_whole(max_held_in_a_row) and max_held_in_a_row > 0):
        invalid("max_held_in_a_row", "must be a whole number, 1 or more", "OUT_OF_RANGE")
    pose = tracker.map_from_base(odom_from_base)
    if pose is None:
        return None
    map_from_base = pose.map_from_body
    sigma = math.sqrt(float(np.linalg.eigvalsh(pose.covariance[:2, :2])[1]))
    deviation = _SIGMAS_OF_95_PERCENT * sigma
    ratio = max_deviation_meters / sigma
    contradicted = tracker.held_in_a_row >= max_held_in_a_row
    return {
        "x": float(map_from_base[0, 3]),
        "y": float(map_from_base[1, 3]),
        "theta": math.atan2(map_from_base[1, 0], map_from_base[0, 0]),
        "mapId": map_id,
        "localized": deviation <= max_deviation_meters and not contradicted,
        "localizationScore": 0.0 if contradicted else -math.expm1(-0.5 * ratio * ratio),
        "deviationRange": deviation,
    }
