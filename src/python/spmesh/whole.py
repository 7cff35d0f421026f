"""Whole streams as arrays in memory."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from . import blocks as b
from .header import Header
from .joined import Join, is_manifest
from .reader import Reader
from .types import File, Integers, Floats, Masked


@dataclass
class Stream:
    """All that a stream holds. Arrays that its kind does not have are empty (`simplices`, `rows`) or None
    (others).

    `stored` (n, axes): points, vertices or knots in stored coordinates, `xyz` the same in the world.
    `simplices` (m, corners): triangles or tetrahedra as indices of vertices, int32 if they fit, else int64.
    `rows` (n,): structured array of attributes, without fields if there are none. Of a constrained mesh:
    `segment_lines` (k,) and `segment_ends` (k, 2, 2), stored; `sides` (m, corners) int64: for each triangle
    the segments opposite to its corners, or -1; `open_segments`, numbers of segments that leave the mesh. Of
    points in regions: `regions`; points come region by region, those of several regions several times.
    """

    header: Header
    stored: np.ndarray
    simplices: Integers
    rows: np.ndarray
    labels: np.ndarray | None = None
    residual: b.ResidualPoints | None = None
    walls: np.ndarray | None = None
    values: np.ndarray | None = None
    cells4: b.Cells4 | None = None
    configurations: list[b.Configurations] = field(default_factory=list)
    functions: list[b.Function] = field(default_factory=list)
    regions: list[b.Region] = field(default_factory=list)
    coefficients: np.ndarray | None = None
    segment_lines: np.ndarray | None = None
    segment_ends: np.ndarray | None = None
    sides: np.ndarray | None = None
    open_segments: np.ndarray | None = None
    totals: dict[str, int] = field(default_factory=dict)

    @property
    def xyz(self) -> Floats:
        """World coordinates (n, axes)."""
        return self.header.world(self.stored)

    def attribute(self, name: str) -> Masked:
        """The values of an attribute, with scale and offset applied and unknown values masked."""
        attribute = next((a for a in self.header.attributes if a.name == name), None)
        if attribute is None:
            names = ", ".join(a.name for a in self.header.attributes) or "none"
            raise KeyError(f"no attribute {name!r}: there are {names}")
        return attribute.values(self.rows[name])


def read(file: File, memory: bool = True) -> Stream:
    """Reads a whole stream from a path or a binary file, with all checks (see `Reader`).

    The path may be that of the manifest of a mesh in parts: the result is then the joined mesh. Raises
    MalformedError, TooNewError, UpstreamError if the program failed that writes the file, a pipe, and
    OSError.

        mesh = spmesh.read("terrain.spm")
        corners = mesh.xyz[mesh.simplices]          # (m, 3, axes)
    """
    if is_manifest(file):
        whole = Join(file).read(memory)
        rows = np.empty(len(whole.stored), []) if whole.rows is None else whole.rows
        simplices = _indices(whole.simplices, len(whole.stored))
        return Stream(whole.header, whole.stored, simplices, rows, totals=whole.totals)
    with Reader(file, memory) as reader:
        parts = _Parts()
        for block in reader:
            parts.add(block)
        return parts.stream(reader.header)


class _Parts:
    """Blocks until they are joined."""

    def __init__(self) -> None:
        self.arrays: dict[str, list[np.ndarray]] = {}
        self.residual: list[b.ResidualPoints] = []
        self.cells4: list[b.Cells4] = []
        self.configurations: list[b.Configurations] = []
        self.functions: list[b.Function] = []
        self.regions: list[b.Region] = []
        self.totals: dict[str, int] = {}

    def put(self, name: str, part: np.ndarray | None) -> None:
        if part is not None:
            self.arrays.setdefault(name, []).append(part)

    def add(self, block: b.Block) -> None:
        if isinstance(block, b.Points):
            self.put("stored", block.xyz)
            self.put("rows", block.rows)
        elif isinstance(block, b.Patch):
            self.put("stored", block.new)
            self.put("rows", block.rows)
            self.put("simplices", block.simplices_by_id)
            self.put("sides", _sides(block))
        elif isinstance(block, b.Segments):
            self.put("segment_lines", block.lines)
            self.put("segment_ends", block.ends)
        elif isinstance(block, b.Points4):
            self.put("stored", block.xyzt)
            self.put("values", block.values)
        elif isinstance(block, b.OpenSegments):
            self.put("open_segments", block.numbers)
        elif isinstance(block, b.Labels):
            self.put("labels", block.labels)
        elif isinstance(block, b.Walls):
            self.put("walls", block.corners)
        elif isinstance(block, b.Simplices4):
            self.put("simplices", block.corners)
        elif isinstance(block, b.Coefficients):
            self.put("coefficients", block.values)
        elif isinstance(block, b.Region):
            self.regions.append(block)
        elif isinstance(block, b.ResidualPoints):
            self.residual.append(block)
        elif isinstance(block, b.Cells4):
            self.cells4.append(block)
        elif isinstance(block, b.Configurations):
            self.configurations.append(block)
        elif isinstance(block, b.Functions):
            self.functions += block.functions
        elif isinstance(block, b.End):
            self.totals = block.totals

    def joined(self, name: str) -> np.ndarray | None:
        parts = self.arrays.pop(name, [])
        return np.concatenate(parts) if parts else None

    def stream(self, header: Header) -> Stream:
        """The arrays of all blocks. The parts of each are dropped when they are joined."""
        stored, rows, simplices = self.joined("stored"), self.joined("rows"), self.joined("simplices")
        if stored is None:
            stored = np.empty((0, 4 if header.dims == 4 else header.axes), header.dtype)
        if rows is None:
            rows = np.empty(len(stored) if not header.attributes else 0, header.row_dtype)
        if simplices is None:
            simplices = np.empty((0, header.corners), np.int32)
        sides = self.joined("sides") if header.constrained is not None else None
        return Stream(
            header, stored, _indices(simplices, len(stored)), rows, sides=sides, totals=self.totals,
            residual=self._residual(), cells4=self._cells4(), configurations=self.configurations,
            functions=self.functions, regions=self.regions,
            labels=self.joined("labels"), walls=self.joined("walls"), values=self.joined("values"),
            coefficients=self.joined("coefficients"), segment_lines=self.joined("segment_lines"),
            segment_ends=self.joined("segment_ends"), open_segments=self.joined("open_segments"),
        )

    def _residual(self) -> b.ResidualPoints | None:
        if not self.residual:
            return None
        rows = [part.rows for part in self.residual if part.rows is not None]
        return b.ResidualPoints(
            np.concatenate([part.ids for part in self.residual]), np.concatenate([part.xyz for part in self.residual]),
            np.concatenate(rows) if rows else None,
        )

    def _cells4(self) -> b.Cells4 | None:
        if not self.cells4:
            return None
        vertices = [v for cells in self.cells4 for v in cells.vertices]
        neighbours = [n for cells in self.cells4 for n in cells.neighbours]
        return b.Cells4(np.concatenate([cells.infinite for cells in self.cells4]), vertices, neighbours)


def _indices(simplices: np.ndarray, count: int) -> Integers:
    """As int32 if the numbers of vertices fit, else as int64: numpy makes floats of sums of unsigned and
    signed integers.
    """
    return simplices.astype(np.int32 if count <= 2**31 else np.int64, copy=False)


def _sides(patch: b.Patch) -> np.ndarray:
    """For each triangle the segments opposite to its corners, or -1."""
    sides = np.full((len(patch.simplices), 3), -1, np.int64)
    triangle, place, segment = patch.sides.T
    sides[triangle, place] = segment
    return sides
