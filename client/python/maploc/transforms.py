"""Rigid transforms, 4 x 4 target_from_source, and their small errors. Only for odometry."""

import math

import numpy as np

from maploc.arrays import Floats, quaternion_from_matrix


def inverse(b_from_a: Floats) -> Floats:
    """a_from_b."""
    a_from_b = np.eye(4)
    a_from_b[:3, :3] = b_from_a[:3, :3].T
    a_from_b[:3, 3] = -b_from_a[:3, :3].T @ b_from_a[:3, 3]
    return a_from_b


def cross_matrix(v: Floats) -> Floats:
    """cross_matrix(v) @ w = v x w."""
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def moving_jacobian(travel_in_map: Floats) -> Floats:
    """What errors of a pose become at a place that lies so far from it."""
    jacobian = np.eye(6)
    jacobian[:3, 3:] = -cross_matrix(travel_in_map)
    return jacobian


def rotation_vector(matrix: Floats) -> Floats:
    """Axis times angle of a 3 x 3 rotation, in radians, at most pi long."""
    xyzw = quaternion_from_matrix(matrix)
    xyzw = -xyzw if xyzw[3] < 0 else xyzw  # the shorter way round
    sine = float(np.linalg.norm(xyzw[:3]))
    scale = 2.0 if sine < 1e-12 else 2 * math.atan2(sine, xyzw[3]) / sine
    vector: Floats = scale * xyzw[:3]
    return vector


def difference(to: Floats, start: Floats) -> Floats:
    """What takes `start` to `to`, in the order and the axes of a covariance."""
    return np.concatenate([to[:3, 3] - start[:3, 3], rotation_vector(to[:3, :3] @ start[:3, :3].T)])


def plus(pose: Floats, step: Floats) -> Floats:
    """The inverse: difference(plus(pose, step), pose) = step for rotations below pi."""
    angle = float(np.linalg.norm(step[3:]))
    axis = cross_matrix(step[3:] / angle if angle > 0 else step[3:])
    result = np.eye(4)
    turn = np.eye(3) + math.sin(angle) * axis + (1 - math.cos(angle)) * axis @ axis
    result[:3, :3] = turn @ pose[:3, :3]
    result[:3, 3] = pose[:3, 3] + step[:3]
    return result
