"""The header of a stream: kind, coordinates, and what is known before the first block (format, section 2)."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, field
from typing import Any, Callable, Sequence

import numpy as np

from .attributes import Attribute, attributes_of, text_of
from .checksum import crc32c
from .errors import MalformedError, TooNewError, needs, require
from .types import Floats, Take

MAGIC = b"\x89SPM\r\n\x1a\n"
UNKNOWN = 2**64 - 1

# Name, dimensions, and tags of blocks in their order.
KINDS = {
    1: ("points", (2, 3), ((b"PNTS", b"CELL"),)),
    2: ("triangle mesh", (2,), ((b"segm", b"side", b"from", b"kept", b"PTCH"), (b"open",))),
    3: ("partial triangle mesh", (2,), ((b"PTCH",), (b"RPNT",), (b"WALL",))),
    4: ("tetrahedral mesh", (3,), ((b"from", b"kept", b"PTCH", b"LABL"),)),
    5: ("points in 4 dimensions", (4,), ((b"PNT4",),)),
    6: ("cells in 4 dimensions", (4,), ((b"PNT4",), (b"CEL4",))),
    7: ("simplices in 4 dimensions", (4,), ((b"PNT4",), (b"SIM4",))),
    8: ("configurations", (2,), ((b"PNTS",), (b"CONF",), (b"FUNC",))),
    9: ("splines", (2,), ((b"PNTS",), (b"CONF",), (b"FUNC",), (b"COEF",))),
    10: ("partial tetrahedral mesh", (3,), ((b"PTCH",), (b"RPNT",), (b"WALL",))),
    11: ("residual of a triangle mesh", (2,), ((b"RPNT",), (b"WALL",))),
    12: ("residual of a tetrahedral mesh", (3,), ((b"RPNT",), (b"WALL",))),
    13: ("points in regions", (3,), ((b"REGN", b"PNTS"),)),
}
CODES = {name: code for code, (name, _, _) in KINDS.items()}
PART_BITS, NUMBER_BITS = 22, 40


def _packed(values: Sequence[float]) -> bytes:
    return struct.pack(f"<{len(values)}d", *values)


@dataclass
class Tree:
    """The finalization tree: `depth` levels over the cube from `origin` with this `side`, in stored
    coordinates.
    """

    depth: int
    origin: tuple[float, ...]
    side: float

    def check(self) -> None:
        wrong = "the finalization tree is out of range or not exact"
        require(self.depth <= (31 if len(self.origin) == 2 else 20), wrong)
        require(2.0**-1022 <= self.side < math.inf and math.frexp(self.side)[0] == 0.5, wrong)
        unit = self.side / 2.0**31
        for origin in self.origin:
            steps = origin / unit
            require(math.isfinite(steps) and steps.is_integer() and steps * unit == origin, wrong)
            require(abs(steps) + 2.0**31 < 2.0**53 and origin + self.side < math.inf, wrong)

    def contains(self, low: Sequence[float], high: Sequence[float]) -> bool:
        return all(o <= a and b < o + self.side for o, a, b in zip(self.origin, low, high))


@dataclass
class Header:
    """What a stream states about itself. Coordinates of boxes, tree and region are stored ones, but those of
    `bounds`.

    Without `scale` and `offset` (three numbers each), stored coordinates are float64 of the world; with them
    they are int32 and world = stored * scale + offset.
    """

    kind: str = "points"
    dims: int = 2
    has_elevation: bool = False
    scale: tuple[float, ...] | None = None
    offset: tuple[float, ...] | None = None
    stored_bounds: tuple[float, ...] | None = None
    points: int | None = None
    tree: Tree | None = None
    region: tuple[float, ...] | None = None
    chunked: bool = False
    compressed: bool = False
    wkt: str | None = None
    geokeys: tuple[bytes, bytes, bytes] | None = None
    attributes: list[Attribute] = field(default_factory=list)
    # Of a constrained mesh: whether its border is cut, and the kill length or 0.
    constrained: tuple[bool, float] | None = None
    # Of weighted points of space: no weight is greater.
    weighted: float | None = None
    # Of a part of a mesh, or of its residual: its name, and the number of parts below it.
    part: tuple[int, int] | None = None
    producer: str = "spmesh (Python)"

    @property
    def axes(self) -> int:
        """Numbers stored per point."""
        return self.dims + self.has_elevation

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of stored coordinates."""
        return np.dtype("<f8" if self.scale is None else "<i4")

    @property
    def row_dtype(self) -> np.dtype[Any]:
        """The structured type of a row of attributes."""
        return np.dtype([attribute.field for attribute in self.attributes])

    @property
    def corners(self) -> int:
        """Vertices of a simplex of a patch."""
        return self.dims + 1

    @property
    def is_residual(self) -> bool:
        """Whether the stream is the residual of a part."""
        return self.kind.startswith("residual of ")

    @property
    def has_patches(self) -> bool:
        """Whether the stream is a mesh in patches."""
        return self.kind.endswith("mesh") and not self.is_residual

    @property
    def bounds(self) -> tuple[float, ...] | None:
        """The box of all points in the world, as (x0, y0, z0, x1, y1, z1); None if it is not stated.

        Without elevations, z0 and z1 are 0. `stored_bounds` has the same in stored coordinates.
        """
        if self.stored_bounds is None:
            return None
        flat = (0.0,) * (3 - self.axes)
        sides = self.stored_bounds[:3], self.stored_bounds[3:]
        low, high = (self.world(np.array(side[: self.axes])).tolist() for side in sides)
        return (*low, *flat, *high, *flat)

    @property
    def crs(self) -> str | None:
        """The coordinate reference system as text that pyproj takes: WKT, "EPSG:..." of GeoTIFF keys, or
        None.
        """
        if self.wkt or self.geokeys is None:
            return self.wkt or None
        keys = np.frombuffer(self.geokeys[0][: len(self.geokeys[0]) // 8 * 8], "<u2").reshape(-1, 4)[1:]
        stated = {int(key): int(value) for key, place, _, value in keys if place == 0 and 1024 <= value < 32767}
        plane, heights = stated.get(3072, stated.get(2048)), stated.get(4096)
        return None if plane is None else f"EPSG:{plane}" + (f"+{heights}" if heights else "")

    def world(self, stored: np.ndarray) -> Floats:
        """World coordinates (n, axes) of stored points (n, axes)."""
        if self.scale is None or self.offset is None:
            return np.asarray(stored, np.float64)
        axes = np.shape(stored)[-1]
        world: Floats = np.asarray(stored, np.float64) * self.scale[:axes] + self.offset[:axes]
        return world

    def stored(self, world: np.ndarray) -> np.ndarray:
        """Stored coordinates of world points (n, axes): on a grid, the nearest grid points.

        Raises ValueError if one does not fit the grid.
        """
        world = np.asarray(world, np.float64)
        if self.scale is None or self.offset is None:
            return np.ascontiguousarray(world, "<f8")
        axes = world.shape[-1]
        steps: np.ndarray = world - self.offset[:axes]
        steps /= self.scale[:axes]
        np.rint(steps, out=steps)
        if len(steps) and not (steps.min() >= -(2.0**31) and steps.max() < 2.0**31):
            raise ValueError("a coordinate does not fit the grid of 32 bits: choose another scale or offset")
        return steps.astype("<i4")

    # --- Rules between fields

    def check(self) -> None:
        _, dims, _ = KINDS[CODES[self.kind]]
        four = dims == (4,)
        require(self.dims in (2, 3, 4) and not (self.dims == 3 and self.has_elevation), "these dimensions with an elevation")
        require(self.dims in dims, f"a {self.kind} in {self.dims} dimensions")
        require(not four or self.scale is None, f"integer coordinates in a stream of kind {self.kind}")
        rest = self.stored_bounds or self.region or self.chunked or self.tree
        require(not four or not rest, f"a stream of kind {self.kind} has no box, tree or region, and is not chunked")
        require(len(self.producer.encode()) < 2**16, "the producer is longer than 2^16 - 1 bytes")
        if self.scale is not None and self.offset is not None:
            for scale, offset in zip(self.scale, self.offset):
                fits = scale > 0 and abs(offset) <= scale * 2.0**51 and scale * 2.0**51 < math.inf
                require(fits, "scale is not positive, or scale and offset are too far apart")
            free = self.kind == "points" and not self.tree
            require(free or len(set(self.scale[: self.dims])) == 1, "the axes of the geometry have several scales")
        if self.tree:
            without = self.kind in ("configurations", "splines", "partial tetrahedral mesh", "points in regions")
            without = without or self.is_residual
            require(not without, f"a stream of kind {self.kind} has no finalization tree")
            self.tree.check()
        self._check_bounds()
        partial = self.kind.startswith("partial ") or self.is_residual
        wrong = "a region goes with a partial mesh or a residual, and only with one"
        require((self.region is not None) == partial, wrong)
        if self.region is not None:
            ordered = all(a < b for a, b in zip(self.region[: self.dims], self.region[self.dims :]))
            require(ordered, "the region is empty or not a number")
        require(not self.chunked or (self.kind == "points" and self.tree), "only points with a tree can be chunked")
        self._check_attributes()
        if self.constrained is not None:
            is_cut, kill = self.constrained
            require(self.kind == "triangle mesh", f"a stream of kind {self.kind} is not constrained")
            require(0 <= kill < math.inf, f"kill length {kill}, expected a finite number from 0 on")
            require(is_cut or kill == 0, "a kill length, but a border that is not cut")
        if self.weighted is not None:
            space = self.kind in ("points", "tetrahedral mesh") and self.dims == 3
            require(space, f"weights in a stream of kind {self.kind} of {self.dims} dimensions")
            require(math.isfinite(self.weighted), f"the greatest weight {self.weighted}, expected a finite number")
            plain = [attribute for attribute in self.attributes if attribute.is_weight()]
            require(plain, 'weights need an attribute "weight": one f64 without scale and unknown number')
        self._check_part()

    def _check_part(self) -> None:
        require(self.part is not None or not self.is_residual, "a residual without the part that it is of")
        if self.part is None:
            return
        meshes = self.kind in ("triangle mesh", "tetrahedral mesh") or self.is_residual
        require(meshes, f"a stream of kind {self.kind} is no part of a mesh")
        plain = self.constrained is None and self.weighted is None
        require(plain, "a part of a mesh is neither constrained nor weighted")
        name, below = self.part
        require(0 <= name < 2**64, f"name {name}, expected 64 bits")
        require(0 <= below < 2**PART_BITS, f"{below} parts below, expected less than {2**PART_BITS}")

    def check_rows(self, rows: np.ndarray) -> None:
        """Checks the weights of points."""
        if self.weighted is None or not len(rows):
            return
        weights = rows["weight"]
        sound = np.isfinite(weights) & (weights <= self.weighted)
        require(sound.all(), f"a weight that is not finite, or above {self.weighted}")

    def _check_bounds(self) -> None:
        if self.stored_bounds is None:
            return
        low, high = self.stored_bounds[:3], self.stored_bounds[3:]
        require(all(a <= b for a, b in zip(low, high)), "the bounding box is not ordered")
        require(all(map(math.isfinite, self.stored_bounds)), "the bounding box is not storable")
        whole = all(v == int(v) and -(2**31) <= v < 2**31 for v in self.stored_bounds)
        require(self.scale is None or whole, "the bounding box is not storable")
        require(self.axes == 3 or low[2] == high[2] == 0, "the bounding box has a height, but the points have no z")
        inside = self.tree is None or self.tree.contains(low, high)
        require(inside, "the bounding box does not lie in the finalization tree")

    def _check_attributes(self) -> None:
        if not self.attributes:
            return
        kinds = ("points", "points in regions", "triangle mesh", "tetrahedral mesh")
        meshes = self.kind in kinds or self.kind.startswith("partial ")
        require(meshes or self.is_residual, f"a stream of kind {self.kind} has no attributes")
        for attribute in self.attributes:
            attribute.check()
        names = [attribute.name for attribute in self.attributes]
        require(len(set(names)) == len(names), "two attributes of one name")
        length = sum(attribute.dtype.itemsize * attribute.components for attribute in self.attributes)
        require(length <= 1024, f"rows of {length} bytes, the maximum is 1024")

    # --- Bytes

    @classmethod
    def read(cls, take: Take) -> "Header":
        """Reads a header; `take(n)` gives the next n bytes, fewer at the end of the input."""
        start = take(16)
        require(start, "the input is empty, expected a spmesh stream")
        require(MAGIC.startswith(start[:8]), "the first bytes are not those of a spmesh stream")
        require(len(start) == 16, f"truncated: found {len(start)} of the first 16 bytes")
        version, kind, length = struct.unpack("<HHI", start[8:])
        if version != 2:
            age = "a newer" if version > 2 else "an older"
            raise TooNewError(f"version {version}; this package reads version 2: {age} spmesh made it")
        require(16 <= length <= 2**20, f"header body of {length} bytes")
        body = take(length + 4)
        require(len(body) == length + 4, "truncated: the input ends in the header")
        stated = int.from_bytes(body[length:], "little")
        require(crc32c(body[:length], crc32c(start)) == stated, "checksum does not match: the header is damaged")
        return cls._parse(kind, body[:length])

    @classmethod
    def _parse(cls, kind: int, body: bytes) -> "Header":
        coordinates, dims, elevation, flags, features, points = struct.unpack_from("<BBBBIQ", body)
        if kind not in KINDS:
            needs(f"kind {kind}")
        if features > 1:
            needs(f"feature bit {(features & ~1).bit_length() - 1}")
        if coordinates not in (1, 2):
            needs(f"coordinate type {coordinates}")
        records = _records(body[16:])
        require(elevation < 2 and flags < 2, "elevation or flags other than 0 and 1")
        header = cls(KINDS[kind][0], dims, elevation == 1, producer="")
        require(dims in (2, 3, 4), f"{dims} dimensions")
        header.points = None if points == UNKNOWN else points
        header.chunked, header.compressed = flags == 1, features == 1
        require((b"GRID" in records) == (coordinates == 2), "i32 coordinates need a GRID, and f64 have none")
        require(not (b"cWKT" in records and b"cGEO" in records), "the header has the CRS in two records")
        for tag, payload in records.items():
            _RECORDS[tag](header, payload)
        header.check()
        return header

    def encode(self) -> bytes:
        """The bytes of the header. Raises MalformedError if it breaks a rule."""
        self.check()
        code = CODES[self.kind]
        body = struct.pack(
            "<BBBBIQ", 1 if self.scale is None else 2, self.dims, self.has_elevation, self.chunked, 0,
            UNKNOWN if self.points is None else self.points,
        )
        tree = self.tree and _packed((*self.tree.origin, self.tree.side)) + struct.pack("<I", self.tree.depth)
        crs = self.geokeys and b"".join(struct.pack("<I", len(part)) + part for part in self.geokeys)
        records = [
            (b"GRID", self.scale is not None and self.offset is not None and _packed((*self.scale, *self.offset))),
            (b"BBOX", self.stored_bounds is not None and _packed(self.stored_bounds)),
            (b"TREE", tree),
            (b"REGN", self.region is not None and _packed(self.region)),
            (b"cWKT", self.wkt is not None and self.wkt.encode()),
            (b"cGEO", crs),
            (b"attr", b"".join(attribute.encode() for attribute in self.attributes)),
            (b"cons", self.constrained is not None and struct.pack("<?d", *self.constrained)),
            (b"wght", self.weighted is not None and struct.pack("<d", self.weighted)),
            (b"part", self.part is not None and struct.pack("<QI", *self.part)),
            (b"prod", self.producer.encode()),
        ]
        for tag, payload in records:
            if payload or (tag == b"cWKT" and payload == b""):
                body += tag + struct.pack("<I", len(payload)) + payload
        require(len(body) <= 2**20, f"header body of {len(body)} bytes, the maximum is 2^20")
        head = MAGIC + struct.pack("<HHI", 2, code, len(body)) + body
        return head + struct.pack("<I", crc32c(head))


def check_tag(tag: bytes, part: str) -> None:
    letters = tag[:1].isalpha() and all(b < 128 and (chr(b).isalnum() or b == 32) for b in tag)
    require(letters, f"{part} tag {tag!r}, expected a letter, then letters, digits or spaces")


def _records(data: bytes) -> dict[bytes, bytes]:
    records: dict[bytes, bytes] = {}
    at = 0
    while at < len(data):
        require(at + 8 <= len(data), "bytes after the last header record")
        tag, length = data[at : at + 4], int.from_bytes(data[at + 4 : at + 8], "little")
        require(at + 8 + length <= len(data), f"header record {tag!r} is longer than the header")
        check_tag(tag, "header record")
        require(tag not in records, f"two header records {tag!r}")
        records[tag] = data[at + 8 : at + 8 + length]
        at += 8 + length
    for tag in records:
        if tag not in _RECORDS and not tag[0] & 0x20:
            needs(f"header record {tag!r}")
    return {tag: payload for tag, payload in records.items() if tag in _RECORDS}


def _floats(payload: bytes, count: int, extra: int = 0) -> tuple[float, ...]:
    require(len(payload) == 8 * count + extra, f"a header record of {len(payload)} bytes, expected {8 * count + extra}")
    return struct.unpack_from(f"<{count}d", payload)


def _grid(header: Header, payload: bytes) -> None:
    numbers = _floats(payload, 6)
    header.scale, header.offset = numbers[:3], numbers[3:]


def _tree(header: Header, payload: bytes) -> None:
    require(header.dims < 4, "no finalization tree in 4 dimensions")
    numbers = _floats(payload, header.dims + 1, 4)
    header.tree = Tree(int.from_bytes(payload[-4:], "little"), numbers[:-1], numbers[-1])


def _geokeys(header: Header, payload: bytes) -> None:
    parts = []
    for _ in range(3):
        size = int.from_bytes(payload[:4], "little")
        require(4 <= len(payload) and 4 + size <= len(payload), "GeoKey records do not fit the CRS")
        parts.append(payload[4 : 4 + size])
        payload = payload[4 + size :]
    require(not payload, "GeoKey records do not fit the CRS")
    header.geokeys = parts[0], parts[1], parts[2]


def _constrained(header: Header, payload: bytes) -> None:
    (kill,) = _floats(payload[1:], 1)
    require(payload[0] < 2, f"flags {payload[0]}, of which all bits but bit 0 must be 0")
    header.constrained = bool(payload[0]), kill


def _part(header: Header, payload: bytes) -> None:
    require(len(payload) == 12, f'header record "part" of {len(payload)} bytes, expected 12')
    header.part = struct.unpack("<QI", payload)


def _producer(header: Header, payload: bytes) -> None:
    header.producer = text_of(payload, "producer")


_RECORDS: dict[bytes, Callable[[Header, bytes], None]] = {
    b"GRID": _grid,
    b"BBOX": lambda header, payload: setattr(header, "stored_bounds", _floats(payload, 6)),
    b"TREE": _tree,
    b"REGN": lambda header, payload: setattr(header, "region", _floats(payload, 2 * header.dims)),
    b"cWKT": lambda header, payload: setattr(header, "wkt", text_of(payload, "CRS")),
    b"cGEO": _geokeys,
    b"attr": lambda header, payload: setattr(header, "attributes", attributes_of(payload)),
    b"cons": _constrained,
    b"wght": lambda header, payload: setattr(header, "weighted", _floats(payload, 1)[0]),
    b"part": _part,
    b"prod": _producer,
}
