"""Rasters as arrays."""

from __future__ import annotations

import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, Sequence

import numpy as np
import numpy.typing as npt

from . import geotiff, programs
from .options import flags_of

Transform = tuple[float, float, float, float, float, float]


class Raster(NamedTuple):
    """Cells, where they are, and the coordinate reference system.

    `array` (rows, columns) float32, the first row in the north, NaN where there are no data. `transform` are
    six numbers in rasterio's order: the corner of the cell at (row, column) is x = a * column + c, y = e *
    row + f, for a, b, c, d, e, f. `crs` is text that rasterio and pyproj take: WKT, or "EPSG:..." if the
    source states only a code, or None.
    """

    array: npt.NDArray[np.float32]
    transform: Transform
    crs: str | None

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The box of the cells: x0, y0, x1, y1."""
        a, _, left, _, e, top = self.transform
        rows, columns = self.array.shape
        return left, top + e * rows, left + a * columns, top

    def to_xarray(self) -> Any:
        """The raster as xarray.DataArray with coordinates x and y of the centres of cells. Raises ImportError
        without xarray.

            tin.dem(step=1).to_xarray().plot()
        """
        xarray = import_module("xarray")
        a, _, left, _, e, top = self.transform
        rows, columns = self.array.shape
        coordinates = {"y": top + e * (np.arange(rows) + 0.5), "x": left + a * (np.arange(columns) + 0.5)}
        attributes = {"transform": self.transform, "crs": self.crs or ""}
        return xarray.DataArray(self.array, coordinates, ("y", "x"), attrs=attributes)


def drawn(command: Sequence[Any], kind: str, options: dict[str, Any], crs: str | None) -> Raster:
    """The raster that a command writes, given its flags but for the output."""
    if "output" in options or "tiles" in options or kind == "shaded-relief":
        advice = "run spdem with spmesh.programs.run"
        raise ValueError(f"several rasters, files and pictures in colour are no array: {advice}")
    # Hillshades are bytes, for which 0 stands for no data.
    no_data = {} if kind == "hillshade" else {"no_data": "nan"}
    with tempfile.TemporaryDirectory(prefix="spmesh-") as folder:
        path = Path(folder, "raster.tif")
        programs.run([*command, *flags_of({"kind": kind, **no_data, **options}), "--output", path])
        return Raster(*geotiff.read(path), crs)
