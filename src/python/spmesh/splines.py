"""Smooth splines: `fit` fits one to scattered points, and `Fit` evaluates it."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, Sequence, cast

import numpy as np

from . import programs
from .arguments import check_finite, points_of
from .options import Owner, Place, flags_of, paths_of
from .raster import Raster, drawn
from .reader import Reader
from .types import ArrayLike, FilePath, Files, Floats
from .whole import Stream, read

KINDS = {None: "value", 0: "value", 1: "gradient", 2: "hessian"}


def fit(xyz: Files, weights: ArrayLike | None = None, *, output: FilePath | None = None, **options: Any) -> Fit:
    """A smooth spline of scattered points (n, 3), by `splinefit fit`: z as a function of x and y.

    `xyz` may also be the path of a file with points, or several. `weights` (n,) are those of points. Options
    are flags of `splinefit fit`: `step=2.0` places knots on a grid, `tol=0.1` where residuals are above it,
    `lambda_="gcv"` smooths (the underscore is left out), `robust="tukey"` bears gross errors, `keep_class=2`
    selects points of files.

    The spline goes to `output`, or to a temporary file that the Fit owns. Raises ProgramError,
    ProgramNotFoundError, and ValueError for arrays that do not fit.

        surface = spmesh.fit(xyz, step=2.0)
        z = surface.evaluate(xy)
    """
    place = Place(output, "spline.spm")
    try:
        with tempfile.TemporaryDirectory(prefix="spmesh-") as folder:
            paths = paths_of(xyz)
            if paths is None:
                paths = [os.path.join(folder, "points.npy")]
                np.save(paths[0], points_of(cast(ArrayLike, xyz), axes=(3,)))
            if weights is not None:
                options["weights"] = Path(folder, "weights.txt")
                np.savetxt(options["weights"], np.asarray(weights, np.float64).reshape(-1), fmt="%.17g")
            command = ["splinefit", "fit", *flags_of(options), *map(programs.argument, paths)]
            programs.run(command, output=place.path)
    except BaseException:
        place.remove()
        raise
    return Fit(place)


class Fit(Owner):
    """A spline in a file: `spmesh.Fit(path)` is that of a file that is there."""

    def read(self) -> Stream:
        """Knots, configurations, functions and coefficients."""
        return read(self.path)

    def evaluate(self, xy: ArrayLike, derivative: int | str | None = None) -> Floats:
        """The spline at sites (n, 2), NaN outside of its domain.

        By default its values (n,). `derivative=1` gives gradients (n, 2), dx and dy; 2 gives Hessians (n, 3),
        dxx, dxy and dyy; "slope", "aspect", "profile-curvature" and "tangential-curvature" numbers (n,).
        Raises ProgramError and ValueError.

            slopes = surface.evaluate(xy, derivative="slope")
        """
        sites = points_of(xy, "xy", (2,))
        kind = derivative if isinstance(derivative, str) else KINDS.get(derivative)
        if kind is None:
            raise ValueError(f"derivative is {derivative!r}, expected 1, 2 or a name")
        if not len(sites):
            columns = {"gradient": (2,), "hessian": (3,)}.get(kind, ())
            return np.empty((0, *columns))
        check_finite(sites, "xy")
        with tempfile.TemporaryDirectory(prefix="spmesh-") as folder:
            source, target = Path(folder, "sites.npy"), Path(folder, "values.npy")
            np.save(source, sites)
            programs.run(["splinefit", "eval", "--at", source, "--kind", kind, "--output", target, self.path])
            values: Floats = np.load(target)
        return values

    def dem(
        self, step: float = 1.0, kind: str = "value", bounds: Sequence[float] | None = None, **options: Any
    ) -> Raster:
        """A raster of the spline: cells at multiples of `step`. `kind` is "value", "slope", "aspect" or a
        curvature.

            surface.dem(step=0.5, kind="profile-curvature").array
        """
        with Reader(self.path) as reader:
            crs = reader.header.crs
        return drawn(["splinefit", "eval", self.path], kind, {"step": step, "bounds": bounds, **options}, crs)
