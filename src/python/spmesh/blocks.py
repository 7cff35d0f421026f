"""What the blocks of a stream hold, as numpy arrays. Coordinates are stored ones (see `Header.world`)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Union

import numpy as np
import numpy.typing as npt

NOT_A_VERTEX = 2**64 - 1
FARAWAY = 2**32 - 1
ORIGIN = np.dtype([("local", "<u4"), ("id", "<u8")])
TOTALS = ("points", "cells", "vertices", "simplices", "merged", "residual", "walls")


@dataclass
class Points:
    """`xyz` (n, axes); `rows` (n,) structured, or None without attributes."""

    xyz: np.ndarray
    rows: np.ndarray | None = None


@dataclass
class Cells:
    """Location codes (n,) uint64 of cells that are final."""

    codes: np.ndarray


@dataclass
class Region:
    """A region, whose points follow: first those that no other region has (`own`), then those that later regions have,
    too, and no earlier one (`first`), then those that earlier and later ones have (`again`), then those of earlier ones
    only (`last`). `bounds` are the three lower and the three upper sides of its half-open box."""

    bounds: tuple[float, ...]
    own: int = 0
    first: int = 0
    again: int = 0
    last: int = 0

    @property
    def points(self) -> int:
        """Points of the region, those of other regions included."""
        return self.own + self.first + self.again + self.last


@dataclass
class Patch:
    """A piece of a mesh. Local indices count `new` vertices first, then `imported` ones."""

    first_id: int
    new: np.ndarray
    imported: np.ndarray
    simplices: np.ndarray
    finalized: np.ndarray
    rows: np.ndarray | None = None
    # Of a constrained mesh, (n, 3) uint32: triangle, the corner opposite to the side, segment.
    sides: np.ndarray = field(default_factory=lambda: np.empty((0, 3), np.uint32))
    # Of a part of a mesh, structured (n,): new vertices that other parts have, as `local` index and global `id`.
    origins: np.ndarray = field(default_factory=lambda: np.empty(0, ORIGIN))
    # Of a part of a mesh, (n,) uint32: finalized local vertices that later parts may use.
    kept: np.ndarray = field(default_factory=lambda: np.empty(0, np.uint32))

    @property
    def ids(self) -> npt.NDArray[np.int64]:
        """Ids (n,) int64 of the local vertices."""
        own = np.arange(self.first_id, self.first_id + len(self.new), dtype=np.int64)
        return np.concatenate([own, self.imported.astype(np.int64)])

    @property
    def simplices_by_id(self) -> npt.NDArray[np.int64]:
        """Simplices (m, corners) as ids of vertices of the whole stream."""
        simplices: npt.NDArray[np.int64] = self.ids[self.simplices]
        return simplices


@dataclass
class Segments:
    """Segments of a constrained mesh: `lines` (n,) uint32, numbers of lines; `ends` (n, 2, 2), x and y of both ends."""

    lines: np.ndarray
    ends: np.ndarray


@dataclass
class OpenSegments:
    """Numbers (n,) uint32 of segments that leave the mesh."""

    numbers: np.ndarray


@dataclass
class Labels:
    """Labels (n,) uint64 of the next vertices without one."""

    labels: np.ndarray


@dataclass
class ResidualPoints:
    """`ids` (n,) uint64, 2^64 - 1 for points that are no vertices yet; `xyz` (n, axes).

    In a residual of its own, ids are global ids.
    """

    ids: np.ndarray
    xyz: np.ndarray
    rows: np.ndarray | None = None


@dataclass
class Walls:
    """Numbers (n, dims) uint32 of residual points."""

    corners: np.ndarray


@dataclass
class Points4:
    """`xyzt` (n, 4) and `values` (n,), NaN if unknown, or None."""

    xyzt: np.ndarray
    values: np.ndarray | None = None


@dataclass
class Cells4:
    """Cells that a block completes: `infinite` (n,) bool, lists of vertices and of neighbours."""

    infinite: np.ndarray
    vertices: list[np.ndarray]
    neighbours: list[np.ndarray]


@dataclass
class Simplices4:
    """Numbers (n, 5) uint32 of points."""

    corners: np.ndarray


@dataclass
class Configurations:
    """Groups of one degree: `interiors` (g, degree), `counts` (g,), `boundaries` (n, 3), FARAWAY for the faraway point."""

    degree: int
    standing: int
    interiors: np.ndarray
    counts: np.ndarray
    boundaries: np.ndarray


@dataclass
class Function:
    """A function of splines: its kind, its knots, and terms of two knots and a factor."""

    kind: str
    knots: tuple[int, ...]
    terms: list[tuple[int, int, float]]


@dataclass
class Functions:
    functions: list[Function]


@dataclass
class Coefficients:
    values: np.ndarray


@dataclass
class End:
    """Totals by name: points, cells, vertices, simplices, merged, residual, walls."""

    totals: dict[str, int] = field(default_factory=dict)


Block = Union[
    Points, Cells, Region, Patch, Segments, OpenSegments, Labels, ResidualPoints, Walls, Points4, Cells4, Simplices4,
    Configurations, Functions, Coefficients, End,
]
