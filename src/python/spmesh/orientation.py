"""Exact orientations of triangles and tetrahedra."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import numpy.typing as npt

from .types import Floats

# Coordinates within these limits are multiples of 2^-292. So their differences are zero or between 2^-292 and
# 2^301, and a product of three neither underflows nor overflows.
LEAST, GREATEST = 2.0**-240, 2.0**300
# A determinant of rounded differences is off by at most (3 + 16 e) e times its permanent in the plane, (7 +
# 56 e) e times in space, e = 2^-53 (Shewchuk 1997, "Adaptive precision floating-point arithmetic", section
# 4.3). One e more covers the second order and the rounding of the permanent.
ERROR = {2: 4 * 2.0**-53, 3: 8 * 2.0**-53}


def orientations(points: Floats, simplices: npt.NDArray[np.integer]) -> npt.NDArray[np.int8]:
    """Signs (m,) of simplices (m, d + 1) of finite points (n, d), d = 2 or 3: 1 if counterclockwise, -1 if
    clockwise, 0 if flat.

    In space, 1 stands for det(b - a, c - a, d - a) > 0. Cost: vectorized, but exact fractions for
    near-degenerate simplices.
    """
    dims = points.shape[1]
    corners = np.ascontiguousarray(simplices.T, np.intp)
    columns = [np.ascontiguousarray(points[:, axis]).take(corners) for axis in range(dims)]
    with np.errstate(all="ignore"):
        edges = [column[1:] - column[0] for column in columns]
        determinant, permanent = _determinant(*edges) if dims == 2 else _determinant3(*edges)
        bound = ERROR[dims] * permanent
        signs = (determinant > bound).astype(np.int8) - (determinant < -bound)
    sizes = np.abs(points)
    is_safe = not len(points) or sizes.max() <= GREATEST and ((sizes >= LEAST) | (sizes == 0)).all()
    for number in np.flatnonzero(signs == 0) if is_safe else range(len(simplices)):
        signs[number] = _exact(points[simplices[number]].tolist())
    return signs


def _determinant(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    one, other = x[0] * y[1], x[1] * y[0]
    return one - other, np.abs(one) + np.abs(other)


def _determinant3(x: Floats, y: Floats, z: Floats) -> tuple[Floats, Floats]:
    total, permanent = np.zeros(x.shape[1]), np.zeros(x.shape[1])
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        minor, size = _determinant(x[[i, j]], y[[i, j]])
        total += minor * z[k]
        permanent += size * np.abs(z[k])
    return total, permanent


def _exact(corners: list[list[float]]) -> int:
    rows = [[Fraction(x) for x in corner] for corner in corners]
    edges = [[x - start for x, start in zip(row, rows[0])] for row in rows[1:]]
    if len(edges) == 2:
        (ax, ay), (bx, by) = edges
        determinant = ax * by - ay * bx
    else:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = edges
        determinant = ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)
    return (determinant > 0) - (determinant < 0)
