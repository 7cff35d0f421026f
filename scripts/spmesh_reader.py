#!/usr/bin/env python3
"""Verifies a spmesh stream and prints its text twin.

    python3 spmesh_reader.py FILE      (- for stdin; -q prints nothing)

FILE may also be the manifest of a mesh in parts; the text twin is then that of the mesh that the parts join to.

A second reader, laid out like formats/spmesh.md, formats/text.md and formats/parts.md and written from them alone, with
only the standard library. It checks every rule of the text except the orientation of simplices, including the
rules that need to remember cells and vertices. Exit 0: well-formed. Exit 3: malformed, with a message. Exit
6: the stream needs what this reader does not know. Exit 1: the input cannot be read.

Compressed streams need Python 3.14, or the package zstandard.
"""

import bisect
import copy
import json
import math
import os
import struct
import sys
from decimal import Decimal

UNKNOWN = 2**64 - 1
FARAWAY = 2**32 - 1
NOT_KNOWN = bytes.fromhex("000000000000f87f")


class Malformed(Exception):
    """The input breaks a rule of the format."""

    exit_code = 3


class TooNew(Exception):
    """The input needs what version 2 of the text does not know."""

    exit_code = 6


REFUSED = (Malformed, TooNew)


def require(holds, message):
    if not holds:
        raise Malformed(message)


# --- 4 Tags -------------------------------------------------------------------------------------------------


