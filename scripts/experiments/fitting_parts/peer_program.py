"""One method of scipy or pykrige in a separate process: peer_program.py METHOD POINTS SITES VALUES [UNKNOWNS].

POINTS has rows of x, y and z; VALUES gets the method's results at SITES. All are numpy files. If SITES is a
number, VALUES is a raster with so many cells along each side of the box of the points.
"""

import sys

import numpy as np
from scipy import interpolate

# A compromise between time and error; the complete system of equations does not fit in memory.
NEIGHBOURS = 50
DEGREE = 3
# Points that the variogram is fitted to, classes of distance, and sites that are kriged together.
SEED, SAMPLE, LAGS, SITES_MAX = 1, 3_000, 30, 400


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


def kriging(model):
    """Ordinary kriging with a variogram model, from the nearest points."""

    def values(points, sites, _):
        from pykrige.ok import OrdinaryKriging
        from scipy.spatial import cKDTree

        tree, found = cKDTree(points[:, :2]), np.empty(len(sites))
        chosen = points[np.random.default_rng(SEED).permutation(len(points))[:SAMPLE]]
        kriged = OrdinaryKriging(*chosen.T, variogram_model=model, nlags=LAGS, weight=True)
        for group in groups(sites):
            # pykrige makes a full matrix of all points that it has.
            near = points[np.unique(tree.query(sites[group], NEIGHBOURS)[1])]
            kriged.X_ADJUSTED, kriged.Y_ADJUSTED, kriged.Z = near.T
            near_values = kriged.execute("points", *sites[group].T, backend="loop", n_closest_points=NEIGHBOURS)
            found[group] = near_values[0]
        return found

    return values


def groups(sites):
    """Numbers of sites that are close to each other: halves along the longer side, again and again."""
    waiting = [np.arange(len(sites))]
    while waiting:
        group = waiting.pop()
        if len(group) <= SITES_MAX:
            yield group
            continue
        axis = np.argmax(np.ptp(sites[group], axis=0))
        group = group[np.argsort(sites[group, axis])]
        waiting += [group[: len(group) // 2], group[len(group) // 2 :]]


def centres(first, last, count):
    return first + (np.arange(count) + 0.5) / count * (last - first)


METHODS = {"linear": linear, "clough-tocher": clough_tocher, "thin-plates": thin_plates, "bicubic": bicubic}
METHODS |= {f"kriging-{model}": kriging(model) for model in ("linear", "power", "spherical", "exponential")}


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
