"""Numpy arrays as inputs: checked, copied, and read-only from then on."""

from typing import Any

import numpy as np
import numpy.typing as npt

from maploc.errors import invalid

Floats = npt.NDArray[np.float64]
LARGEST_METERS = 1e9  # of a coordinate: beyond it a double has no millimetres


def is_number(value: Any) -> bool:
    """NumPy's too; a bool is none."""
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def is_whole(value: Any) -> bool:
    """NumPy's too; a bool is none."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def numbers(
    field: str, values: npt.ArrayLike, shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64
) -> npt.NDArray[Any]:
    """`values` as an array of `shape`, where -1 stands for any length, all finite."""
    try:
        array = np.array(values, dtype=dtype, order="C")
    except (TypeError, ValueError) as error:
        invalid(field, f"is no array of numbers ({error})")
    if array.size == 0 and shape[:1] == (-1,):
        array = array.reshape((0,) + shape[1:])
    if array.ndim != len(shape) or any(want not in (-1, have) for want, have in zip(shape, array.shape)):
        wanted = " x ".join("N" if side == -1 else str(side) for side in shape)
        invalid(field, f"has the shape {array.shape}, but must be {wanted}", "COUNT_MISMATCH")
    if not np.isfinite(array).all():
        invalid(field, "must be finite", "NOT_FINITE")
    array.flags.writeable = False
    return array


def rotation(field: str, matrix: npt.ArrayLike) -> Floats:
    """A 3 x 3 rotation: orthonormal within 1e-3, right-handed."""
    array = numbers(field, matrix, (3, 3))
    if not np.allclose(array @ array.T, np.eye(3), atol=1e-3) or np.linalg.det(array) < 0:
        invalid(field, "is no rotation (orthonormal and right-handed)", "NOT_A_ROTATION")
    return array


def rigid_transform(field: str, matrix: npt.ArrayLike) -> Floats:
    """A 4 x 4 rigid transform target_from_source, last row 0 0 0 1."""
    array = numbers(field, matrix, (4, 4))
    rotation(field, array[:3, :3])
    if not np.array_equal(array[3], [0, 0, 0, 1]):
        invalid(field, "is no rigid transform; its last row must be 0 0 0 1", "NOT_RIGID")
    return array


def quaternion_from_matrix(matrix: Floats) -> Floats:
    """x, y, z, w (Hamilton) of a 3 x 3 rotation, unit length."""
    # Each row is 4 * q * q[i]: the row of the largest component is the best conditioned one.
    m = matrix
    trace = float(np.trace(m))
    rows = np.empty((4, 4))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        rows[i, i] = 1 + 2 * m[i, i] - trace
        rows[i, j], rows[i, k] = m[i, j] + m[j, i], m[i, k] + m[k, i]
        rows[i, 3] = m[k, j] - m[j, k]
    rows[3] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1 + trace
    best: Floats = rows[np.argmax(np.diag(rows))]
    unit: Floats = best / np.linalg.norm(best)
    return unit


def matrix_from_quaternion(xyzw: Floats) -> Floats:
    """The 3 x 3 rotation of a unit quaternion x, y, z, w (Hamilton)."""
    v, w = xyzw[:3], xyzw[3]
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    matrix: Floats = np.eye(3) + 2 * (w * cross + cross @ cross)
    return matrix
