"""TINs of terrain: `tin` triangulates points, and `Tin` draws rasters and contour lines of them."""

from __future__ import annotations

import gzip
import json
import math
import tempfile
from pathlib import Path
from typing import Any, BinaryIO, Callable, Sequence, cast

import numpy as np

from . import las, programs
from .arguments import check_finite, points_of
from .header import Header
from .meshes import write_points
from .options import Owner, Place, flags_of, paths_of
from .raster import Raster, drawn
from .reader import Reader
from .types import ArrayLike, Columns, FilePath, Files, Floats
from .whole import Stream, read

STEPS = 2.0**31 - 2


def tin(
    files: Files, keep_class: int | Sequence[int] | None = 2, crs: str | None = None,
    bounds: Sequence[float] | None = None, memory: str | int | None = None, *, duplicates: str | None = None,
    attributes: Columns | str | Sequence[str] | None = None, output: FilePath | None = None, **options: Any,
) -> Tin:
    """The Delaunay triangulation of terrain, made by `spfinalize` and `spdelaunay2d` in bounded memory.

    `files` is the path of a file that `spfinalize` reads (LAS, LAZ, COPC, text and others), several paths,
    which make one mesh, or an array (n, 3) of points. Points of LAS files count if they are of the class
    `keep_class`, ground by default; None takes all. `crs` is the coordinate reference system, such as
    "EPSG:2154", if the files do not state it. `bounds` is a box of four or six numbers. `memory` limits what
    points take, such as "512M". Of points that coincide in x and y, `duplicates` keeps the "first", "lowest"
    or "highest". `attributes` are names, or "all"; of an array, columns by name. Other options are flags of
    `spfinalize`: `scale=(0.01, 0.01, 0.01)` is `--scale 0.01,0.01,0.01`, and `first_only=True` is
    `--first-only`.

    The mesh goes to `output`, or to a temporary file that the Tin owns. Raises ProgramError, which has what
    the program says, ProgramNotFoundError, and ValueError for arrays that do not fit.

        terrain = spmesh.tin(["a.laz", "b.laz"])
        elevations = terrain.dem(step=0.5).array
    """
    finalize: dict[str, Any] = dict(crs=crs, bounds=bounds, memory=memory, **options)
    paths = paths_of(files)
    feed: Callable[[BinaryIO], object] | None = None
    if paths is not None:
        finalize |= {"attributes": attributes, "keep_class": keep_class if any(map(_is_las, paths)) else None}
    else:
        points, columns = points_of(cast(ArrayLike, files), "files", (3,)), cast("Columns | None", attributes)
        feed = lambda stdin: write_points(stdin, points, columns)
        finalize["attributes"] = "all" if attributes is not None else None
    place = Place(output, "tin.spm")
    try:
        inputs = map(programs.argument, paths) if paths else ["-"]
        reduce = ["spdelaunay2d", *flags_of({"duplicates": duplicates})]
        programs.run(["spfinalize", *flags_of(finalize), *inputs], reduce, input=feed, output=place.path)
    except BaseException:
        place.remove()
        raise
    return Tin(place)


