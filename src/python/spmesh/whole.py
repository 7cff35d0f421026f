"""Whole streams as arrays in memory."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from . import blocks as b
from .header import TYPES, Attribute, Header
from .joined import Join, is_manifest
from .reader import Reader
from .writer import Writer


@dataclass
class Stream:
    """All that a stream holds. Arrays that its kind does not have are None.

    `stored` (n, axes): points, vertices or knots in stored coordinates, `xyz` the same in the world. `simplices` (m,
    corners): triangles or tetrahedra as indices of vertices. `rows` (n,): structured array of attributes.
    Of a constrained mesh: `segment_lines` (k,) and `segment_ends` (k, 2, 2), stored; `sides` (m, corners) int64: for each
    triangle the segments opposite to its corners, or -1; `open_segments`, numbers of segments that leave the mesh.
    Of points in regions: `regions`; points come region by region, those of several regions several times.
    """

    header: Header
    stored: np.ndarray
    simplices: np.ndarray | None = None
    rows: np.ndarray | None = None
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
    def xyz(self) -> np.ndarray:
        """World coordinates (n, axes)."""
        return self.header.world(self.stored)

    def attribute(self, name: str) -> np.ma.MaskedArray:
        """The values of an attribute, with scale and offset applied and unknown values masked."""
        attribute = next((a for a in self.header.attributes if a.name == name), None)
        if attribute is None:
            names = ", ".join(a.name for a in self.header.attributes) or "none"
            raise KeyError(f"no attribute {name!r}: there are {names}")
        return attribute.values(self.rows[name])


def read(file, memory: bool = True) -> Stream:
    """Reads a whole stream from a path or a binary file, with all checks (see `Reader`).

    The path may be that of the manifest of a mesh in parts: the result is then the joined mesh.
    """
    if is_manifest(file):
        whole = Join(file).read(memory)
        return Stream(whole.header, whole.stored, whole.simplices.astype(np.int64), whole.rows, totals=whole.totals)
    with Reader(file, memory) as reader:
        header, parts = reader.header, {}
        configurations, functions, regions, totals = [], [], [], {}
        put = lambda name, part: parts.setdefault(name, []).append(part)
        for block in reader:
            if isinstance(block, b.Points):
                put("stored", block.xyz)
                put("rows", block.rows)
            elif isinstance(block, b.Region):
                regions.append(block)
            elif isinstance(block, b.Patch):
                put("stored", block.new)
                put("rows", block.rows)
                put("simplices", block.simplices_by_id)
                if header.constrained is not None:
                    put("sides", _sides(block))
            elif isinstance(block, b.Segments):
                put("segment_lines", block.lines)
                put("segment_ends", block.ends)
            elif isinstance(block, b.ResidualPoints):
                put("residual", block)
            elif isinstance(block, b.Points4):
                put("stored", block.xyzt)
                put("values", block.values)
            elif isinstance(block, b.Cells4):
                put("cells4", block)
            elif isinstance(block, b.Configurations):
                configurations.append(block)
            elif isinstance(block, b.Functions):
                functions += block.functions
            elif isinstance(block, b.End):
                totals = block.totals
            else:
                put(*_ARRAYS[type(block)](block))
    arrays = {name: _joined(parts.get(name, [])) for name in _NAMES}
    axes = 4 if header.dims == 4 else header.axes
    stored = _joined(parts.get("stored", []))
    stored = np.empty((0, axes), header.dtype) if stored is None else stored
    if header.attributes and arrays["rows"] is None:
        arrays["rows"] = np.empty(0, header.row_dtype)
    if arrays["simplices"] is None and header.has_patches:
        arrays["simplices"] = np.empty((0, header.corners), np.uint64)
    if header.has_patches:
        # numpy makes floats of sums of unsigned and signed integers.
        arrays["simplices"] = arrays["simplices"].astype(np.int64, copy=False)
    residual, cells4 = parts.get("residual"), parts.get("cells4")
    return Stream(
        header, stored, **arrays, totals=totals, configurations=configurations, functions=functions,
        regions=regions,
        residual=residual and b.ResidualPoints(*(_joined([getattr(p, n) for p in residual]) for n in ("ids", "xyz", "rows"))),
        cells4=cells4 and b.Cells4(
            np.concatenate([c.infinite for c in cells4]),
            [v for c in cells4 for v in c.vertices], [n for c in cells4 for n in c.neighbours],
        ),
    )


_NAMES = (
    "rows", "simplices", "labels", "walls", "values", "coefficients", "segment_lines", "segment_ends", "sides",
    "open_segments",
)
_ARRAYS = {
    b.OpenSegments: lambda block: ("open_segments", block.numbers),
    b.Cells: lambda block: ("codes", block.codes),
    b.Labels: lambda block: ("labels", block.labels),
    b.Walls: lambda block: ("walls", block.corners),
    b.Simplices4: lambda block: ("simplices", block.corners),
    b.Coefficients: lambda block: ("coefficients", block.values),
}


def _sides(patch: b.Patch) -> np.ndarray:
    """For each triangle the segments opposite to its corners, or -1."""
    sides = np.full((len(patch.simplices), 3), -1, np.int64)
    triangle, place, segment = patch.sides.T
    sides[triangle, place] = segment
    return sides


def _joined(parts: list) -> np.ndarray | None:
    parts = [part for part in parts if part is not None]
    return np.concatenate(parts) if parts else None


def attributes_of(columns: dict[str, np.ndarray]) -> list[Attribute]:
    """A list of attributes for columns: arrays (n,) or (n, components) by name.

    Masked values are written as a number that does not occur in the column, which the list states.
    """
    found = []
    for name, column in _columns(columns).items():
        column = np.ma.asanyarray(column)
        if column.ndim not in (1, 2):
            raise ValueError(f"attribute {name!r} has the shape {column.shape}, expected (n,) or (n, components)")
        components = 1 if column.ndim == 1 else column.shape[1]
        dtype = np.dtype("u1") if column.dtype == bool else column.dtype
        if dtype.newbyteorder("<") not in [np.dtype(known) for known in TYPES]:
            raise ValueError(f"attribute {name!r} has the type {dtype}, expected one of {', '.join(TYPES)}")
        unknown = _free_number(name, column, dtype) if np.ma.getmaskarray(column).any() else None
        found.append(Attribute(name, dtype, components, unknown=unknown))
    return found


def _columns(columns) -> dict[str, np.ndarray]:
    """Columns by name, of a dictionary or of a structured array such as `Stream.rows`."""
    return columns if isinstance(columns, dict) else {name: columns[name] for name in columns.dtype.names}


def _free_number(name: str, column: np.ma.MaskedArray, dtype: np.dtype) -> bytes:
    """The bytes of a number that is no value of the column: NaN, or the greatest or least integer that is free."""
    if dtype.kind == "f":
        return np.array(np.nan, dtype.newbyteorder("<")).tobytes()
    values = np.unique(column.compressed())
    for step in range(len(values) + 1):
        for number in (np.iinfo(dtype).max - step, np.iinfo(dtype).min + step):
            if np.iinfo(dtype).min <= number <= np.iinfo(dtype).max and number not in values:
                return np.array(number, dtype.newbyteorder("<")).tobytes()
    raise ValueError(f"attribute {name!r} has masked values, and no number of its type is free to stand for them")


def _filled(columns: dict[str, np.ndarray], attributes: list[Attribute]) -> dict[str, np.ndarray]:
    """The columns with the stated number in place of masked values."""
    stated = {a.name: a for a in attributes}
    filled = {}
    for name, column in _columns(columns).items():
        unknown = stated[name].unknown
        if unknown is not None:
            column = np.ma.asanyarray(column).astype(stated[name].dtype)
            column = column.filled(np.frombuffer(unknown, stated[name].dtype)[0])
        filled[name] = np.asarray(column)
    return filled


def write_points(file, xyz, attributes=None, scale=None, offset=(0.0, 0.0, 0.0), dims: int = 2, wkt=None) -> None:
    """Writes points (n, 2) or (n, 3) of the world as a stream that `spfinalize` reads.

    With `scale` (one number, or one per axis) they are rounded to a grid of 32-bit integers. `dims` is 2 if z is an
    elevation, 3 if it is geometry. `attributes` are columns by name: arrays (n,) or (n, components).
    """
    xyz = np.asarray(xyz)
    if scale is not None:
        scale = tuple(np.broadcast_to(np.asarray(scale, float), 3).tolist())
    header = Header(
        "points", dims, xyz.shape[1] > dims, scale, tuple(map(float, offset)) if scale else None,
        points=len(xyz), wkt=wkt, attributes=attributes_of({} if attributes is None else attributes),
    )
    with Writer(file, _bounded(header, xyz)) as writer:
        writer.points(xyz, None if attributes is None else _filled(attributes, header.attributes))


def _bounded(header: Header, xyz: np.ndarray) -> Header:
    """The header with the box of these points, so that programs need not be told where they are."""
    if len(xyz) and np.isfinite(xyz).all():
        low, high = header.stored(np.array([xyz.min(axis=0), xyz.max(axis=0)])).tolist()
        flat = [0] * (3 - len(low))
        header.bounds = (*low, *flat, *high, *flat)
    return header


def _indices(triangles) -> np.ndarray:
    """Triangles as whole numbers (m, 3), each with three vertices."""
    triangles = np.asarray(triangles)
    whole = triangles.astype(np.int64).reshape(-1, 3)
    if triangles.dtype.kind == "f" and not np.array_equal(whole, triangles.reshape(-1, 3)):
        raise ValueError("a triangle has an index that is no whole number")
    a, b, c = whole.T
    if ((a == b) | (b == c) | (c == a)).any():
        raise ValueError("a triangle uses a vertex twice")
    return whole


def write_triangles(file, xyz, triangles, attributes=None, scale=None, offset=(0.0, 0.0, 0.0), wkt=None) -> None:
    """Writes a triangle mesh: vertices (n, 2) or (n, 3) of the world, triangles (m, 3) counterclockwise as indices.

    Vertices are written with their first triangle and finalized with their last, so triangles that are in a spatial
    order make a stream that needs little memory.
    """
    xyz, triangles = np.asarray(xyz), _indices(triangles)
    if triangles.size and not (0 <= triangles.min() and triangles.max() < len(xyz)):
        raise ValueError(f"a triangle uses a vertex beyond the {len(xyz)} given")
    if scale is not None:
        scale = tuple(np.broadcast_to(np.asarray(scale, float), 3).tolist())
    header = Header(
        "triangle mesh", 2, xyz.shape[1] > 2, scale, tuple(map(float, offset)) if scale else None,
        wkt=wkt, attributes=attributes_of({} if attributes is None else attributes),
    )
    step = 4096
    corners, places = triangles.ravel(), np.arange(triangles.size)
    # Of several assignments to one element the last one counts.
    first, last = np.full(len(xyz), triangles.size), np.full(len(xyz), -1)
    first[corners[::-1]] = places[::-1]
    last[corners] = places // (3 * step)
    # Vertices get ids in the order of their first use; unused ones come at the end.
    order = np.argsort(first, kind="stable")
    unused = int((first == triangles.size).sum())
    ids = np.empty(len(xyz), np.int64)
    ids[order] = np.arange(len(xyz))
    columns = _filled({} if attributes is None else attributes, header.attributes)
    pick = lambda chosen: {name: column[chosen] for name, column in columns.items()} if columns else None
    with Writer(file, _bounded(header, xyz)) as writer:
        written = 0
        for number, at in enumerate(range(0, len(triangles), step)):
            part = ids[triangles[at : at + step]]
            found = np.unique(part)
            new, imported = found[found >= written], found[found < written]
            local = np.concatenate([new, imported])
            indices = np.empty(len(xyz), np.int64) if number == 0 else indices
            indices[local] = np.arange(len(local))
            final = np.flatnonzero(last[order[local]] == number)
            writer.patch(xyz[order[new]], imported, indices[part], final, pick(order[new]))
            written += len(new)
        assert written + unused == len(xyz)
        for at in range(written, len(xyz), step):
            alone = order[at : at + step]
            writer.patch(xyz[alone], (), (), np.arange(len(alone)), pick(alone))
