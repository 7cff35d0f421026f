"""Reads a stream block by block, and checks every rule that the format demands of readers."""

from __future__ import annotations

import os
import struct
from typing import BinaryIO, Callable, Iterator

import numpy as np

from . import blocks as b
from .checksum import crc32c
from .compression import decompressor
from .constraints import Constraints, sides_of
from .errors import MalformedError, SpmeshError, needs, require, upstream_error
from .header import CODES, KINDS, NUMBER_BITS, UNKNOWN, Header, check_tag
from .parts import check_shared, shared_of
from .regions import Regions, region_of
from .rules import Chunks, FinalCells, LiveVertices
from .splines_reader import Splines, records_of
from .types import Buffer, File

UNKNOWN_VALUE = np.uint64(0x7FF8000000000000)


class Reader:
    """Iterates over the blocks of a stream as the classes of `spmesh.blocks`; the last one is `End`.

    Every fault raises MalformedError or TooNewError with the block and its first byte. A stream that is cut off raises
    before the iteration ends. With `memory=False`, the rules that need memory (format, section 6.1) are not checked.
    Memory: one block, and with `memory` live vertices and final cells.
    """

    def __init__(self, file: File, memory: bool = True):
        self._own = isinstance(file, (str, os.PathLike))
        self._file: BinaryIO = open(file, "rb") if isinstance(file, (str, os.PathLike)) else file
        self.place, self._offset, self._number, self._tail = "header at byte 0", 0, 0, b""
        try:
            self.header = Header.read(self._read)
        except SpmeshError as error:
            failure = self._failure_of(error)
            self.close()
            raise failure from None
        header = self.header
        self._phases, self._phase, self._ended = KINDS[CODES[header.kind]][2], 0, False
        self.totals = dict.fromkeys(b.TOTALS, 0)
        self._finalized = self._named = self._labels = 0
        self._cells = FinalCells(header.tree) if header.tree and memory else None
        self._chunks = Chunks(header.tree) if header.tree and header.chunked else None
        self._live = LiveVertices(header) if memory and header.has_patches else None
        self._words: np.ndarray = np.empty(0, "<u4")
        self._neighbour, self._last = -1, np.empty((0, 4))
        self._splines = Splines(header.kind, self.totals)
        self._point_size = header.axes * header.dtype.itemsize
        # What blocks before the next patch say about it, by their tags.
        self._constraints, self._more = Constraints(header), dict[bytes, np.ndarray]()
        self._decompress = decompressor() if header.compressed else None
        self._regions = Regions() if header.kind == "points in regions" else None
        self._row = header.row_dtype if header.attributes else None

    def close(self) -> None:
        """Closes the file if the reader opened it."""
        if self._own:
            self._file.close()

    def __enter__(self) -> "Reader":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[b.Block]:
        while (block := self.next_block()) is not None:
            yield block

    def _read(self, size: int) -> bytes:
        data = self._file.read(size)
        while len(data) < size and (more := self._file.read(size - len(data))):
            data += more
        self._offset += len(data)
        self._tail = (self._tail + data[-32:])[-32:]
        return data

    def _failure_of(self, error: SpmeshError) -> SpmeshError:
        """The error with its place, or that of the program before this one in a pipe, which is its cause."""
        cause = None if self._own else upstream_error(self._tail + self._read(32))
        return cause or type(error)(error.message, self.place)

    def _take(self, size: int) -> bytes:
        data = self._read(size)
        require(len(data) == size, f"truncated: found {len(data)} of {size} bytes, without END")
        return data

    def next_block(self) -> b.Block | None:
        """The next block; None after End."""
        if self._ended:
            return None
        try:
            tag, payload = self._known_block()
            while tag in (b"side", b"from", b"kept"):
                self._more[tag] = sides_of(payload) if tag == b"side" else shared_of(tag, payload)
                tag, payload = self._known_block()
            place = self.place
            block = self._decode(tag, payload)
            points = self._points_of(block)
            if isinstance(block, (b.Points, b.ResidualPoints, b.Patch)) and self._row is not None and points:
                tag, payload = self._known_block(True)
                size = points * self._row.itemsize
                require(len(payload) == size, f"{len(payload)} bytes of attributes, expected {size}")
                block.rows = np.frombuffer(payload, self._row)
                self.header.check_rows(block.rows)
                self.place = place
            return block
        except SpmeshError as error:
            self._ended = True
            raise self._failure_of(error) from None

    @staticmethod
    def _points_of(block: b.Block) -> int:
        if isinstance(block, (b.Points, b.ResidualPoints)):
            return len(block.xyz)
        return len(block.new) if isinstance(block, b.Patch) else 0

    def _known_block(self, expects_rows: bool = False) -> tuple[bytes, bytes]:
        while True:
            self.place = f"block {self._number} at byte {self._offset}"
            frame = self._take(16)
            tag, sequence, length, checksum = struct.unpack("<4sIII", frame)
            compressed, length = length >> 31, length & 0x7FFFFFFF
            require(self.header.compressed or not compressed, "a compressed block in a stream without feature bit 0")
            require(length <= 2**20, f"block of {length} bytes, the maximum is 2^20")
            payload = self._take(length)
            require(crc32c(payload, crc32c(frame[:12])) == checksum, "checksum does not match: the block is damaged")
            require(sequence == self._number % 2**32, "a block is missing or repeated")
            self._number += 1
            check_tag(tag, "block")
            if tag in _DECODERS or tag in (b"attp", b"side", b"from", b"kept"):
                break
            if not tag[0] & 0x20:
                needs(f"block tag {tag!r}")
        if tag == b"attp" or expects_rows:
            require(self._row is not None, "attributes in a stream without them")
            require(expects_rows, "attributes behind no points")
            require(tag == b"attp", f"block {tag!r}, expected the attributes of the points before it")
        follows = not self._more or tag == b"PTCH" or (list(self._more) == [b"from"] and tag == b"kept")
        require(follows, f"block {tag!r}, expected the patch of the blocks before it")
        if tag not in (b"attp", b"END "):
            phase = next((i for i, tags in enumerate(self._phases) if tag in tags), -1)
            require(phase >= self._phase, f"no block {tag!r} may stand here in a stream of kind {self.header.kind}")
            self._phase = phase
            constrained = self.header.constrained is not None or tag not in (b"segm", b"side", b"open")
            require(constrained, f"block {tag!r} in a stream that is not constrained")
            part = self.header.part is not None or tag not in (b"from", b"kept")
            require(part, f"block {tag!r} in a stream that is no part of a mesh")
        if compressed:
            require(tag != b"END ", "END is compressed")
            assert self._decompress is not None  # Only compressed streams have such blocks, as was required above.
            payload = self._decompress(payload)
        return tag, payload

    def _decode(self, tag: bytes, payload: bytes) -> b.Block:
        return _DECODERS[tag](self, payload)

    # --- Points and cells

    def _xyz(self, payload: Buffer) -> np.ndarray:
        header = self.header
        require(len(payload) % self._point_size == 0, "not a whole number of points")
        xyz = np.frombuffer(payload, header.dtype).reshape(-1, header.axes)
        self._box: tuple[list[float], list[float]] | None = None
        if not len(xyz):
            return xyz
        low, high = [list(map(float, side)) for side in (xyz.min(axis=0), xyz.max(axis=0))]
        # The least and the greatest are NaN if any coordinate is.
        require(np.isfinite(low + high).all(), "a coordinate is not finite")
        self._box = low, high
        box = [*low, *[0.0] * (3 - header.axes)], [*high, *[0.0] * (3 - header.axes)]
        if header.stored_bounds is not None:
            inside = all(a <= c and d <= e for a, c, d, e in zip(header.stored_bounds, *box, header.stored_bounds[3:]))
            require(inside, "a point lies outside of the header's bounding box")
        if header.tree:
            require(header.tree.contains(low, high), "a point lies outside of the finalization tree")
        if header.region is not None:
            dims = header.dims
            inside = all(a <= c and d < e for a, c, d, e in zip(header.region, *box, header.region[dims:]))
            require(inside, "a point lies outside of the region")
        return xyz

    def _points(self, payload: bytes) -> b.Points:
        xyz = self._xyz(payload)
        if self._cells:
            self._cells.check(xyz, *(self._box or ((), ())))
        if self._chunks and self._box:
            self._chunks.points(*self._box)
        if self._regions:
            self._regions.points(len(xyz))
        else:
            self.totals["points"] += len(xyz)
        return b.Points(xyz)

    def _region(self, payload: bytes) -> b.Region:
        region = region_of(payload)
        assert self._regions, "only this kind has these blocks"
        self._regions.region(region)
        self.totals["points"] = self._regions.total
        return region

    def _tags(self, payload: bytes) -> b.Cells:
        if self.header.tree is None:
            raise MalformedError("cell tag in a stream without a finalization tree")
        codes = records_of(payload, "<u8")
        levels = FinalCells(self.header.tree)
        for code in codes.tolist():
            if self._cells:
                self._cells.tag(code)
            else:
                require(levels.level(code) is not None, f"location code {code} is not a cell of the tree")
            if self._chunks:
                self._chunks.tag(code)
        self.totals["cells"] += len(codes)
        return b.Cells(codes)

    # --- Meshes

    def _patch(self, payload: bytes) -> b.Patch:
        require(len(payload) >= 24, f"patch of {len(payload)} bytes, expected at least 24")
        first, n, m, s, f = struct.unpack_from("<QIIII", payload)
        corners = self.header.corners
        ends = np.cumsum([24, n * self._point_size, 8 * m, 4 * corners * s, 4 * f]).tolist()
        require(ends[-1] == len(payload), "the counts of the patch do not add up to its length")
        require(first == self.totals["vertices"], f"patch starts with vertex {first}, expected {self.totals['vertices']}")
        data = memoryview(payload)
        new = self._xyz(data[ends[0] : ends[1]])
        imported = np.frombuffer(data[ends[1] : ends[2]], "<u8")
        simplices = np.frombuffer(data[ends[2] : ends[3]], "<u4").reshape(-1, corners)
        finalized = np.frombuffer(data[ends[3] : ends[4]], "<u4")
        require(_increases(imported) and (not m or imported[-1] < first), "imported vertices are not increasing ids")
        require(_increases(finalized) and (not f or finalized[-1] < n + m), "finalized vertices are not increasing")
        require(not s or simplices.max() < n + m, "simplex uses a vertex that its patch does not have")
        for one in range(corners):
            for other in range(one):
                require((simplices[:, one] != simplices[:, other]).all(), "simplex uses a vertex twice")
        patch = b.Patch(first, new, imported, simplices, finalized)
        more, self._more = self._more, {}
        if b"side" in more:
            patch.sides = more[b"side"]
            self._constraints.check_sides(patch)
        patch.origins, patch.kept = more.get(b"from", patch.origins), more.get(b"kept", patch.kept)
        check_shared(self.header, patch)
        if self._live:
            self._live.patch(patch)
        self.totals["vertices"] += n
        self.totals["simplices"] += s
        self._finalized += f
        return patch

    def _label(self, payload: bytes) -> b.Labels:
        labels = records_of(payload, "<u8")
        self._labels += len(labels)
        require(self._labels <= self.totals["vertices"], f"{self._labels} labels after {self.totals['vertices']} vertices")
        return b.Labels(labels)

    def _residual(self, payload: bytes) -> b.ResidualPoints:
        header = self.header
        records = records_of(payload, np.dtype([("id", "<u8"), ("xyz", header.dtype, (header.axes,))]))
        ids = np.ascontiguousarray(records["id"])
        xyz = self._xyz(np.ascontiguousarray(records["xyz"]).tobytes())
        named = ids[ids != np.uint64(b.NOT_A_VERTEX)]
        if header.part is not None and header.is_residual:
            known = (named >> np.uint64(NUMBER_BITS)) <= header.part[1]
        else:
            known = named < self.totals["vertices"]
        require(known.all(), "residual point has the id of no vertex")
        points = b.ResidualPoints(ids, xyz)
        if self._live:
            self._live.residual(points)
        self._named += len(named)
        self.totals["residual"] += len(ids)
        return points

    def _walls(self, payload: bytes) -> b.Walls:
        dims = self.header.dims
        walls = records_of(payload, np.dtype(("<u4", (dims,)))).reshape(-1, dims)
        require(not len(walls) or walls.max() < self.totals["residual"], "wall between no residual points")
        ordered = np.sort(walls, axis=1)
        require((ordered[:, 1:] != ordered[:, :-1]).all(), "wall with a corner twice")
        self.totals["walls"] += len(walls)
        return b.Walls(walls)

    # --- Four dimensions

    def _points4(self, payload: bytes) -> b.Points4:
        header = self.header
        records = records_of(payload, np.dtype(("<f8", (header.axes,)))).reshape(-1, header.axes)
        xyzt, values = records[:, :4], records[:, 4] if header.has_elevation else None
        require(np.isfinite(xyzt).all(), "coordinate is not finite")
        if values is not None:
            known = np.isfinite(values) | (np.ascontiguousarray(values).view("<u8") == UNKNOWN_VALUE)
            require(known.all(), "value is neither finite nor the NaN of what is not known")
        if header.kind == "cells in 4 dimensions" and len(xyzt):
            before = np.vstack([self._last, xyzt[:-1]])
            after = xyzt[1 - len(self._last) :]
            less, equal = np.zeros(len(after), bool), np.ones(len(after), bool)
            for axis in range(4):
                less |= equal & (before[:, axis] < after[:, axis])
                equal &= before[:, axis] == after[:, axis]
            require(less.all(), "a point does not follow the one before it")
            self._last = xyzt[-1:]
        self.totals["points" if header.kind == "points in 4 dimensions" else "vertices"] += len(xyzt)
        return b.Points4(xyzt, values)

    def _cells4(self, payload: bytes) -> b.Cells4:
        words = np.concatenate([self._words, records_of(payload, "<u4")])
        points, at = self.totals["vertices"], 0
        marks, corner_lists, neighbour_lists = list[bool](), list[np.ndarray](), list[np.ndarray]()
        while at < len(words):
            infinite, vertices = int(words[at]) >> 31, int(words[at]) & 0x7FFFFFFF
            require(vertices >= 5 - infinite, f"a cell of {vertices} vertices, expected at least {5 - infinite}")
            require(vertices <= points, f"a cell of {vertices} vertices, but {points} points")
            if at + 1 == len(words):
                break
            neighbours, corners = int(words[at + 1]), vertices + infinite
            require(neighbours <= corners * (corners - 3) // 2, "a cell of more neighbours than facets")
            require(2 + vertices + neighbours <= 2**31, "a cell of more than 2^31 words")
            middle, end = at + 2 + vertices, at + 2 + vertices + neighbours
            if end > len(words):
                break
            of, beside = words[at + 2 : middle], words[middle:end]
            require(_increases(of) and of[-1] < points, "the vertices of a cell are not increasing numbers of points")
            require(_increases(beside), "the neighbours of a cell are not increasing")
            self._neighbour = max(self._neighbour, int(beside[-1]) if len(beside) else -1)
            marks.append(bool(infinite))
            corner_lists.append(of)
            neighbour_lists.append(beside)
            at = end
        self._words = words[at:].copy()
        self.totals["simplices"] += len(marks)
        return b.Cells4(np.array(marks, bool), corner_lists, neighbour_lists)

    def _simplices4(self, payload: bytes) -> b.Simplices4:
        corners = records_of(payload, np.dtype(("<u4", (5,)))).reshape(-1, 5)
        require(not len(corners) or corners.max() < self.totals["vertices"], "simplex of no points")
        ordered = np.sort(corners, axis=1)
        require((ordered[:, 1:] != ordered[:, :-1]).all(), "simplex uses a vertex twice")
        self.totals["simplices"] += len(corners)
        return b.Simplices4(corners)

    # --- END

    def _end(self, payload: bytes) -> b.End:
        require(len(payload) == 56, f"END of {len(payload)} bytes, expected 56")
        stated = dict(zip(b.TOTALS, struct.unpack("<7Q", payload)))
        require(max(stated.values()) < UNKNOWN, "END: a total is beyond counting")
        header, counted = self.header, dict(self.totals)
        if header.is_residual:
            counted["points"], counted["merged"] = stated["points"], stated["merged"]
        elif header.has_patches or header.kind in ("cells in 4 dimensions", "simplices in 4 dimensions"):
            counted["merged"] = stated["merged"]
            counted["points"] = counted["vertices"] + counted["merged"] + counted["residual"] - self._named
        if header.has_patches:
            require(self._finalized + self._named == counted["vertices"], "END: vertices were not finalized")
            require(self._live is None or not self._live.live, "END: vertices are neither final nor in the residual")
        require(self._labels in (0, counted["vertices"]), "END: labels of some vertices only")
        if header.kind == "splines":
            functions, coefficients = counted["vertices"], counted["residual"]
            require(coefficients > 0 and functions in (0, coefficients), "END: one coefficient per function is needed")
            require(self._splines.degree is not None, "END: a spline without configurations")
        require(not len(self._words), "END: the last cell is cut off")
        for name in b.TOTALS:
            require(stated[name] == counted[name], f"END states {stated[name]} {name}, but the stream holds {counted[name]}")
        require(header.points in (None, stated["points"]), "END: the header states another number of points")
        require(self._neighbour < max(counted["simplices"], 0) or self._neighbour < 0, "END: a neighbour that does not exist")
        if self._regions:
            self._regions.end()
        if self._chunks:
            self._chunks.end()
        require(not self._file.read(1), "the input goes on after END")
        self._ended = True
        return b.End(stated)


def _increases(values: np.ndarray) -> bool:
    return bool((values[1:] > values[:-1]).all())


_DECODERS: dict[bytes, Callable[[Reader, bytes], b.Block]] = {
    b"PNTS": Reader._points,
    b"CELL": Reader._tags,
    b"REGN": Reader._region,
    b"PTCH": Reader._patch,
    b"segm": lambda reader, payload: reader._constraints.segment(payload),
    b"open": lambda reader, payload: reader._constraints.open(payload),
    b"LABL": Reader._label,
    b"RPNT": Reader._residual,
    b"WALL": Reader._walls,
    b"PNT4": Reader._points4,
    b"CEL4": Reader._cells4,
    b"SIM4": Reader._simplices4,
    b"CONF": lambda reader, payload: reader._splines.configurations(payload),
    b"FUNC": lambda reader, payload: reader._splines.functions(payload),
    b"COEF": lambda reader, payload: reader._splines.coefficients(payload),
    b"END ": Reader._end,
}