LETTERS = frozenset(b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz")
CHARACTERS = LETTERS | frozenset(b"0123456789 ")


def escaped(tag):
    return "".join(chr(b) if 32 <= b < 127 else "\\x%02x" % b for b in tag)


def check_tag(tag, part):
    require(
        tag[0] in LETTERS and CHARACTERS.issuperset(tag),
        '%s tag "%s", expected a letter, then letters, digits or spaces' % (part, escaped(tag)),
    )


def require_known(tag, known, part):
    """Whether `tag` is known; if not, it must be one that may be skipped."""
    if tag not in known and not tag[0] & 0x20:
        needs('%s "%s"' % (part, escaped(tag)))
    return tag in known


def needs(part):
    raise TooNew("the stream needs %s, which this program does not know: a newer spmesh made it" % part)


# --- 4.1 CRC32C ---------------------------------------------------------------------------------------------


def crc_table():
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = (byte >> 1) ^ (0x82F63B78 if byte & 1 else 0)
        table.append(byte)
    return table


CRC_TABLE = crc_table()


def crc32c(data):
    table, crc = CRC_TABLE, 0xFFFFFFFF
    for byte in data:
        crc = table[(crc ^ byte) & 0xFF] ^ (crc >> 8)
    return crc ^ 0xFFFFFFFF


assert crc32c(b"123456789") == 0xE3069283


# --- 2 Header -----------------------------------------------------------------------------------------------

MAGIC = b"\x89SPM\r\n\x1a\n"
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

# Bits of a global id: those of the part, and of the number of the vertex.
PART_BITS, NUMBER_BITS = 22, 40

# Kinds of functions of splines, with their numbers of knots.
FUNCTIONS = (("edge", 2), ("vertex", 1), ("tent", 2), ("crease", 3), ("face", 4))


class Header:
    def __init__(self, data):
        """`data` is the header without its checksum, which has been verified."""
        (kind,) = struct.unpack_from("<H", data, 10)
        coordinate_type, self.dims, elevation, flags, features, self.points = struct.unpack_from("<BBBBIQ", data, 16)
        if kind not in KINDS:
            needs("kind %d" % kind)
        self.is_compressed = features & 1 == 1
        for bit in range(1, 32):
            if features >> bit & 1:
                needs("feature bit %d" % bit)
        if coordinate_type not in (1, 2):
            needs("coordinate type %d" % coordinate_type)
        self.kind, dims_of_kind, self.phases = KINDS[kind]
        records = self.records(data[32:])
        require(elevation < 2, "elevation %d, expected 0 or 1" % elevation)
        require(flags < 2, "flags 0x%02x, of which all bits but bit 0 must be 0" % flags)
        require(
            self.dims in (2, 3, 4) and not (self.dims == 3 and elevation),
            "%d dimensions with elevation %d" % (self.dims, elevation),
        )
        self.is_4d = dims_of_kind == (4,)
        self.is_integer = coordinate_type == 2
        self.chunked = flags & 1 != 0
        if self.is_4d:
            require(self.dims == 4, "dims %d in a stream of kind %s, expected 4" % (self.dims, self.kind))
            require(not self.is_integer, "integer coordinates in a stream of kind %s, expected f64" % self.kind)
        require(self.dims in dims_of_kind, "a %s in %d dimensions" % (self.kind, self.dims))
        self.has_elevation = elevation == 1
        self.axes = self.dims + elevation
        self.record = struct.Struct("<%d%s" % (self.axes, "i" if self.is_integer else "d"))
        self.has_knots = self.kind in ("configurations", "splines")
        self.is_residual = self.kind.startswith("residual of ")
        self.has_regions = self.kind == "points in regions"
        self.is_mesh = self.kind not in ("points", "points in 4 dimensions", "points in regions") and not self.has_knots
        self.scale = self.offset = self.tree = self.bounds = self.region = self.wkt = self.geokeys = None
        self.producer, self.attributes, self.constrained, self.weighted, self.part = "", [], None, None, None
        for tag, payload in records.items():
            RECORDS[tag](self, payload)
        require(self.scale or not self.is_integer, 'no header record "GRID", which i32 coordinates need')
        if self.is_integer:
            self.check_grid()
            self.check_scales()
        if self.is_4d:
            require(
                not (self.bounds or self.region or self.chunked),
                "a stream of kind %s has no bounding box, tree or region, and is not chunked" % self.kind,
            )
        self.check_bounds()
        self.check_region()
        self.check_weights()
        self.check_part()
        require(
            not self.chunked or (self.tree and not self.is_mesh),
            "only points with a finalization tree can be chunked",
        )

    # --- 2.6 Records of the header

    @staticmethod
    def records(data):
        """The payloads of the records that this reader knows, by their tags."""
        records, at = {}, 0
        while at < len(data):
            left = len(data) - at - 8
            require(left >= 0, "%d bytes after the last header record" % (left + 8))
            tag, length = struct.unpack_from("<4sI", data, at)
            require(
                length <= left,
                'header record "%s" of %d bytes, but %d are left in the header' % (escaped(tag), length, left),
            )
            check_tag(tag, "header record")
            require(tag not in records, 'two header records "%s"' % escaped(tag))
            records[tag] = data[at + 8 : at + 8 + length]
            at += 8 + length
        return {tag: payload for tag, payload in records.items() if require_known(tag, RECORDS, "header record")}

    def fields(self, tag, layout, payload):
        """The numbers of a record of a layout."""
        layout = struct.Struct("<" + layout)
        require(
            len(payload) == layout.size,
            'header record "%s": %d bytes, expected %d' % (tag, len(payload), layout.size),
        )
        return layout.unpack(payload)

    def read_grid(self, payload):
        require(self.is_integer, 'header record "GRID": f64 coordinates have no grid')
        numbers = self.fields("GRID", "6d", payload)
        self.scale, self.offset = numbers[:3], numbers[3:]

    def read_bounds(self, payload):
        self.bounds = self.fields("BBOX", "6d", payload)

    def read_tree(self, payload):
        require(
            not (self.is_4d or self.has_knots or self.is_residual or self.has_regions or self.kind == "partial tetrahedral mesh"),
            "a stream of kind %s has no finalization tree" % self.kind,
        )
        *origin, side, depth = self.fields("TREE", "%ddI" % (self.dims + 1), payload)
        self.tree = Tree(self.dims, tuple(origin), side, depth)

    def read_region(self, payload):
        self.region = self.fields("REGN", "%dd" % (2 * self.dims), payload)

    def check_crs(self):
        require(
            self.wkt is None and self.geokeys is None, "the header has the CRS in another record already"
        )

    def read_wkt(self, payload):
        self.check_crs()
        self.wkt = utf8(payload, "CRS")

    def read_geokeys(self, payload):
        self.check_crs()
        self.geokeys = geokeys(payload)

    def read_attributes(self, payload):
        self.attributes = attributes_of(Fields(payload))
        with_attributes = ("points", "points in regions", "triangle mesh", "tetrahedral mesh")
        require(
            self.kind in with_attributes or self.kind.startswith("partial ") or self.is_residual,
            "a stream of kind %s has no attributes" % self.kind,
        )

    def read_constrained(self, payload):
        flags, kill = self.fields("cons", "Bd", payload)
        require(self.kind == "triangle mesh", "a stream of kind %s is not constrained" % self.kind)
        require(flags < 2, "flags 0x%02x, of which all bits but bit 0 must be 0" % flags)
        require(0 <= kill < math.inf, "kill length %r, expected a finite number from 0 on" % kill)
        require(flags or not kill, "a kill length, but a border that is not cut")
        self.constrained = bool(flags), kill

    def read_weighted(self, payload):
        (greatest,) = self.fields("wght", "d", payload)
        require(
            self.kind in ("points", "tetrahedral mesh") and self.dims == 3,
            "weights in a stream of kind %s of %d dimensions" % (self.kind, self.dims),
        )
        require(math.isfinite(greatest), "the greatest weight %r, expected a finite number" % greatest)
        self.weighted = greatest

    def check_weights(self):
        """Finds the attribute of the weights, and its place in a row."""
        at = 0
        for attribute in self.attributes:
            is_plain = attribute.type == "f64" and (attribute.components, attribute.scale, attribute.unknown) == (1, None, None)
            if attribute.name == "weight" and is_plain:
                self.weight_at = at
                return
            at += attribute.row.size
        message = 'weights need an attribute "weight": one f64 without scale and unknown number'
        require(self.weighted is None, message)

    def check_rows(self, rows):
        """Checks the weights of points."""
        if self.weighted is None:
            return
        for at in range(self.weight_at, len(rows), self.row_length()):
            (weight,) = struct.unpack_from("<d", rows, at)
            is_sound = math.isfinite(weight) and weight <= self.weighted
            require(is_sound, "weight %r, expected a finite number up to %r" % (weight, self.weighted))

    def read_part(self, payload):
        self.part = self.fields("part", "QI", payload)

    def check_part(self):
        if self.part is None:
            require(not self.is_residual, "a residual without the part that it is of")
            return
        is_mesh = self.kind in ("triangle mesh", "tetrahedral mesh")
        require(is_mesh or self.is_residual, "a stream of kind %s is no part of a mesh" % self.kind)
        is_plain = self.constrained is None and self.weighted is None
        require(is_plain, "a part of a mesh is neither constrained nor weighted")
        require(self.part[1] < 2**PART_BITS, "%d parts below, expected less than %d" % (self.part[1], 2**PART_BITS))

    def row_length(self):
        return sum(attribute.row.size for attribute in self.attributes)

    def read_producer(self, payload):
        require(
            len(payload) < 2**16, "a producer of %d bytes, the maximum is %d" % (len(payload), 2**16 - 1)
        )
        self.producer = utf8(payload, "producer")

    def check_grid(self):
        for scale, offset in zip(self.scale, self.offset):
            require(
                scale > 0 and abs(offset) <= scale * 2.0**51 and scale * 2.0**51 < math.inf,
                "scale is not positive, or scale and offset are too far apart",
            )

    def check_scales(self):
        is_free = self.kind == "points" and not self.tree
        require(
            is_free or len(set(self.scale[: self.dims])) == 1,
            "the axes of the geometry have the scales %s, expected one scale" % decimals(self.scale[: self.dims]),
        )

    def check_bounds(self):
        if self.bounds is None:
            return
        low, high = self.bounds[:3], self.bounds[3:]
        require(all(a <= b for a, b in zip(low, high)), "the bounding box is not ordered")
        require(all(map(self.is_storable, self.bounds)), "the bounding box is not storable")
        require(self.axes == 3 or low[2] == high[2] == 0, "the bounding box has a height, but the points have no z")
        if self.tree:
            require(
                self.tree.contains(low) and self.tree.contains(high),
                "the bounding box does not lie in the finalization tree",
            )

    def is_storable(self, value):
        if self.is_integer:
            return math.isfinite(value) and value == int(value) and -(2**31) <= value < 2**31
        return math.isfinite(value)

    def check_region(self):
        require(
            (self.region is not None) == (self.kind.startswith("partial ") or self.is_residual),
            "a region goes with a partial mesh or a residual, and only with one",
        )
        if self.region:
            low, high = self.region[: self.dims], self.region[self.dims :]
            require(all(a < b for a, b in zip(low, high)), "the region is empty or not a number")

    def point(self, stored):
        """Returns a stored point with its z, after checking the header's statements about all points."""
        point = stored if self.axes == 3 else stored + (0,)
        x, y, z = point
        if not self.is_integer:
            require(math.isfinite(x) and math.isfinite(y) and math.isfinite(z), "coordinate is not finite")
        if self.bounds:
            x0, y0, z0, x1, y1, z1 = self.bounds
            require(
                x0 <= x <= x1 and y0 <= y <= y1 and z0 <= z <= z1,
                "point %r lies outside of the header's bounding box" % (point,),
            )
        if self.tree:
            require(self.tree.contains(point), "point %r lies outside of the finalization tree" % (point,))
        if self.region:
            low, high = self.region[: self.dims], self.region[self.dims :]
            require(
                all(a <= c < b for a, c, b in zip(low, point, high)), "point %r lies outside of the region" % (point,)
            )
        return point

    def points_of(self, data):
        require(
            len(data) % self.record.size == 0,
            "%d bytes are not a whole number of records of %d" % (len(data), self.record.size),
        )
        return [self.point(stored) for stored in self.record.iter_unpack(data)]


RECORDS = {
    b"GRID": Header.read_grid,
    b"BBOX": Header.read_bounds,
    b"TREE": Header.read_tree,
    b"REGN": Header.read_region,
    b"cWKT": Header.read_wkt,
    b"cGEO": Header.read_geokeys,
    b"attr": Header.read_attributes,
    b"cons": Header.read_constrained,
    b"wght": Header.read_weighted,
    b"part": Header.read_part,
    b"prod": Header.read_producer,
}


def utf8(data, what):
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        raise Malformed("%s is not UTF-8" % what) from None


def geokeys(data):
    records = []
    for _ in range(3):
        require(len(data) >= 4, "GeoKey records do not fit the CRS")
        length = int.from_bytes(data[:4], "little")
        require(len(data) >= 4 + length, "GeoKey records do not fit the CRS")
        records.append(data[4 : 4 + length])
        data = data[4 + length :]
    require(not data, "GeoKey records do not fit the CRS")
    return records


# --- 2.7 Attributes -----------------------------------------------------------------------------------------

# Types by their codes, which start at 1: name, and code of struct.
NUMBERS = (
    ("u8", "B"),
    ("i8", "b"),
    ("u16", "H"),
    ("i16", "h"),
    ("u32", "I"),
    ("i32", "i"),
    ("u64", "Q"),
    ("i64", "q"),
    ("f32", "f"),
    ("f64", "d"),
)


class Attribute:
    def __init__(self, fields):
        code, self.components, flags = fields.unpack("BBB")
        require(1 <= code <= len(NUMBERS), "type %d of an attribute, expected 1 to 10" % code)
        require(flags < 4, "flags 0x%02x of an attribute, of which all bits but 0 and 1 must be 0" % flags)
        self.type, letter = NUMBERS[code - 1]
        self.name, self.unit, self.las_name = [self.text(fields) for _ in range(3)]
        self.scale = fields.unpack("2d") if flags & 1 else None
        self.number, self.row = struct.Struct("<" + letter), struct.Struct("<%d%s" % (self.components, letter))
        self.unknown = fields.take(self.number.size) if flags & 2 else None
        require(self.name, "an attribute whose name has 0 bytes, expected 1 to 255")
        for text in (self.name, self.unit, self.las_name):
            is_plain = all(ord(c) >= 32 and not 127 <= ord(c) < 160 for c in text)
            require(is_plain, "name, unit or LAS name of attribute %r is too long or has control characters" % self.name)
        require(self.components, 'attribute "%s" has no components' % self.name)
        if self.scale:
            scale, offset = self.scale
            is_valid = math.isfinite(scale) and math.isfinite(offset) and scale != 0
            require(is_valid, 'attribute "%s" has the scale %g and the offset %g' % (self.name, scale, offset))

    @staticmethod
    def text(fields):
        (length,) = fields.unpack("B")
        return utf8(fields.take(length), "a text")

    def words(self, data):
        """The stored numbers in some bytes, as in a text twin."""
        size = self.number.size
        return [number_word(self.type, self.number, data[at : at + size]) for at in range(0, len(data), size)]


def attributes_of(fields):
    require(fields.data, "no attribute is listed")
    attributes = []
    try:
        while fields.data:
            attributes.append(Attribute(fields))
    except Malformed as error:
        raise Malformed('header record "attr": %s' % str(error).replace("cut off", "it ends within an attribute")) from None
    names = sorted(attribute.name for attribute in attributes)
    for a, b in zip(names, names[1:]):
        require(a != b, 'two attributes "%s"' % a)
    length = sum(attribute.row.size for attribute in attributes)
    require(length <= 1024, "rows of %d bytes, the maximum is 1024" % length)
    return attributes


def number_word(kind, layout, data):
    (number,) = layout.unpack(data)
    if kind[0] != "f":
        return str(number)
    if math.isnan(number):
        return "0x" + data[::-1].hex()
    if math.isinf(number):
        return "inf" if number > 0 else "-inf"
    return decimal(number) if kind == "f64" else shortest32(number)


def shortest32(number):
    """The shortest decimal that reads back as the same binary32 value; of several, the closest one."""
    for digits in range(9):
        text = "%.*e" % (digits, number)
        try:
            if struct.pack("<f", float(text)) == struct.pack("<f", number):
                break
        except OverflowError:
            pass  # Rounded up beyond the greatest number.
    return decimal(float(text))


# --- 2.3 Finalization tree ----------------------------------------------------------------------------------


class Tree:
    def __init__(self, dims, origin, side, depth):
        self.dims, self.origin, self.side, self.depth = dims, origin, side, depth
        out_of_range = "the finalization tree is out of range or not exact"
        require(self.depth <= (31 if dims == 2 else 20), out_of_range)
        require(2.0**-1022 <= self.side < math.inf and math.frexp(self.side)[0] == 0.5, out_of_range)
        unit = self.side / 2.0**31
        for origin in self.origin:
            steps = origin / unit
            require(steps.is_integer() and steps * unit == origin, out_of_range)
            require(abs(steps) + 2.0**31 < 2.0**53 and origin + self.side < math.inf, out_of_range)

    def contains(self, point):
        for x, origin in zip(point[: self.dims], self.origin):
            if not origin <= x < origin + self.side:
                return False
        return True

    def level(self, code):
        """The level of a location code, or None if it is not a cell of the tree."""
        bits = code.bit_length() - 1
        return bits // self.dims if code > 0 and bits % self.dims == 0 and bits // self.dims <= self.depth else None

    def deepest(self, code):
        """The range of deepest cells in a cell: first code and one past the last."""
        shift = self.dims * (self.depth - self.level(code))
        return code << shift, (code + 1) << shift

    def corners(self, code):
        level, low, high = self.level(code), [], []
        for axis in range(self.dims):
            index = 0
            for group in reversed(range(level)):
                index = index << 1 | code >> (group * self.dims + axis) & 1
            side = self.side / 2.0**level
            low.append(self.origin[axis] + index * side)
            high.append(self.origin[axis] + (index + 1) * side)
        return low, high

    def code_of(self, point):
        """The location code of the deepest cell with a point, by halving, so that every border is exact."""
        code, low, side = 1, list(self.origin), self.side
        for _ in range(self.depth):
            side /= 2
            bits = 0
            for axis in range(self.dims):
                if point[axis] >= low[axis] + side:
                    low[axis] += side
                    bits |= 1 << axis
            code = code << self.dims | bits
        return code


# --- 4.3 Finalization tags ----------------------------------------------------------------------------------


class FinalCells:
    """The final cells of the deepest level, as disjoint ranges; adjacent ranges are merged."""

    def __init__(self, tree):
        self.tree, self.starts, self.ends = tree, [], []
        self.open = None

    def is_final(self, start, end):
        at = bisect.bisect_right(self.starts, start) - 1
        return at >= 0 and end <= self.ends[at]

    def is_open(self, start, end):
        at = bisect.bisect_left(self.starts, end) - 1
        return at < 0 or self.ends[at] <= start

    def tag(self, code):
        require(self.tree.level(code) is not None, "location code %d is not a cell of the tree" % code)
        start, end = self.tree.deepest(code)
        require(not self.is_final(start, end), "cell %d is final already" % code)
        first = bisect.bisect_left(self.ends, start)
        last = bisect.bisect_right(self.starts, end)
        if first < last:
            start, end = min(start, self.starts[first]), max(end, self.ends[last - 1])
        self.starts[first:last], self.ends[first:last] = [start], [end]
        self.open = None

    def check(self, point):
        if self.open:
            low, high = self.open
            if all(a <= x < b for a, x, b in zip(low, point, high)):
                return
        code = self.tree.code_of(point)
        require(not self.is_final(*self.tree.deepest(code)), "point %r lies in a cell that is final" % (point,))
        while code > 1 and self.is_open(*self.tree.deepest(code >> self.tree.dims)):
            code >>= self.tree.dims
        self.open = self.tree.corners(code)


class Chunks:
    """Checks chunked streams: points between two runs of tags must lie in one cell of the second run."""

    def __init__(self, tree):
        self.tree, self.box, self.in_tags = tree, None, False

    def points(self, points):
        if points and self.in_tags:
            self.end()
            self.in_tags = False
        for point in points:
            if self.box is None:
                self.box = (list(point), list(point))
            self.box = ([min(p) for p in zip(self.box[0], point)], [max(p) for p in zip(self.box[1], point)])

    def tag(self, code):
        self.in_tags = True
        if self.box:
            low, high = self.tree.corners(code)
            if all(a <= x <= y < b for a, x, y, b in zip(low, self.box[0], self.box[1], high)):
                self.box = None

    def end(self):
        require(
            self.box is None,
            "the stream is chunked, but the points before the last tag do not lie in one cell of it",
        )


# --- 4.16 Compressed payloads -------------------------------------------------------------------------------

PAYLOAD_MAX = 2**20
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
DAMAGED_FRAME = "the zstd frame is damaged, or its content is too long"


class NoZstd(Exception):
    """The input needs zstd, and this Python has no module for it."""


def decompressed(data):
    """The payload that a compressed payload stands for."""
    require(data, "compressed payload: empty, expected a method")
    require(data[0] in METHODS, "compressed payload: method %d, expected 1, 2 or 3" % data[0])
    try:
        return METHODS[data[0]](Fields(data[1:]))
    except Malformed as error:
        raise Malformed("compressed payload of method %d: %s" % (data[0], error)) from None


class Fields:
    """Takes fields off the front of bytes."""

    def __init__(self, data):
        self.data = data

    def take(self, length):
        require(length <= len(self.data), "cut off")
        taken, self.data = self.data[:length], self.data[length:]
        return taken

    def unpack(self, layout):
        layout = struct.Struct("<" + layout)
        return layout.unpack(self.take(layout.size))


def zigzag(u):
    return -(u + 1 >> 1) if u & 1 else u >> 1


def int32(number):
    return (number + 2**31) % 2**32 - 2**31


def frame_content(frame, limit):
    """The content of one zstd frame, at most `limit` bytes. Frames of raw and repeated bytes need no module."""
    fields, content = Fields(frame), bytearray()
    try:
        require(fields.take(4) == ZSTD_MAGIC, "no frame")
        (descriptor,) = fields.take(1)
        is_single = descriptor >> 5 & 1
        require(not descriptor & 8, "reserved bit")
        window = (fields.take(1 - is_single) or b"\0")[0]
        dictionary = fields.take((0, 1, 2, 4)[descriptor & 3])
        size = fields.take((is_single, 2, 4, 8)[descriptor >> 6])
        is_last, is_plain = False, not descriptor & 4
        while not is_last:
            head = int.from_bytes(fields.take(3), "little")
            is_last, kind, length = head & 1, head >> 1 & 3, head >> 3
            body = fields.take(1 if kind == 1 else length)
            is_plain = is_plain and kind < 2
            if is_plain and len(content) <= limit:
                content += body * length if kind == 1 else body
        fields.take(descriptor & 4)
        require(not fields.data, "bytes behind the frame")
    except Malformed:
        raise Malformed("not one zstd frame") from None
    require((8 + (window & 7)) << (window >> 3) <= 2**16, "a zstd frame with a window above 2^23 bytes")
    if not is_plain:
        content = zstd_content(frame, limit)
    elif size:
        stated = int.from_bytes(size, "little") + (256 if len(size) == 2 else 0)
        require(stated == len(content), DAMAGED_FRAME)
    require(not any(dictionary) and len(content) <= limit, DAMAGED_FRAME)
    return bytes(content)


def zstd_content(frame, limit):
    """The content of a frame, by the module of Python 3.14 or else by `zstandard`; at most one byte too many."""
    try:
        from compression import zstd
    except ImportError:
        zstd = None
    try:
        if zstd:
            decompressor = zstd.ZstdDecompressor()
            content = decompressor.decompress(frame, limit + 1)
            require(decompressor.eof or len(content) > limit, DAMAGED_FRAME)
            return content
        import zstandard as zstd

        return zstd.ZstdDecompressor().stream_reader(frame).read(limit + 1)
    except ImportError:
        message = "the stream is compressed: install zstandard (pip install zstandard), or use Python 3.14 or newer"
        raise NoZstd(message) from None
    except (zstd.ZstdError, EOFError):
        raise Malformed(DAMAGED_FRAME) from None


class Columns:
    """Columns of numbers: section 4.16.1."""

    def __init__(self, fields, tokens_max):
        (length,) = fields.unpack("I")
        self.tokens = Fields(frame_content(fields.take(length), tokens_max))
        self.bits, self.next, self.count = int.from_bytes(fields.data, "little"), 0, 8 * len(fields.data)

    def bytes(self, count):
        require(count <= len(self.tokens.data), "too few tokens")
        return self.tokens.take(count)

    def column(self, count, k):
        require(k <= 7, "a parameter k above 7")
        numbers = []
        for token in self.bytes(count):
            if token < 2 << k:
                numbers.append(token)
                continue
            raw = (token >> k) - 1
            require(raw + k <= 31, "a token stands for no number of 32 bits")
            numbers.append((token - (raw << k) << raw) + self.take_bits(raw))
        return numbers

    def take_bits(self, count):
        require(self.next + count <= self.count, "too few bits")
        # Shifting the whole integer for each number would take quadratic time.
        start = self.next & ~0xFFF
        if start != getattr(self, "start", None):
            self.start, self.window = start, self.bits >> start & (1 << 0x1020) - 1
        self.next += count
        return self.window >> self.next - count - start & (1 << count) - 1

    def end(self):
        require(not self.tokens.data, "tokens are left")
        require(self.count - self.next < 8, "bits are left")


# --- 4.16.2 Method 1: points


def method_points(fields):
    (count,) = fields.unpack("I")
    require(1 <= count <= PAYLOAD_MAX // 12, "no points, or more than fit a block")
    axes = [fields.unpack("BBi") for _ in range(3)]
    require(all(predictor < 2 for predictor, _, _ in axes), "a predictor above 1")
    columns = Columns(fields, 3 * count)
    keys, coordinates = [0] * count, []
    for axis, (predictor, k, first) in enumerate(axes):
        column = columns.column(count, k)
        residuals = [0] * count
        # sorted() keeps the order of points with the same key.
        places = sorted(range(count), key=keys.__getitem__) if axis else range(count)
        for place, residual in zip(places, column):
            residuals[place] = residual
        keys = [key + residual.bit_length() for key, residual in zip(keys, residuals)]
        coordinates.append(walk(predictor, first, residuals))
    columns.end()
    return b"".join(struct.pack("<3i", *point) for point in zip(*coordinates))


def walk(predictor, at, residuals):
    """The coordinates of an axis."""
    differences, coordinates = [0] * 5, []
    for residual in residuals:
        difference = zigzag(residual)
        if predictor:
            difference = int32(difference + sorted(differences)[2])
            differences = differences[1:] + [difference]
        at = int32(at + difference)
        coordinates.append(at)
    return coordinates


# --- 4.16.3 Method 2: triangles


def method_triangles(fields):
    head = fields.data[:24]
    _, new, imported, count, finalized = fields.unpack("Q4I")
    vertices, marks_length = new + imported, (new + imported + 7) // 8
    length = 24 + 12 * new + 8 * imported + 12 * count + 4 * finalized
    require(length <= PAYLOAD_MAX, "counts of more than fits a block")
    ks = fields.take(8)
    columns = Columns(fields, 4 * count + 3 * new + 2 * imported + marks_length)
    operations = columns.bytes(count)
    counts = [0, 0, 0]
    for operation in operations:
        require(operation <= 152, "an operation above 152")
        for number in takes(operation):
            counts[number] += 1
    numbers = [iter(columns.column(count, k)) for count, k in zip(counts, ks)]
    walk = Triangles(new, vertices, numbers)
    for operation in operations:
        walk.triangle(operation)
    residuals = [columns.column(new, k) for k in ks[3:6]]
    points = []
    for vertex, parent in enumerate(walk.parents):
        base = points[parent] if vertex else (0, 0, 0)
        points.append(tuple(int32(c + zigzag(axis[vertex])) for c, axis in zip(base, residuals)))
    ids = id_list(columns.column(imported, ks[6]), columns.column(imported, ks[7]))
    marks = int.from_bytes(columns.bytes(marks_length), "little")
    marked = [vertex for vertex in range(8 * marks_length) if marks >> vertex & 1]
    require(len(marked) == finalized, "another number of finalized vertices than the count")
    require(not marked or marked[-1] < vertices, "a finalized vertex that does not exist")
    columns.end()
    parts = [head] + [struct.pack("<3i", *point) for point in points] + [struct.pack("<%dQ" % imported, *ids)]
    parts += [struct.pack("<3I", *triangle) for triangle in walk.triangles]
    return b"".join(parts + [struct.pack("<%dI" % finalized, *marked)])


def takes(operation):
    """The columns of which an operation takes a number: 0 distances, 1 references, 2 imports."""
    if operation < 27:
        return [way for way in (operation // 9, operation // 3 % 3, operation % 3) if way]
    operation -= 27
    way = operation // 9 % 7
    return ([] if operation // 63 else [0]) + ([way] if way in (1, 2) else [])


def id_list(low, high):
    ids, before = [], 0
    for pair in zip(low, high):
        before = (before + pair[0] + (pair[1] << 32)) % 2**64
        ids.append(before)
    return ids


class Triangles:
    def __init__(self, new, vertices, numbers):
        self.new, self.vertices = new, vertices
        self.distances, self.references, self.imports = numbers
        self.next, self.last = 0, new
        self.triangles, self.parents = [], [max(vertex - 1, 0) for vertex in range(new)]
        self.leave, self.reach = [()] * vertices, [()] * vertices

    def given(self, way):
        if way == 2:
            self.last = (self.last + zigzag(next(self.imports))) % 2**32
            require(self.new <= self.last < self.vertices, "an imported vertex that does not exist")
            return self.last
        if way == 1:
            number = next(self.references)
            vertex = self.next - 1 - number if number < self.next else number
        else:
            vertex = self.next
            self.next += 1
        require(vertex < self.new, "a new vertex that does not exist")
        return vertex

    def triangle(self, operation):
        first = self.next
        if operation < 27:
            entered = triangle = [self.given(way) for way in (operation // 9, operation // 3 % 3, operation % 3)]
        else:
            near, way, edge, rotation = (operation - 27) // 63, (operation - 27) // 9 % 7, operation // 3 % 3, operation % 3
            distance = 1 if near else next(self.distances) + 2
            require(distance <= len(self.triangles), "a distance to before the first triangle")
            base = self.triangles[-distance]
            q, p = base[edge], base[(edge + 1) % 3]
            x = self.given(way) if way < 3 else self.remembered(p, q, way)
            entered = [p, q, x]
            triangle = entered[3 - rotation :] + entered[: 3 - rotation]
        require(len(set(triangle)) == 3, "a triangle that uses a vertex twice")
        for a, b in zip(entered, entered[1:] + entered[:1]):
            self.enter(a, b)
        for vertex in range(first, self.next):
            self.parents[vertex] = max([v for v in triangle if v < vertex], default=self.parents[vertex])
        self.triangles.append(triangle)

    def remembered(self, p, q, way):
        edges, age = (self.leave[p], self.reach[q])[(way - 3) % 2], (way - 3) // 2
        require(age < len(edges), "an open edge that does not exist")
        return edges[age]

    def enter(self, a, b):
        if b in self.reach[a] or a in self.leave[b]:
            self.reach[a], self.leave[b] = without(self.reach[a], b), without(self.leave[b], a)
        else:
            self.leave[a], self.reach[b] = ((b,) + self.leave[a])[:2], ((a,) + self.reach[b])[:2]


def without(edges, vertex):
    if vertex not in edges:
        return edges
    at = edges.index(vertex)
    return edges[:at] + edges[at + 1 :]


# --- 4.16.4 Method 3: records


def method_records(fields):
    record, width, length = fields.unpack("HBI")
    require(width in (0, 4, 8), "words of another width than 0, 4 or 8")
    require(
        record and not (width and record % width), "records of 0 bytes, or of no whole number of words"
    )
    require(length <= PAYLOAD_MAX, "more bytes than fit a block")
    content = frame_content(fields.data, length)
    require(len(content) == length, "the zstd frame has fewer bytes than the payload")
    count = length // record
    payload = bytearray(content)
    for place in range(record if count else 0):
        payload[place : count * record : record] = content[place * count : (place + 1) * count]
    if width:
        words = list(struct.unpack_from("<%d%s" % (count * record // width, "I" if width == 4 else "Q"), payload))
        per_record = record // width
        for at, word in enumerate(words):
            before = words[at - per_record] if at >= per_record else 0
            words[at] = (before + zigzag(word)) % 2 ** (8 * width)
        struct.pack_into("<%d%s" % (len(words), "I" if width == 4 else "Q"), payload, 0, *words)
    return bytes(payload)


METHODS = {1: method_points, 2: method_triangles, 3: method_records}


# --- 1, 4 Stream and blocks ---------------------------------------------------------------------------------


class Stream:
    """Reads a stream block by block, and prints it."""

    def __init__(self, source, text):
        self.source, self.text = source, text
        self.where, self.offset = "header at byte 0", 0
        self.total = dict.fromkeys("points cells vertices simplices merged residual walls".split(), 0)
        self.live = {}
        self.waiting, self.rows = None, b""
        self.last, self.words, self.neighbour = None, [], -1
        self.degree = self.group = self.boundary = self.function = None
        self.has_pairs = False
        self.finalized = self.named = self.labels = self.phase = 0
        self.segments, self.open = 0, -1
        # The number of the region, its points, those of them so far, and points that later regions must have, too.
        self.region, self.stated, self.found, self.shared = 0, 0, 0, 0
        # What blocks before the next patch say about it, by their tags.
        self.more = {}

    def take(self, length):
        data = self.source.read(length)
        require(len(data) == length, "truncated: found %d of %d bytes" % (len(data), length))
        self.offset += length
        return data

    def read(self):
        start = self.source.read(16)
        require(start, "the input is empty, expected a spmesh stream")
        require(MAGIC.startswith(start[:8]), "the first bytes are not those of a spmesh stream")
        require(len(start) == 16, "truncated: found %d of the first 16 bytes" % len(start))
        self.offset = 16
        version, _, length = struct.unpack("<HHI", start[8:])
        if version < 2:
            raise TooNew(
                "version %d; this program reads version 2 only: an older spmesh made it, make it again from its input"
                % version
            )
        if version > 2:
            raise TooNew("version %d; this program reads version 2: a newer spmesh made it" % version)
        require(
            16 <= length <= 2**20,
            "header body of %d bytes, the minimum is 16, the maximum is %d" % (length, 2**20),
        )
        data = start + self.take(length)
        require(
            crc32c(data) == int.from_bytes(self.take(4), "little"),
            "checksum does not match: the header is damaged",
        )
        self.header = Header(data)
        self.text.header(self.header)
        tree = self.header.tree
        self.cells = FinalCells(tree) if tree else None
        self.chunks = Chunks(tree) if self.header.chunked else None
        block = 0
        while self.block(block) != b"END ":
            block += 1

    def block(self, number):
        self.where = "block %d at byte %d" % (number, self.offset)
        frame = self.take(16)
        tag, sequence, length, checksum = struct.unpack("<4sIII", frame)
        is_compressed, length = length >> 31, length % 2**31
        require(
            self.header.is_compressed or not is_compressed,
            "a compressed block in a stream without feature bit 0",
        )
        require(length <= 2**20, "block of %d bytes, the maximum is %d" % (length, 2**20))
        payload = self.take(length)
        require(crc32c(frame[:12] + payload) == checksum, "checksum does not match: the block is damaged")
        require(sequence == number % 2**32, "block has sequence number %d, expected %d" % (sequence, number % 2**32))
        readers = {
            b"PNTS": self.points,
            b"CELL": self.tags,
            b"REGN": self.start_region,
            b"PTCH": self.patch,
            b"segm": self.segment,
            b"side": self.side,
            b"open": self.open_segment,
            b"from": self.origins,
            b"kept": self.keep,
            b"LABL": self.label,
            b"RPNT": self.residual,
            b"WALL": self.walls,
            b"PNT4": self.points4,
            b"CEL4": self.cells4,
            b"SIM4": self.simplices4,
            b"CONF": self.configurations,
            b"FUNC": self.functions,
            b"COEF": self.coefficients,
            b"END ": self.end,
        }
        check_tag(tag, "block")
        if not require_known(tag, [*readers, b"attp"], "block tag"):
            return tag
        if tag == b"attp" or self.waiting:
            return self.attributes(tag, payload, is_compressed, readers)
        is_next = not self.more or tag == b"PTCH" or list(self.more) == [b"from"] and tag == b"kept"
        of = "sides" if b"side" in self.more else "vertices of other parts"
        require(is_next, 'block "%s", expected the patch of the %s' % (escaped(tag), of))
        if tag != b"END ":
            phase = next((i for i, tags in enumerate(self.header.phases) if tag in tags), -1)
            require(
                phase >= self.phase,
                "no block %r may stand here in a stream of kind %s" % (tag.decode(), self.header.kind),
            )
            self.phase = phase
        require(
            tag not in (b"segm", b"side", b"open") or self.header.constrained,
            'block "%s" in a stream that is not constrained' % escaped(tag),
        )
        require(
            tag not in (b"from", b"kept") or self.header.part,
            'block "%s" in a stream that is no part of a mesh' % escaped(tag),
        )
        if is_compressed:
            require(tag != b"END ", "END is compressed: it must not be")
            payload = decompressed(payload)
        count = self.points_in(tag, payload) if self.header.attributes else 0
        if count:
            self.waiting = tag, payload, count, self.where
        else:
            readers[tag](payload)
        return tag

    # --- 4.14 attp

    def points_in(self, tag, payload):
        """The number of points of a block that rows follow."""
        if tag == b"PTCH":
            return int.from_bytes(payload[8:12], "little")
        size = {b"PNTS": self.header.record.size, b"RPNT": 8 + self.header.record.size}.get(tag, len(payload) + 1)
        return len(payload) // size

    def attributes(self, tag, payload, is_compressed, readers):
        """Reads the block behind points."""
        require(self.header.attributes, 'block "attp" in a stream without attributes')
        require(self.waiting, 'no block "attp" may stand here: no points precede')
        require(
            tag == b"attp", 'block "%s", expected the attributes of the points before it' % escaped(tag)
        )
        rows = decompressed(payload) if is_compressed else payload
        waiting, payload, count, where = self.waiting
        length = self.header.row_length()
        require(
            len(rows) == count * length,
            "%d bytes of attributes, expected %d rows of %d bytes" % (len(rows), count, length),
        )
        self.header.check_rows(rows)
        self.waiting, self.where = None, where
        self.text.take_rows(rows)
        readers[waiting](payload)
        return tag

    def points(self, payload):
        points = self.header.points_of(payload)
        if self.cells:
            for point in points:
                self.cells.check(point)
        if self.chunks:
            self.chunks.points(points)
        if self.header.has_regions:
            require(self.region, "points before the first region")
            self.found += len(points)
            require(
                self.found <= self.stated,
                "region %d states %d points, at least %d follow" % (self.region, self.stated, self.found),
            )
        else:
            self.total["points"] += len(points)
        self.text.vertices(points)

    def tags(self, payload):
        require(self.cells, "cell tag in a stream without a finalization tree")
        require(len(payload) % 8 == 0, "%d bytes are not a whole number of records of 8" % len(payload))
        for (code,) in struct.iter_unpack("<Q", payload):
            self.cells.tag(code)
            if self.chunks:
                self.chunks.tag(code)
            self.total["cells"] += 1
            self.text.line("x cell %d" % code)

    def patch(self, payload):
        require(len(payload) >= 24, "patch of %d bytes, expected at least 24" % len(payload))
        first, n, m, s, f = struct.unpack_from("<QIIII", payload)
        corners = self.header.dims + 1
        lengths = [n * self.header.record.size, m * 8, s * corners * 4, f * 4]
        require(24 + sum(lengths) == len(payload), "the counts of the patch do not add up to its length")
        require(
            first == self.total["vertices"],
            "patch starts with vertex %d, expected %d" % (first, self.total["vertices"]),
        )
        at = 24 + lengths[0]
        new = self.header.points_of(payload[24:at])
        imported = struct.unpack_from("<%dQ" % m, payload, at)
        simplices = struct.unpack_from("<%dI" % (corners * s), payload, at + lengths[1])
        finalized = struct.unpack_from("<%dI" % f, payload, at + lengths[1] + lengths[2])
        require(
            is_increasing(imported) and (m == 0 or imported[-1] < first),
            "imported vertices are not increasing ids of earlier patches",
        )
        require(
            is_increasing(finalized) and (f == 0 or finalized[-1] < n + m),
            "finalized vertices are not increasing indices of the patch",
        )
        require(s == 0 or max(simplices) < n + m, "simplex uses a vertex that its patch does not have")
        more, self.more = self.more, {}
        origins, kept = dict(more.get(b"from", [])), more.get(b"kept", ())
        self.check_shared(more.get(b"from", []), kept, n, finalized)
        for vertex in imported:
            require(vertex in self.live, "vertex %d referenced after finalization" % vertex)
        ids = list(range(first, first + n)) + list(imported)
        simplices = list(zip(*[iter(simplices)] * corners))
        for simplex in simplices:
            require(len(set(simplex)) == corners, "simplex %r uses a vertex twice" % (simplex,))
        self.live.update(zip(range(first, first + n), new))
        for local in finalized:
            del self.live[ids[local]]
        self.total["vertices"] += n
        self.total["simplices"] += s
        self.finalized += f
        simplices = [[ids[local] for local in simplex] for simplex in simplices]
        sides = more.get(b"side", [])
        for triangle, place, segment in sides:
            require(triangle < s, "a side of triangle %d of %d in its patch" % (triangle, s))
            require(place < 3, "side %d of a triangle, expected 0, 1 or 2" % place)
            require(segment < self.segments, "a side on segment %d of %d" % (segment, self.segments))
        require(is_increasing([side[:2] for side in sides]), "sides are not increasing by triangle and place")
        before = self.total["simplices"] - s
        sides = [(before + triangle, place, segment) for triangle, place, segment in sides]
        origins = {ids[local]: vertex for local, vertex in origins.items()}
        finalized, kept = [[ids[local] for local in locals] for locals in (finalized, kept)]
        self.text.patch(first, new, simplices, sides, finalized, origins, kept)

    # --- 4.17 segm, side, open

    def segment(self, payload):
        layout = struct.Struct("<I4" + ("i" if self.header.is_integer else "d"))
        require(
            len(payload) % layout.size == 0,
            "%d bytes are not a whole number of records of %d" % (len(payload), layout.size),
        )
        for line, *ends in layout.iter_unpack(payload):
            require(all(map(math.isfinite, ends)), "a coordinate of a segment is not finite")
            require(ends[:2] != ends[2:], "a segment of line %d has equal ends" % line)
            self.segments += 1
            require(self.segments <= 2**32, "more than %d segments" % 2**32)
            self.text.line("segment %d %s" % (line, self.text.plane(ends)))

    def side(self, payload):
        require(len(payload) % 12 == 0, "%d bytes are not a whole number of records of 12" % len(payload))
        self.more[b"side"] = list(struct.iter_unpack("<3I", payload))

    def open_segment(self, payload):
        require(len(payload) % 4 == 0, "%d bytes are not a whole number of records of 4" % len(payload))
        for (segment,) in struct.iter_unpack("<I", payload):
            require(segment < self.segments, "open segment %d of %d" % (segment, self.segments))
            require(segment > self.open, "open segments are not increasing")
            self.open = segment
            self.text.line("open %d" % (segment + 1))

    # --- 4.18 from, kept

    def origins(self, payload):
        require(len(payload) % 12 == 0, "%d bytes are not a whole number of records of 12" % len(payload))
        self.more[b"from"] = list(struct.iter_unpack("<IQ", payload))

    def keep(self, payload):
        require(len(payload) % 4 == 0, "%d bytes are not a whole number of records of 4" % len(payload))
        self.more[b"kept"] = struct.unpack("<%dI" % (len(payload) // 4), payload)

    def check_shared(self, origins, kept, new, finalized):
        """What blocks before a patch say about vertices of other parts."""
        locals = [local for local, _ in origins]
        require(
            is_increasing(locals) and (not locals or locals[-1] < new),
            "vertices of other parts are not increasing numbers of new vertices",
        )
        for _, vertex in origins:
            part, own = vertex >> NUMBER_BITS, self.header.part[1]
            require(part < own, "a vertex of part %d, expected one before part %d" % (part, own))
        final = set(finalized)
        for before, local in zip((-1,) + tuple(kept), kept):
            require(
                before < local and local in final,
                "vertex %d of the patch is kept for other parts, but not finalized here, or not in order" % local,
            )

    # --- 4.19 REGN

    def start_region(self, payload):
        require(len(payload) == 80, "region of %d bytes, expected 80" % len(payload))
        self.end_region()
        *box, own, first, again, last = struct.unpack("<6d4Q", payload)
        self.region += 1
        require(
            all(low < high for low, high in zip(box[:3], box[3:])),
            "region %d: the box is empty, or a side is NaN" % self.region,
        )
        self.stated, self.found = own + first + again + last, 0
        self.total["points"] += own + first
        require(
            max(self.stated, self.total["points"]) < UNKNOWN,
            "region %d: its points are beyond counting, at most 2^64 - 2" % self.region,
        )
        require(
            again + last <= self.shared,
            "region %d has %d points of earlier regions, but these share %d with later ones"
            % (self.region, again + last, self.shared),
        )
        self.shared += first - last
        self.text.line("region %s %d %d %d %d" % (decimals(box), own, first, again, last))

    def end_region(self):
        require(
            self.found == self.stated,
            "region %d states %d points, %d follow" % (self.region, self.stated, self.found),
        )

    def label(self, payload):
        require(len(payload) % 8 == 0, "%d bytes are not a whole number of records of 8" % len(payload))
        self.labels += len(payload) // 8
        vertices = self.total["vertices"]
        require(self.labels <= vertices, "%d labels after %d vertices" % (self.labels, vertices))
        for (label,) in struct.iter_unpack("<Q", payload):
            self.text.line("label %d" % label)

    def residual(self, payload):
        size = 8 + self.header.record.size
        require(len(payload) % size == 0, "%d bytes are not a whole number of records of %d" % (len(payload), size))
        for at in range(0, len(payload), size):
            (vertex,) = struct.unpack_from("<Q", payload, at)
            point = self.header.point(self.header.record.unpack_from(payload, at + 8))
            if vertex != UNKNOWN and self.header.is_residual:
                is_known = vertex >> NUMBER_BITS <= self.header.part[1]
                require(is_known, "residual point has the id %d of no vertex" % vertex)
            elif vertex != UNKNOWN:
                require(vertex < self.total["vertices"], "residual point has the id %d of no vertex" % vertex)
                require(vertex in self.live, "residual point names vertex %d, which is not live" % vertex)
                require(
                    self.live.pop(vertex) == point,
                    "residual point has other coordinates than its vertex %d" % vertex,
                )
                self.named += 1
            self.total["residual"] += 1
            self.text.residual(None if vertex == UNKNOWN else vertex, point)

    def walls(self, payload):
        corners = self.header.dims
        size = 4 * corners
        require(len(payload) % size == 0, "%d bytes are not a whole number of records of %d" % (len(payload), size))
        for wall in struct.iter_unpack("<%dI" % corners, payload):
            require(
                len(set(wall)) == corners and max(wall) < self.total["residual"],
                "wall %s between no %d residual points" % (" to ".join(map(str, wall)), corners),
            )
            self.total["walls"] += 1
            self.text.line("w " + " ".join(str(corner + 1) for corner in wall))

    def points4(self, payload):
        size = self.header.record.size
        require(len(payload) % size == 0, "%d bytes are not a whole number of records of %d" % (len(payload), size))
        for at in range(0, len(payload), size):
            record = self.header.record.unpack_from(payload, at)
            point, value = record[:4], record[4:]
            require(all(map(math.isfinite, point)), "coordinate is not finite")
            if value:
                stored = payload[at + 32 : at + 40]
                require(
                    math.isfinite(value[0]) or stored == NOT_KNOWN,
                    "value %r is neither finite nor the NaN of what is not known" % stored.hex(),
                )
            if self.header.kind == "cells in 4 dimensions":
                require(self.last is None or self.last < point, "point %r does not follow the one before it" % (point,))
                self.last = point
            self.total["vertices" if self.header.is_mesh else "points"] += 1
            words = [decimal(x) for x in point] + ["nan" if math.isnan(x) else decimal(x) for x in value]
            self.text.line("v4 " + " ".join(words))

    def cells4(self, payload):
        require(len(payload) % 4 == 0, "%d bytes are not a whole number of records of 4" % len(payload))
        self.words += struct.unpack("<%dI" % (len(payload) // 4), payload)
        at = 0
        while len(self.words) > at:
            infinite, vertices = self.words[at] >> 31, self.words[at] & 0x7FFFFFFF
            self.check_vertex_count(infinite, vertices)
            if len(self.words) == at + 1:
                break
            neighbours, corners = self.words[at + 1], vertices + infinite
            require(
                neighbours <= corners * (corners - 3) // 2,
                "cell of %d vertices and %d neighbours, which can have %d facets at most"
                % (vertices, neighbours, corners * (corners - 3) // 2),
            )
            require(
                2 + vertices + neighbours <= 2**31,
                "cell of %d vertices and %d neighbours, the maximum is 2^31 words" % (vertices, neighbours),
            )
            middle, end = at + 2 + vertices, at + 2 + vertices + neighbours
            if end > len(self.words):
                break
            self.cell4(infinite, self.words[at + 2 : middle], self.words[middle:end])
            at = end
        del self.words[:at]

    def check_vertex_count(self, infinite, vertices):
        least, points = (4 if infinite else 5), self.total["vertices"]
        sort = "an infinite" if infinite else "a finite"
        require(vertices >= least, "%s cell of %d vertices, expected at least %d" % (sort, vertices, least))
        require(vertices <= points, "%s cell of %d vertices, but %d points" % (sort, vertices, points))

    def cell4(self, infinite, vertices, neighbours):
        points = self.total["vertices"]
        require(
            is_increasing(vertices) and vertices[-1] < points,
            "the vertices of a cell are not increasing numbers of %d points" % points,
        )
        require(is_increasing(neighbours), "the neighbours of a cell are not increasing")
        self.neighbour = max([self.neighbour] + neighbours[-1:])
        self.total["simplices"] += 1
        self.text.numbers("i4" if infinite else "c4", vertices)
        self.text.numbers("n4", neighbours)

    def simplices4(self, payload):
        require(len(payload) % 20 == 0, "%d bytes are not a whole number of records of 20" % len(payload))
        points = self.total["vertices"]
        for simplex in struct.iter_unpack("<5I", payload):
            require(max(simplex) < points, "simplex uses vertex %d of %d" % (max(simplex), points))
            require(len(set(simplex)) == 5, "simplex %r uses a vertex twice" % (simplex,))
            self.total["simplices"] += 1
            self.text.numbers("s4", simplex)

    def configurations(self, payload):
        require(len(payload) >= 12, "configurations in %d bytes, expected at least 12" % len(payload))
        degree, standing, groups = struct.unpack_from("<3I", payload)
        require(degree <= 4096, "configurations of degree %d, the maximum is 4096" % degree)
        require(standing < 3, "configurations of standing %d, expected 0, 1 or 2" % standing)
        unfit = "the counts of the configurations do not add up to the block's length"
        start = 12 + groups * (degree + 1) * 4
        require(start <= len(payload), unfit)
        counts = struct.unpack_from("<%dI" % groups, payload, 12 + groups * degree * 4)
        require(start + sum(counts) * 12 == len(payload), unfit)
        self.start_degree(degree, standing)
        at = start
        for number, count in enumerate(counts):
            interior = struct.unpack_from("<%dI" % degree, payload, 12 + number * degree * 4)
            self.start_group(interior, number == 0)
            require(count > 0, "interior set %r has no configuration" % (interior,))
            for boundary in struct.iter_unpack("<3I", payload[at : at + count * 12]):
                self.configuration(interior, boundary)
            at += count * 12

    def start_degree(self, degree, standing):
        if self.degree:
            last, known = self.degree
            require(degree >= last, "configurations of degree %d after those of %d" % (degree, last))
            require(
                degree == last or self.header.kind != "splines",
                "configurations of degree %d after those of %d: splines have one degree" % (degree, last),
            )
            require(
                degree > last or standing == known,
                "the configurations of degree %d change their standing" % degree,
            )
        self.has_pairs = self.has_pairs or degree == 1
        if self.degree != (degree, standing):
            self.degree, self.group = (degree, standing), None
            self.text.line("degree %d %s" % (degree, ("any", "delaunay", "lifted")[standing]))

    def start_group(self, interior, is_first):
        if is_first and interior == self.group:
            return
        require(
            self.group is None or interior > self.group,
            "interior set %r does not follow %r" % (interior, self.group),
        )
        knots = self.total["points"]
        require(
            is_increasing(interior) and all(knot < knots for knot in interior),
            "interior set %r is not of increasing numbers of %d knots" % (interior, knots),
        )
        self.group, self.boundary = interior, None
        self.text.line("in" + "".join([" %d" % (knot + 1) for knot in interior]))

    def configuration(self, interior, boundary):
        a, b, c = boundary
        knots, infinite, name = self.total["points"], c == FARAWAY, "boundary %r " % (boundary,)
        ends = boundary[:2] if infinite else boundary
        require(
            all(knot < knots and knot != FARAWAY for knot in ends), name + "is not of numbers of %d knots" % knots
        )
        require(len(set(boundary)) == 3, name + "repeats a knot")
        require(infinite or a == min(boundary), name + "does not have its least knot first")
        for knot in ends:
            at = bisect.bisect_left(interior, knot)
            require(
                at == len(interior) or interior[at] != knot,
                name + "has knot %d, which is in the interior set %r" % (knot, interior),
            )
        if self.boundary:
            was = self.boundary[2] == FARAWAY
            require(
                infinite > was or infinite == was and (not interior or self.boundary < boundary),
                name + "does not follow %r in its group" % (self.boundary,),
            )
        self.boundary = boundary
        self.total["simplices"] += 1
        self.text.line(("line" if infinite else "on") + "".join([" %d" % (knot + 1) for knot in ends]))

    def functions(self, payload):
        require(self.has_pairs or not payload, "functions in a stream without configurations of degree 1")
        at = 0
        while at < len(payload):
            at = self.one_function(payload, at)

    def one_function(self, payload, at):
        cut = "a function is cut off at the end of its block"
        require(at + 8 <= len(payload), cut)
        code, count = struct.unpack_from("<2I", payload, at)
        require(code < len(FUNCTIONS), "a function of kind %d, expected 0 to %d" % (code, len(FUNCTIONS) - 1))
        name, corners = FUNCTIONS[code]
        at += 8
        require(at + 4 * corners + 16 * count <= len(payload), cut)
        kind = struct.unpack_from("<%dI" % corners, payload, at)
        at += 4 * corners
        terms = list(struct.iter_unpack("<2Id", payload[at : at + 16 * count]))
        what, knots = "function %s %r " % (name, list(kind)), self.total["points"]
        require(max(kind) < knots, what + "is not of numbers of %d knots" % knots)
        require(len(set(kind)) == corners, what + "repeats a knot")
        require(self.function is None or self.function < (code, kind), what + "does not follow %r" % (self.function,))
        require(terms, what + "has no term")
        for p, q, factor in terms:
            require(p < q < knots, what + "has a term of no increasing numbers of %d knots" % knots)
            require(math.isfinite(factor) and factor != 0, what + "has the factor %r" % factor)
        require(is_increasing([term[:2] for term in terms]), what + "has terms that do not follow each other")
        self.function = (code, kind)
        self.total["vertices"] += 1
        self.text.line("function " + name + "".join([" %d" % (knot + 1) for knot in kind]))
        for p, q, factor in terms:
            self.text.line("term %d %d %s" % (p + 1, q + 1, decimal(factor)))
        return at + 16 * count

    def coefficients(self, payload):
        require(len(payload) % 8 == 0, "coefficients in %d bytes, which is no multiple of 8" % len(payload))
        for (number,) in struct.iter_unpack("<d", payload):
            require(math.isfinite(number), "the coefficient %r is not finite" % number)
            self.total["residual"] += 1
            self.text.line("coefficient " + decimal(number))

    def end(self, payload):
        require(len(payload) == 56, "END of %d bytes, expected 56" % len(payload))
        stated = dict(zip(self.total, struct.unpack("<7Q", payload)))
        counted = dict(self.total)
        for name, total in stated.items():
            require(total < UNKNOWN, "END: %d %s are beyond counting" % (total, name))
        if self.header.is_residual:
            # The points are those of the region, which are vertices of other streams.
            counted["points"], counted["merged"] = stated["points"], stated["merged"]
        elif self.header.is_mesh:
            counted["merged"] = stated["merged"]
            counted["points"] = counted["vertices"] + counted["merged"] + counted["residual"] - self.named
            retired = self.finalized + self.named
            require(
                self.header.is_4d or not self.live and retired == counted["vertices"],
                "END: %d of %d vertices were finalized or handed to the residual" % (retired, counted["vertices"]),
            )
        require(
            self.labels in (0, counted["vertices"]),
            "END: %d labels of %d vertices, expected none, or one for each" % (self.labels, counted["vertices"]),
        )
        functions, coefficients = counted["vertices"], counted["residual"]
        require(
            self.header.kind != "splines" or coefficients > 0 and functions in (0, coefficients),
            "END: %d coefficients of %d functions: one each is needed" % (coefficients, functions),
        )
        require(
            self.header.kind != "splines" or self.degree is not None,
            "END: a spline without configurations, expected a block CONF with its degree",
        )
        require(not self.words, "END: the last cell is cut off after %d words" % len(self.words))
        for name, total in stated.items():
            require(total == counted[name], "END states %d %s, but the stream holds %d" % (total, name, counted[name]))
        require(self.header.points in (UNKNOWN, stated["points"]), "END: the header states another number of points")
        self.end_region()
        require(
            not self.shared,
            "END: %d points that regions share with later ones are in no later one" % self.shared,
        )
        cells = counted["simplices"]
        require(self.neighbour < cells, "END: a cell has the neighbour %d of %d cells" % (self.neighbour, cells))
        if self.chunks:
            self.chunks.end()
        self.end_total = stated
        self.where = "byte %d" % self.offset
        require(not self.source.read(1), "the input goes on after END")
        self.text.line("# end " + " ".join("%s %d" % total for total in stated.items()))


def is_increasing(values):
    return all(a < b for a, b in zip(values, values[1:]))


# --- Text twin (formats/text.md) ----------------------------------------------------------------------------


def decimal(value):
    digits = repr(float(value))
    if "e" in digits:
        return format(Decimal(digits), "f")
    return digits[:-2] if digits.endswith(".0") else digits


def grid_decimal(stored, scale, offset):
    """The shortest decimal that stands for a stored coordinate on the grid."""
    world = stored * scale + offset
    tolerance = (abs(stored * scale) + abs(offset)) * 2.0**-51
    for digits in range(1, 18):
        number = float("%.*e" % (digits - 1, world))
        if abs(number - world) <= tolerance and abs((number - offset) / scale - stored) < 0.5:
            break
    return decimal(number + 0.0)


def decimals(values):
    return " ".join(map(decimal, values))


class Text:
    def __init__(self, write):
        self.write = write

    def line(self, line):
        self.write(line + "\n")

    def header(self, header):
        self.world = self.grid(header) if header.is_integer else decimals
        yes = {True: "yes", False: "no"}
        lines = ["version 2", "kind " + header.kind, "coordinates " + ("i32" if header.is_integer else "f64")]
        if header.is_integer:
            lines += ["scale " + decimals(header.scale), "offset " + decimals(header.offset)]
        lines += ["dims %d" % header.dims, "elevation " + yes[header.has_elevation]]
        if header.bounds:
            lines.append("bounds " + decimals(header.bounds))
        if header.points != UNKNOWN:
            lines.append("points %d" % header.points)
        if header.tree:
            cube = (header.tree.origin + (0,))[:3] + (header.tree.side,)
            lines.append("tree %d %s" % (header.tree.depth, decimals(cube)))
        if header.region:
            lines.append("region " + decimals(header.region))
        lines.append("chunked " + yes[header.chunked])
        if header.wkt is not None:
            lines.append("wkt " + json.dumps(header.wkt, ensure_ascii=False))
        if header.geokeys:
            lines.append("geokeys " + " ".join(record.hex() or "-" for record in header.geokeys))
        for attribute in header.attributes:
            words = [attribute.type, str(attribute.components)]
            words += [json.dumps(text, ensure_ascii=False) for text in (attribute.unit, attribute.las_name)]
            words.append(decimals(attribute.scale) if attribute.scale else "- -")
            words += attribute.words(attribute.unknown) if attribute.unknown else ["-"]
            lines.append("attribute %s %s" % (json.dumps(attribute.name, ensure_ascii=False), " ".join(words)))
        self.attributes = header.attributes
        if header.constrained:
            is_cut, kill = header.constrained
            lines.append("constrained %s %s" % (yes[is_cut], decimal(kill)))
        if header.weighted is not None:
            lines.append("weighted " + decimal(header.weighted))
        if header.part:
            lines.append("part %d %d" % header.part)
        self.plane = self.plane_grid(header) if header.is_integer else decimals
        lines.append("producer " + json.dumps(header.producer, ensure_ascii=False))
        for line in lines:
            self.line("#spmesh " + line)

    def grid(self, header):
        axes = list(zip(header.scale, header.offset))[: header.axes]
        rest = ["0"] * (3 - header.axes)

        def world(point):
            return " ".join([grid_decimal(c, *axis) for c, axis in zip(point, axes)] + rest)

        return world

    def take_rows(self, rows):
        """Takes the rows of the next points."""
        self.rows = Fields(rows)

    def row(self):
        """The line of the row of the next point, if there are attributes."""
        if not self.attributes:
            return ""
        words = [word for attribute in self.attributes for word in attribute.words(self.rows.take(attribute.row.size))]
        return "a %s\n" % " ".join(words)

    def vertices(self, points):
        world = self.world
        self.write("".join(["v %s\n%s" % (world(point), self.row()) for point in points]))

    def plane_grid(self, header):
        """World coordinates of the ends of segments."""
        axes = list(zip(header.scale, header.offset))[:2] * 2

        def world(ends):
            return " ".join([grid_decimal(c, *axis) for c, axis in zip(ends, axes)])

        return world

    def patch(self, first, new, simplices, sides, finalized, origins, kept):
        self.line("# patch")
        self.vertices(new)
        self.write("".join(["from %d %d\n" % (vertex + 1, origins[vertex] + 1) for vertex in sorted(origins)]))
        for simplex in simplices:
            letter = "c" if len(simplex) == 4 else "f"
            self.line(letter + "".join([" %d" % (vertex + 1) for vertex in simplex]))
        self.write("".join(["side %d %d %d\n" % (t + 1, place + 1, s + 1) for t, place, s in sides]))
        self.write("".join(["x %d\n" % (vertex + 1) for vertex in finalized]))
        self.write("".join(["kept %d\n" % (vertex + 1) for vertex in kept]))

    def numbers(self, word, numbers):
        """Numbers counted from 1, at most 4096 per line."""
        for at in range(0, max(len(numbers), 1), 4096):
            self.line((word if at == 0 else "+4") + "".join([" %d" % (n + 1) for n in numbers[at : at + 4096]]))

    def residual(self, vertex, point):
        self.write("r %s %s\n%s" % ("-" if vertex is None else vertex + 1, self.world(point), self.row()))


# --- Meshes in parts (formats/parts.md) ----------------------------------------------------------------------


MANIFEST = {
    "format": str, "version": int, "bounds": (list, type(None)), "points": int, "merged": int, "skipped": list, "parts": list
}
MANIFEST_PART = {
    "name": str, "below": int, "file": str, "bytes": int, "vertices": int, "simplices": int, "box": (list, type(None))
}
SKIPPED = {"file": str, "reason": str}


NO_MANIFEST = "this is JSON, but no manifest of a mesh in parts"


def is_manifest(path):
    """Whether a regular file starts as a manifest does."""
    if not os.path.isfile(path):
        return False
    with open(path, "rb") as file:
        return b"".join(file.read(256).split()).startswith(b'{"format":"spmeshmeshinparts"')


def fields_of(found, expected, what):
    """Checks the names of the fields of an object, and their types."""
    message = NO_MANIFEST + ": the fields of %s" % what
    require(type(found) is dict and set(found) == set(expected), message)
    for name, types in expected.items():
        value = found[name]
        require(isinstance(value, types) and not isinstance(value, bool), message)
        require(not isinstance(value, int) or 0 <= value < 2**64, message)


def box_of(corners):
    """Six numbers: two corners, the lesser first; None if there is no box."""
    if corners is None:
        return None
    corners = [side if type(side) is list else [] for side in corners]
    is_box = [len(side) for side in corners] == [3, 3]
    is_box = is_box and all(type(x) in (int, float) for side in corners for x in side)
    require(is_box, NO_MANIFEST + ": a box")
    return tuple(float(x) for side in corners for x in side)


class Manifest:
    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read(2**28 + 1)
        require(len(data) <= 2**28, "a manifest of more than 2^28 bytes")
        try:
            found = json.loads(data)
        except ValueError:
            raise Malformed(NO_MANIFEST) from None
        require(type(found) is dict, NO_MANIFEST)
        require(
            found.get("format") == "spmesh mesh in parts",
            "this is %r, expected a mesh in parts" % found.get("format"),
        )
        if found.get("version") != 2:
            raise TooNew("version %r of a manifest; this program reads 2" % found.get("version"))
        fields_of(found, MANIFEST, "the manifest")
        for file in found["skipped"]:
            fields_of(file, SKIPPED, "a skipped file")
        self.parts, self.points, self.merged = found["parts"], found["points"], found["merged"]
        require(self.parts, "a mesh without parts")
        self.bounds = box_of(found["bounds"])
        folder = os.path.dirname(path)
        # For each part, the id of its first vertex in the joined mesh.
        self.first = [0]
        for place, part in enumerate(self.parts):
            fields_of(part, MANIFEST_PART, "a part")
            box_of(part["box"])
            name, below = part["name"], part["below"]
            require(len(name) == 16 and set(name) <= set("0123456789abcdef"), "%r is no name of a part" % name)
            require(below <= place, "part %d comes before one of the %d below it" % (place, below))
            part["place"], part["path"] = place, os.path.join(folder, part["file"])
            self.first.append(self.first[-1] + part["vertices"])


class Joined(Text):
    """Takes the parts of a mesh as a text takes a stream, and prints the text twin of the joined mesh."""

    def __init__(self, write, manifest):
        Text.__init__(self, write)
        self.manifest, self.common = manifest, None
        # Lines of the vertices that parts still share, by their ids in the joined mesh.
        self.shared = {}
        self.total = dict.fromkeys("points cells vertices simplices merged residual walls".split(), 0)

    def start(self, part):
        """The next part follows."""
        self.part, self.before = part, dict(self.total)
        # Ids in the joined mesh, and lines, of the vertices of the part that are not final in it.
        self.ids, self.places = {}, {}

    def header(self, header):
        is_it = header.part == (int(self.part["name"], 16), self.part["below"]) and not header.is_residual
        require(is_it, "this is another part than the manifest names")
        attributes = [vars(attribute) for attribute in header.attributes]
        attributes = [{name: value for name, value in all.items() if name not in ("number", "row")} for all in attributes]
        common = (header.kind, header.scale, header.offset, header.has_elevation, attributes)
        require(self.common in (None, common), "its grid or its attributes are not those of the other parts")
        if self.common is None:
            header = copy.copy(header)
            header.part, header.points, header.bounds, header.tree = None, UNKNOWN, self.manifest.bounds, None
            header.check_bounds()
            self.first_header = header
            Text.header(self, header)
        self.common = common

    def line(self, line):
        """Lines of labels and of the end are none of the joined mesh."""
        if line.startswith("#spmesh ") or line == "# patch":
            self.write(line + "\n")

    def id_of(self, vertex):
        """The id of a vertex in the joined mesh."""
        part, number = vertex >> NUMBER_BITS, vertex % 2**NUMBER_BITS
        place = self.part["place"] - self.part["below"] + part
        require(number < self.manifest.parts[place]["vertices"], "a vertex of no part")
        return self.manifest.first[place] + number

    def patch(self, first, new, simplices, sides, finalized, origins, kept):
        start, lines = self.total["vertices"], []
        for vertex, point in enumerate(new, first):
            line = "v %s\n%s" % (self.world(point), self.row())
            if vertex in origins:
                joined = self.id_of(origins[vertex])
                require(joined in self.shared, "a vertex that no part before this one has kept")
                require(self.shared[joined] == line, "a vertex that is another point in another part")
            else:
                joined = start + len(lines)
                lines.append(line)
                self.first_header.point(point)
            self.ids[vertex], self.places[vertex] = joined, line
        for vertex in kept:
            self.shared[self.ids[vertex]] = self.places[vertex]
        final = [self.ids[vertex] for vertex in set(finalized) - set(kept)]
        for vertex in final:
            self.shared.pop(vertex, None)
        simplices = [[self.ids[vertex] for vertex in simplex] for simplex in simplices]
        for vertex in finalized:
            del self.ids[vertex], self.places[vertex]
        self.total["vertices"] += len(lines)
        self.total["simplices"] += len(simplices)
        if lines or simplices or final:
            self.line("# patch")
            self.write("".join(lines))
            for simplex in simplices:
                self.write("%s %s\n" % ("fc"[len(simplex) - 3], " ".join(str(vertex + 1) for vertex in simplex)))
            final.sort(key=lambda vertex: (vertex < start, vertex))
            self.write("".join(["x %d\n" % (vertex + 1) for vertex in final]))

    def finish(self, totals):
        """The part has ended with these totals."""
        self.total["merged"] += totals["merged"]
        for name in ("vertices", "simplices"):
            found, stated = self.total[name] - self.before[name], self.part[name]
            require(found == stated, "%d %s of its own, expected %d" % (found, name, stated))

    def end(self):
        require(not self.shared, "%d vertices are kept for parts that do not come" % len(self.shared))
        self.total["points"] = self.total["vertices"] + self.total["merged"]
        stated = self.manifest.points, self.manifest.merged
        found = self.total["points"], self.total["merged"]
        require(found == stated, "the parts have %d points, %d of them merged, expected %d and %d" % (found + stated))
        self.write("# end %s\n" % " ".join("%s %d" % total for total in self.total.items()))


class Join:
    """Reads a mesh in parts."""

    def __init__(self, path, write):
        self.path, self.write, self.where = path, write, "manifest"

    def read(self):
        manifest = Manifest(self.path)
        joined = Joined(self.write, manifest)
        for part in manifest.parts:
            self.where = part["path"]
            with open(part["path"], "rb") as source:
                stream = Stream(source, joined)
                joined.start(part)
                try:
                    stream.read()
                    joined.finish(stream.end_total)
                except REFUSED:
                    self.where = "%s: %s" % (part["path"], stream.where)
                    raise
        self.where = "manifest"
        joined.end()


def main(arguments):
    quiet = "-q" in arguments
    names = [argument for argument in arguments if argument != "-q"]
    if len(names) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    name = "stdin" if names[0] == "-" else names[0]
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(encoding="utf-8", newline="\n")
    stream = None
    write = (lambda text: None) if quiet else sys.stdout.write
    try:
        if names[0] != "-" and is_manifest(name):
            stream = Join(name, write)
            stream.read()
            sys.stdout.flush()
            return 0
        with sys.stdin.buffer if names[0] == "-" else open(name, "rb") as source:
            stream = Stream(source, Text(write))
            stream.read()
            sys.stdout.flush()
        return 0
    except REFUSED as error:
        sys.stdout.flush()
        print("spmesh_reader: %s: %s: %s" % (name, stream.where, error), file=sys.stderr)
        return error.exit_code
    except NoZstd as error:
        print("spmesh_reader: %s: %s" % (name, error), file=sys.stderr)
        return 1
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except OSError as error:
        print("spmesh_reader: %s: %s" % (name, error), file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