class Tin(Owner):
    """A triangulation of terrain in a file: `spmesh.Tin(path)` is that of a mesh that is there."""

    @property
    def header(self) -> Header:
        """What the mesh states about itself, such as `bounds`."""
        with Reader(self.path) as reader:
            return reader.header

    @property
    def crs(self) -> str | None:
        """The coordinate reference system as text: WKT, or "EPSG:..." if the mesh has only a code, or
        None.
        """
        return self.header.crs

    def read(self) -> Stream:
        """The vertices and triangles as arrays.

            mesh = terrain.read()
            x, y, z = mesh.xyz.T
        """
        return read(self.path)

    def dem(
        self, step: float | None = 1.0, kind: str = "elevation", bounds: Sequence[float] | None = None, **options: Any
    ) -> Raster:
        """A raster of the TIN, by `spdem`: the value of a cell is that at its centre.

        `step` is the side of cells, in the unit of x and y; their corners are at its multiples. `kind` is
        "elevation", "slope" and "aspect" (degrees), or "hillshade" (1 to 255). `bounds` are x0, y0, x1, y1:
        all by default. Options are flags of `spdem`, such as `concave=30`, `fill=20`, `sample="mean"`,
        `attribute="intensity"` or, without a step, `columns=500`. Raises ProgramError.

            array, transform, crs = terrain.dem(step=0.5, kind="slope")
        """
        if not {"columns", "rows", "like"}.isdisjoint(options):
            step = None
        command = ["spdem", self.path]
        return drawn(command, kind, {"step": step, "bounds": bounds, **options}, options.get("crs", self.crs))

    def contours(self, interval: float, **options: Any) -> list[tuple[float, Floats]]:
        """Contour lines at all multiples of `interval`, by `spdem`: pairs of an elevation and points (k, 2).

        Higher ground is on the left. Closed lines end where they start. Options are flags of `spdem`, such as
        `smooth=True`, `min_length=20` or `contour_base=0.5`. Raises ProgramError.

            for elevation, line in terrain.contours(5):
                plt.plot(*line.T)
        """
        flags = flags_of({"contours": float(interval), "format": "geojsonl", **options})
        found = []
        for text in programs.run(["spdem", self.path, *flags]).splitlines():
            feature = json.loads(text)
            geometry = feature["geometry"]
            lines = [geometry["coordinates"]] if geometry["type"] == "LineString" else geometry["coordinates"]
            found += [(float(feature["properties"]["elevation"]), np.array(line, np.float64)[:, :2]) for line in lines]
        return found

    def heights(self, xyz: ArrayLike, outside: str = "no-data") -> Floats:
        """Heights (n,) of points (n, 3) above the TIN, by `spheight`; of points (n, 2), the elevations of the
        TIN there.

        NaN outside of the mesh, or with `outside="nearest"` the height above its nearest place. Coordinates
        are rounded to the grid of the mesh; if it has none, to 2^-32 of the extent or less. Raises
        ProgramError, and ValueError for points that do not fit that grid or are not finite.

            above = terrain.heights(xyz)
        """
        points = points_of(xyz)
        if not len(points):
            return np.empty(0)
        check_finite(points, "xyz")
        header = self.header
        bounds = header.bounds or _box_of(self.read().xyz)
        is_flat = points.shape[1] == 2
        elevations = np.full(len(points), bounds[2]) if is_flat else points[:, 2]
        sites = np.column_stack([points[:, :2], elevations])
        grid = header if header.scale is not None else _grid_around(sites, bounds)
        with tempfile.TemporaryDirectory(prefix="spmesh-") as folder:
            source, target = Path(folder, "points.las"), Path(folder, "heights.las")
            stored = grid.stored(sites)
            las.write(source, stored, grid.scale or (), grid.offset or ())
            flags = flags_of({"outside": outside})
            programs.run(["spheight", "--ground", self.path, *flags, source, "--output", target])
            found = las.heights(target)
        # The program measured from the rounded elevation.
        rounded = grid.world(stored)[:, 2]
        return rounded - found if is_flat else found + (points[:, 2] - rounded)

    def audit(self, points: FilePath | None = None) -> dict[str, Any]:
        """Proves with exact arithmetic that the mesh is the canonical Delaunay triangulation, by `spinfo
        --audit`.

        With `points`, a file, also that these are its points. Returns what the program reports, as a
        dictionary. Raises ProgramError with code 4 and the first violation if the mesh is not that.

            terrain.audit()
        """
        command: programs.Command = ["spinfo", "--json", "--audit", *flags_of({"points": points}), self.path]
        report: dict[str, Any] = json.loads(programs.run(command))
        return report


def _box_of(xyz: Floats) -> list[float]:
    return [*xyz.min(axis=0).tolist(), *xyz.max(axis=0).tolist()] if len(xyz) else [0.0] * 6


def _is_las(path: str) -> bool:
    """Whether a file is LAS, LAZ or COPC, and so has classes."""
    try:
        with open(path, "rb") as file:
            start = file.read(4)
        if start[:2] == b"\x1f\x8b":
            with gzip.open(path) as packed:
                start = packed.read(4)
    except (OSError, EOFError):
        # The program says what is wrong.
        return False
    return start == b"LASF"


def _grid_around(sites: Floats, bounds: Sequence[float]) -> Header:
    """A grid of 32 bits for sites, and for heights above what lies in the bounds."""
    low = np.minimum(sites.min(axis=0), bounds[:3])
    extent = np.maximum(sites.max(axis=0), bounds[3:]) - low
    # Powers of two, so that steps add no rounding of their own. Twice the extent, for heights of both signs.
    exponents = [math.ceil(math.log2(max(float(side), 2.0**-200) / STEPS)) + 1 for side in extent]
    scale = tuple(2.0**exponent for exponent in exponents)
    return Header("points", 3, False, (scale[0], scale[1], scale[2]), tuple(low.tolist()))
