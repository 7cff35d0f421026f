"""One scipy method in a separate process: peer_program.py METHOD POINTS SITES VALUES [UNKNOWNS].

POINTS has rows of x, y and z; VALUES gets the method's results at SITES. All are numpy files. If SITES is a
number, VALUES is a raster with so many cells along each side of the box of the points.
"""

import sys

import numpy as np
from scipy import interpolate

# A compromise between time and error; the complete system of equations does not fit in memory.
NEIGHBOURS = 50
DEGREE = 3


def linear(points, sites, _):
    """Linear interpolation in the Delaunay triangulation."""
    return interpolate.LinearNDInterpolator(points[:, :2], points[:, 2])(sites)


def clough_tocher(points, sites, _):
    return interpolate.CloughTocher2DInterpolator(points[:, :2], points[:, 2])(sites)


def thin_plates(points, sites, _):
    """Thin plates through the nearest points."""
    return interpolate.RBFInterpolator(points[:, :2], points[:, 2], neighbors=NEIGHBOURS)(sites)


def bicubic(points, sites, unknowns):
    """Least squares by tensor-product splines with about `unknowns` coefficients and evenly spaced knots."""
    x, y, z = points.T
    inner = max(round(unknowns**0.5) - DEGREE - 1, 0)
    box = [x.min(), x.max(), y.min(), y.max()]
    knots = [np.linspace(*ends, inner + 2)[1:-1] for ends in (box[:2], box[2:])]
    spline = interpolate.LSQBivariateSpline(x, y, z, *knots, bbox=box, kx=DEGREE, ky=DEGREE)
    if isinstance(sites, int):
        columns, rows = (centres(*ends, sites) for ends in (box[:2], box[2:]))
        return spline(columns, rows).T[::-1]
    return spline(*sites.T, grid=False)


def centres(first, last, count):
    return first + (np.arange(count) + 0.5) / count * (last - first)


METHODS = {"linear": linear, "clough-tocher": clough_tocher, "thin-plates": thin_plates, "bicubic": bicubic}


def main():
    method, points, sites, values, *unknowns = sys.argv[1:]
    sites = int(sites) if sites.isdigit() else np.load(sites)
    points = np.load(points)
    # Far from zero, squares of coordinates lose their digits.
    origin = np.array([*np.floor(points[:, :2].min(0)), 0.0])
    moved = sites if isinstance(sites, int) else sites - origin[:2]
    found = METHODS[method](points - origin, moved, int(unknowns[0]) if unknowns else 0)
    np.save(values, found)


if __name__ == "__main__":
    main()
