"""Writes streams. END is written only when everything before it was."""

from __future__ import annotations

import os
import struct
from typing import BinaryIO, Iterable, Mapping, Sequence, cast

import numpy as np

from .blocks import NOT_A_VERTEX, TOTALS, Function, OpenSegments, Patch, Region, Segments
from .checksum import crc32c
from .constraints import Constraints, segment_dtype
from .header import KINDS, CODES, Header
from .output import OutputFile
from .parts import check_shared, origins_of
from .regions import Regions, payload_of
from .splines_reader import KNOTS_OF
from .types import ArrayLike, Columns, File

PAYLOAD_MAX = 2**20
POINTS_PAYLOAD = 2**16


class Writer:
    """Writes one stream; a context manager.

        with spmesh.Writer(path, header) as writer:
            writer.points(xyz)

    Leaving the block normally writes END, and gives a file its name; leaving it by an exception does neither, so that
    what was written is never taken for a whole stream, and a file that was there before stays. Values that
    break a rule raise ValueError; whole meshes are not checked (`spinfo --audit` is).
    """

    def __init__(self, file: File, header: Header):
        self._data = header.encode()
        self.header = header
        self._own = OutputFile(file) if isinstance(file, (str, os.PathLike)) else None
        self._file = self._own or cast(BinaryIO, file)
        self._sequence, self._phase = 0, 0
        self.totals = dict.fromkeys(TOTALS, 0)
        self._finalized = 0
        self._constraints = Constraints(header)
        self._regions = Regions() if header.kind == "points in regions" else None
        self._file.write(self._data)

    def __enter__(self) -> "Writer":
        return self

    def __exit__(self, failure: object, *_: object) -> None:
        try:
            if failure is None:
                self.end()
        finally:
            if self._own:
                self._own.close()

    def _block(self, tag: bytes, payload: bytes) -> None:
        if len(payload) > PAYLOAD_MAX:
            raise ValueError(f"a block of {len(payload)} bytes, the maximum is 2^20")
        if tag not in (b"attp", b"END "):
            phases = KINDS[CODES[self.header.kind]][2]
            phase = next((i for i, tags in enumerate(phases) if tag in tags), -1)
            if phase < self._phase:
                raise ValueError(f"no block {tag!r} may stand here in a stream of kind {self.header.kind}")
            self._phase = phase
        frame = struct.pack("<4sII", tag, self._sequence, len(payload))
        self._sequence = (self._sequence + 1) % 2**32
        self._file.write(frame + struct.pack("<I", crc32c(payload, crc32c(frame))) + payload)

    def _stored(self, points: ArrayLike, is_stored: bool) -> np.ndarray:
        xyz = np.asarray(points)
        if xyz.ndim != 2 or xyz.shape[1] != self.header.axes:
            raise ValueError(f"points of shape {xyz.shape}, expected (n, {self.header.axes})")
        stored = np.ascontiguousarray(xyz, self.header.dtype) if is_stored else self.header.stored(xyz)
        if stored.dtype.kind == "f" and not np.isfinite(stored).all():
            raise ValueError("a coordinate is not finite")
        return stored

    def _rows(self, attributes: Columns | None, count: int) -> bytes:
        """The rows of `count` points from a structured array, or from columns by name."""
        if not self.header.attributes:
            if attributes is not None:
                raise ValueError("the header lists no attributes")
            return b""
        if count == 0:
            return b""
        dtype = self.header.row_dtype
        if isinstance(attributes, Mapping):
            rows = np.empty(count, dtype)
            for name in dtype.names or ():
                rows[name] = attributes[name]
        elif attributes is None:
            raise ValueError("points of this stream have attributes: " + ", ".join(dtype.names or ()))
        else:
            rows = np.ascontiguousarray(attributes, dtype)
        if rows.shape != (count,):
            raise ValueError(f"attributes of {rows.shape} points, expected {count}")
        return rows.tobytes()

    def points(self, xyz: ArrayLike, attributes: Columns | None = None, stored: bool = False) -> None:
        """Points (n, axes), of the world unless `stored`; `attributes` as columns by name or a structured array (n,)."""
        xyz = np.asarray(xyz)
        rows = self._rows(attributes, len(xyz))
        if self._regions:
            self._regions.points(len(xyz))
        else:
            self.totals["points"] += len(xyz)
        size = self.header.dtype.itemsize * self.header.axes
        row = len(rows) // len(xyz) if len(xyz) else 0
        step = min(POINTS_PAYLOAD // size, PAYLOAD_MAX // row if row else POINTS_PAYLOAD)
        for at in range(0, len(xyz), step):
            # Block by block, so that coordinates are converted in the cache.
            chunk = self._stored(xyz[at : at + step], stored)
            self._block(b"PNTS", chunk.tobytes())
            if row:
                self._block(b"attp", rows[at * row : (at + len(chunk)) * row])

    def region(self, region: Region) -> None:
        """Starts a region: as many points as it states must follow, in the order of its counts."""
        if self._regions is None:
            raise ValueError(f"a region in a stream of kind {self.header.kind}")
        self._regions.region(region)
        self._block(b"REGN", payload_of(region))
        self.totals["points"] = self._regions.total

    def cells(self, codes: ArrayLike) -> None:
        """Location codes (n,) of cells that are final."""
        codes = np.ascontiguousarray(codes, "<u8")
        self._block(b"CELL", codes.tobytes())
        self.totals["cells"] += len(codes)

    def patch(
        self, new: ArrayLike, imported: ArrayLike, simplices: ArrayLike, finalized: ArrayLike,
        attributes: Columns | None = None, stored: bool = False, sides: ArrayLike = (),
        origins: Iterable[Sequence[int]] = (), kept: ArrayLike = (),
    ) -> None:
        """New vertices (n, axes), ids (m,) of imported ones, simplices (s, corners) and finalized vertices as local
        indices, which count the new vertices first. Of a constrained mesh also `sides` (n, 3): triangle, the corner
        opposite to the side, segment. Of a part of a mesh also `origins`, pairs of the local index of a new vertex
        that other
        parts have and its global id, and `kept`, finalized local indices that later parts may use."""
        points = self._stored(np.asarray(new).reshape(-1, self.header.axes), stored)
        imported = np.ascontiguousarray(imported, "<u8")
        simplices = np.ascontiguousarray(simplices, "<u4").reshape(-1, self.header.corners)
        finalized = np.ascontiguousarray(finalized, "<u4")
        if simplices.size and simplices.max() >= len(points) + len(imported):
            raise ValueError("a simplex uses a vertex that its patch does not have")
        rows = self._rows(attributes, len(points))
        counts = (len(points), len(imported), len(simplices), len(finalized))
        head = struct.pack("<Q4I", self.totals["vertices"], *counts)
        parts = (points, imported, simplices, finalized)
        sides = np.ascontiguousarray(sides, "<u4").reshape(-1, 3)
        shared, kept = origins_of(origins), np.ascontiguousarray(kept, "<u4")
        if len(sides):
            self._constraints.check_sides(Patch(0, points, imported, simplices, finalized, sides=sides))
            self._block(b"side", sides.tobytes())
        if len(shared) or len(kept):
            if self.header.part is None:
                raise ValueError("vertices of other parts in a stream that is no part of a mesh")
            check_shared(self.header, Patch(0, points, imported, simplices, finalized, origins=shared, kept=kept))
            for tag, records in ((b"from", shared), (b"kept", kept)):
                if len(records):
                    self._block(tag, records.tobytes())
        self._block(b"PTCH", head + b"".join(part.tobytes() for part in parts))
        if rows:
            self._block(b"attp", rows)
        self.totals["vertices"] += len(points)
        self.totals["simplices"] += len(simplices)
        self._finalized += len(finalized)

    def segments(self, lines: ArrayLike, ends: ArrayLike, stored: bool = False) -> None:
        """Segments of a constrained mesh: numbers (n,) of lines, and x and y of both ends (n, 2, 2)."""
        ends = np.asarray(ends).reshape(-1, 2, 2)
        if not stored:
            padded = np.zeros((len(ends) * 2, self.header.axes))
            padded[:, :2] = ends.reshape(-1, 2)
            if self.header.axes == 3 and self.header.offset is not None:
                padded[:, 2] = self.header.offset[2]
            ends = self.header.stored(padded)[:, :2].reshape(-1, 2, 2)
        records = np.empty(len(ends), segment_dtype(self.header))
        records["line"], records["ends"] = lines, ends
        self._constraints.check_segments(Segments(records["line"], records["ends"]))
        step = PAYLOAD_MAX // records.itemsize
        for at in range(0, len(records), step):
            self._block(b"segm", records[at : at + step].tobytes())

    def open_segments(self, numbers: ArrayLike) -> None:
        """Numbers (n,) of segments that leave the mesh, increasing. No patch follows."""
        numbers = np.ascontiguousarray(numbers, "<u4")
        self._constraints.check_open(OpenSegments(numbers))
        for at in range(0, len(numbers), PAYLOAD_MAX // 4):
            self._block(b"open", numbers[at : at + PAYLOAD_MAX // 4].tobytes())

    def labels(self, labels: ArrayLike) -> None:
        """Labels (n,) of the next vertices without one."""
        self._block(b"LABL", np.ascontiguousarray(labels, "<u8").tobytes())

    def residual_points(
        self, ids: ArrayLike, xyz: ArrayLike, attributes: Columns | None = None, stored: bool = False
    ) -> None:
        """Residual points (n, axes) with their ids (n,), 2^64 - 1 for those that are no vertices yet."""
        points = self._stored(xyz, stored)
        records = np.empty(len(points), [("id", "<u8"), ("xyz", points.dtype, (self.header.axes,))])
        records["id"], records["xyz"] = ids, points
        rows = self._rows(attributes, len(points))
        self._block(b"RPNT", records.tobytes())
        if rows:
            self._block(b"attp", rows)
        self.totals["residual"] += len(points)
        self._named = getattr(self, "_named", 0) + int((records["id"] != np.uint64(NOT_A_VERTEX)).sum())

    def walls(self, corners: ArrayLike) -> None:
        """Walls (n, dims) as numbers of residual points."""
        corners = np.ascontiguousarray(corners, "<u4").reshape(-1, self.header.dims)
        self._block(b"WALL", corners.tobytes())
        self.totals["walls"] += len(corners)

    def points4(self, xyzt: ArrayLike, values: ArrayLike | None = None) -> None:
        """Points (n, 4), with values (n,) if the header says so; any NaN stands for an unknown value."""
        columns = np.asarray(xyzt, "<f8")
        if self.header.has_elevation:
            known = np.asarray(values, np.float64)
            columns = np.column_stack([columns, np.where(np.isnan(known), np.nan, known)])
        for at in range(0, len(columns), 16384):
            data = np.array(columns[at : at + 16384])
            # The one NaN that the format has.
            data.view("<u8")[np.isnan(data)] = 0x7FF8000000000000
            self._block(b"PNT4", data.tobytes())
        self.totals["points" if self.header.kind == "points in 4 dimensions" else "vertices"] += len(columns)

    def cells4(
        self, infinite: Iterable[bool], vertices: Iterable[Sequence[int]], neighbours: Iterable[Sequence[int]]
    ) -> None:
        """Cells as a flag, increasing vertices and increasing neighbours each."""
        words: list[int] = []
        for mark, of, beside in zip(infinite, vertices, neighbours):
            words += [len(of) | bool(mark) << 31, len(beside), *map(int, of), *map(int, beside)]
            self.totals["simplices"] += 1
        data = np.array(words, "<u4")
        for at in range(0, len(data), PAYLOAD_MAX // 4):
            self._block(b"CEL4", data[at : at + PAYLOAD_MAX // 4].tobytes())

    def simplices4(self, corners: ArrayLike) -> None:
        """Simplices (n, 5) as numbers of points."""
        corners = np.ascontiguousarray(corners, "<u4").reshape(-1, 5)
        for at in range(0, len(corners), 50000):
            self._block(b"SIM4", corners[at : at + 50000].tobytes())
        self.totals["simplices"] += len(corners)

    def configurations(
        self, degree: int, standing: int, interiors: ArrayLike, counts: ArrayLike, boundaries: ArrayLike
    ) -> None:
        """Groups of a degree, as in `blocks.Configurations`, in one block."""
        parts = [np.ascontiguousarray(part, "<u4") for part in (interiors, counts, boundaries)]
        head = struct.pack("<3I", degree, standing, len(parts[1]))
        self._block(b"CONF", head + b"".join(part.tobytes() for part in parts))
        self.totals["simplices"] += len(parts[2].reshape(-1, 3))

    def functions(self, functions: Sequence[Function]) -> None:
        """Functions of splines, as in `blocks.Function`."""
        names = [name for name, _ in KNOTS_OF]
        data = b""
        for function in functions:
            data += struct.pack(f"<{2 + len(function.knots)}I", names.index(function.kind), len(function.terms), *function.knots)
            data += b"".join(struct.pack("<2Id", *term) for term in function.terms)
        self._block(b"FUNC", data)
        self.totals["vertices"] += len(functions)

    def coefficients(self, values: ArrayLike) -> None:
        """Coefficients (n,) of all functions."""
        values = np.ascontiguousarray(values, "<f8")
        for at in range(0, len(values), PAYLOAD_MAX // 8):
            self._block(b"COEF", values[at : at + PAYLOAD_MAX // 8].tobytes())
        self.totals["residual"] += len(values)

    def end(self, merged: int = 0, points: int = 0) -> None:
        """Writes END. `merged` points of the input of a mesh coincide with others. `points`: of a residual, those of
        its region."""
        totals, kind = dict(self.totals), self.header.kind
        if self._regions:
            self._regions.end()
        if self.header.is_residual:
            totals["merged"], totals["points"] = merged, points
        elif self.header.has_patches or kind in ("cells in 4 dimensions", "simplices in 4 dimensions"):
            totals["merged"] = merged
            totals["points"] = totals["vertices"] + merged + totals["residual"] - getattr(self, "_named", 0)
        if self.header.has_patches and self._finalized + getattr(self, "_named", 0) != totals["vertices"]:
            raise ValueError(f"{self._finalized} of {totals['vertices']} vertices are finalized")
        self._block(b"END ", struct.pack("<7Q", *totals.values()))
        if self._own:
            self._own.commit()
        else:
            self._file.flush()
