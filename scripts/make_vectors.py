#!/usr/bin/env python3
"""Writes the test vectors of the stream format into formats/vectors: commented bytes and the bytes alone, in pass
and fail, and manifest.json.

    python3 make_vectors.py            (--check writes nothing and fails if a file differs)

An independent writer, from the text of formats/spmesh.md alone. Every vector is spelled out here, with its
text twin or the words that the error must contain.
"""

import io
import json
import os
import struct
import sys
from decimal import Decimal

import spmesh_reader

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "formats", "vectors")
UNKNOWN = 2**64 - 1
MAGIC = b"\x89SPM\r\n\x1a\n"
KINDS = {"points": 1, "triangle mesh": 2, "partial triangle mesh": 3, "tetrahedral mesh": 4,
         "points in 4 dimensions": 5, "cells in 4 dimensions": 6, "simplices in 4 dimensions": 7,
         "configurations": 8, "splines": 9, "partial tetrahedral mesh": 10,
         "residual of a triangle mesh": 11, "residual of a tetrahedral mesh": 12, "points in regions": 13}
# Vectors in fail whose faults only a reader with memory of cells or vertices can see.
NEED_MEMORY = {
    "cell-twice", "cell-after-ancestor", "cell-after-siblings", "point-in-final-cell", "point-in-final-ancestor",
    "point-on-lower-border", "finalized-twice", "tetrahedra-import-finalized", "residual-finalized-id",
    "residual-id-twice", "residual-moved", "partial-tetrahedra-moved",
}
# Vectors in fail that are too new: they need what a reader of version 2 does not know.
TOO_NEW = {
    "version", "version-1", "version-huge", "kind", "coordinate-type", "feature-bit", "feature-bit-last",
    "record-required", "record-required-and-fault", "tag-unknown", "tag-unknown-after-skipped",
    "tag-unknown-before-fault", "rows-unknown-required",
    "parts-from-before-required",
}
FUNCTIONS = ("edge", "vertex", "tent", "crease", "face")
INF, NAN = float("inf"), float("nan")


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def printable(tag):
    return "".join(chr(byte) if 32 <= byte < 127 else "?" for byte in tag)


def number(value):
    """A decimal as the text twin writes it; `value` is a string or an integer."""
    if value in (INF, -INF):
        return str(value)
    text = format(Decimal(value), "f")
    return text.rstrip("0").rstrip(".") if "." in text else text


class Vector:
    """A stream under construction: pieces of bytes, each with a comment, and the lines of its text twin."""

    def __init__(self, kind="points", **fields):
        self.pieces, self.lines, self.sequence, self.body, self.triangles = [], [], 0, None, 0
        self.header(kind, **fields)

    def put(self, data, comment):
        if data:
            self.pieces.append((data, comment))
        return self

    def header(self, kind, grid=None, dims=2, elevation=0, bounds=None, points=None, tree=None, region=None,
               chunked=False, wkt=None, geokeys=None, producer="vector", compressed=False, attributes=(), constrained=None, weighted=None,
               part=None, edit=None, raw=None):
        """`grid` is scale and offset; `raw` overrides fields, by their names below, and payloads of records,
        by their tags, with bytes, and adds a "tail" behind the records; `edit` changes the list of records, which are pairs of tag and payload."""
        raw = raw or {}
        self.grid, self.dims, self.axes, self.attributes = grid, dims, dims + elevation, attributes
        records = self.records(grid, dims, bounds, tree, region, wkt, geokeys, attributes, constrained, weighted, part, producer)
        records = [(tag, [(raw[tag.decode()], "damaged")] if tag.decode() in raw else payload) for tag, payload in records]
        edit = edit or (lambda records: records)
        records = [(tag, [(payload, "payload")] if isinstance(payload, bytes) else payload) for tag, payload in edit(records)]
        tail = raw.get("tail", b"")
        length = 16 + len(tail) + sum(8 + sum(len(data) for data, _ in payload) for _, payload in records)
        fields = [
            ("magic", MAGIC, "magic"),
            ("version", struct.pack("<H", 2), "version"),
            ("code", struct.pack("<H", KINDS[kind]), "kind: " + kind),
            ("length", struct.pack("<I", length), "body length"),
            ("type", bytes([2 if grid else 1]), "coordinate type " + ("i32" if grid else "f64")),
            ("dims", bytes([dims]), "dims"),
            ("elevation", bytes([elevation]), "elevation"),
            ("flags", bytes([chunked]), "flags"),
            ("features", struct.pack("<I", compressed), "features" + ": compressed blocks" * compressed),
            ("points", struct.pack("<Q", UNKNOWN if points is None else points), "points"),
        ]
        assert set(raw) <= {name for name, _, _ in fields} | {tag.decode("latin1") for tag, _ in records} | {"tail", "checksum"}, raw
        for name, data, comment in fields:
            self.put(raw.get(name, data), comment)
        for tag, payload in records:
            data = b"".join(piece for piece, _ in payload)
            self.put(tag, "record " + printable(tag)).put(struct.pack("<I", len(data)), "length")
            for piece, comment in payload:
                self.put(piece, comment)
        self.put(tail, "after the last whole record")
        self.put(raw.get("checksum", struct.pack("<I", crc32c(self.bytes()))), "CRC32C of the header")
        yes = ("no", "yes")
        self.say("version 2", "kind " + kind, "coordinates " + ("i32" if grid else "f64"))
        if grid:
            self.say("scale " + " ".join(grid[0]), "offset " + " ".join(grid[1]))
        self.say("dims %d" % dims, "elevation " + yes[elevation])
        if bounds:
            self.say("bounds " + " ".join(map(number, bounds)))
        if points is not None:
            self.say("points %d" % points)
        if tree:
            self.say("tree " + " ".join(map(number, tree)))
        if region:
            self.say("region " + " ".join(map(number, region)))
        self.say("chunked " + yes[chunked])
        if wkt is not None:
            self.say('wkt "%s"' % wkt.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n"))
        if geokeys is not None:
            self.say("geokeys " + " ".join(r.hex() or "-" for r in geokeys))
        self.say(*["attribute " + attribute.text() for attribute in attributes])
        if constrained is not None:
            self.say("constrained %s %s" % (yes[constrained[0]], number(constrained[1])))
        if weighted is not None:
            self.say("weighted " + number(weighted))
        if part is not None:
            self.say("part %d %d" % part)
        self.say('producer "%s"' % producer)

    @staticmethod
    def records(grid, dims, bounds, tree, region, wkt, geokeys, attributes, constrained, weighted, part, producer):
        """The records of the header in the order of the text: tags, and payloads as bytes with comments."""
        floats = lambda values: struct.pack("<%dd" % len(values), *map(float, values))
        records = []
        if grid:
            records.append((b"GRID", [(floats(grid[0]), "scale"), (floats(grid[1]), "offset")]))
        if bounds is not None:
            records.append((b"BBOX", [(floats(bounds[:3]), "smallest"), (floats(bounds[3:]), "largest")]))
        if tree is not None:
            depth, *origin, side = tree
            origin = (origin + [0])[:dims]
            records.append((b"TREE", [(floats(origin), "origin"), (floats([side]), "side"),
                                      (struct.pack("<I", depth), "depth")]))
        if region is not None:
            half = len(region) // 2
            records.append((b"REGN", [(floats(region[:half]), "min"), (floats(region[half:]), "max")]))
        if wkt is not None:
            records.append((b"cWKT", [(wkt.encode(), "well-known text")]))
        if geokeys is not None:
            records.append((b"cGEO", [(struct.pack("<I", len(r)) + r, "GeoTIFF record") for r in geokeys]))
        if attributes:
            records.append((b"attr", [piece for attribute in attributes for piece in attribute.pieces()]))
        if constrained is not None:
            is_cut, kill = constrained
            records.append((b"cons", [(bytes([is_cut]), "flags"), (floats([kill]), "kill length")]))
        if weighted is not None:
            records.append((b"wght", [(floats([weighted]), "greatest weight")]))
        if part is not None:
            records.append((b"part", [(struct.pack("<Q", part[0]), "name"), (struct.pack("<I", part[1]), "parts below")]))
        if producer:
            records.append((b"prod", [(producer.encode(), "producer")]))
        return records

    def say(self, *lines):
        self.lines += ["#spmesh " + line for line in lines]

    def bytes(self):
        return b"".join(data for data, _ in self.pieces)

    def block(self, tag, payload, **damage):
        """`payload` is a list of pairs of bytes and comment; `damage` may set length, sequence or
        checksum."""
        is_compressed, payload = self.body is not None, payload if self.body is None else self.body
        self.body = None
        data = b"".join(piece for piece, _ in payload)
        sequence, length = damage.get("sequence", self.sequence), damage.get("length", len(data))
        head = tag + struct.pack("<II", sequence, length + (is_compressed << 31))
        self.put(head[:4], "block " + printable(tag)).put(head[4:8], "sequence")
        self.put(head[8:], "length, compressed" if is_compressed else "length")
        self.put(struct.pack("<I", damage.get("checksum", crc32c(head + data))), "CRC32C of the block")
        for piece, comment in payload:
            self.put(piece, comment)
        self.sequence += 1
        return self

    def instead(self, *body):
        """Gives the next block this compressed payload in place of its payload: pairs of bytes and comment."""
        self.body = list(body)
        return self

    def skip(self, tag=b"note", payload=b"", **damage):
        """A block that may be skipped: the text twin does not have it."""
        return self.block(tag, [(payload, "skipped")], **damage)

    def point(self, point):
        """A point as bytes and as text; coordinates are integers of the grid, or decimals in strings."""
        assert len(point) == self.axes, point
        if self.grid:
            world = [Decimal(c) * Decimal(s) + Decimal(o) for c, s, o in zip(point, *self.grid)]
            data = struct.pack("<%di" % self.axes, *point)
        else:
            world, data = point, struct.pack("<%dd" % self.axes, *map(float, point))
        world = ["nan" if str(c) in ("nan", "inf") else number(c) for c in world] + ["0"] * (3 - self.axes)
        return data, " ".join(world)

    def with_rows(self, lines, rows):
        """Lines of points, each with the line of its row behind it."""
        rows = list(rows) + [None] * (len(lines) - len(rows))
        for line, row in zip(lines, rows):
            self.lines.append(line)
            if row is not None:
                words = [attribute.word(value) for attribute, values in zip(self.attributes, row) for value in values]
                self.lines.append("a " + " ".join(words))

    def rows(self, *rows, tag=b"attp", **damage):
        """A block of rows: for each point a list of the numbers of each attribute. The lines of the twin come with the
        points."""
        return self.block(tag, [(attribute.data(values), attribute.name) for row in rows
                                for attribute, values in zip(self.attributes, row)], **damage)

    def points(self, *points, rows=(), **damage):
        pairs = [self.point(point) for point in points]
        self.with_rows(["v " + text for _, text in pairs], rows)
        return self.block(b"PNTS", [(data, "point " + text) for data, text in pairs], **damage)

    def cells(self, *codes):
        self.lines += ["x cell %d" % code for code in codes]
        return self.block(b"CELL", [(struct.pack("<Q", code), "cell %d" % code) for code in codes])

    def patch(self, first=0, new=(), imported=(), simplices=(), finalized=(), counts=None, rows=(), sides=None,
              origins=None, kept=None, amid=None):
        """A skipped block with the tag `amid` stands behind those of vertices of other parts."""
        pairs = [self.point(point) for point in new]
        counts = counts or [len(new), len(imported), len(simplices), len(finalized)]
        ids = list(range(first, first + len(new))) + list(imported)
        name = lambda local: str(ids[local] + 1 if local < len(ids) else "?")
        self.lines.append("# patch")
        self.with_rows(["v " + text for _, text in pairs], rows)
        self.lines += ["from %s %d" % (name(local), vertex + 1) for local, vertex in origins or ()]
        letter, simplex = ("c ", "tetrahedron") if self.dims == 3 else ("f ", "triangle")
        self.lines += [letter + " ".join(map(name, t)) for t in simplices]
        if sides is not None:
            self.sides(*sides)
        self.triangles += len(simplices)
        self.lines += ["x " + name(local) for local in finalized]
        self.lines += ["kept " + name(local) for local in kept or ()]
        for block, records in ((self.origins, origins), (self.kept, kept)):
            if records is not None:
                block(*records)
                if amid:
                    self.skip(amid)
        payload = [(struct.pack("<Q", first), "first id"), (struct.pack("<4I", *counts), "counts N M S F")]
        payload += [(data, "vertex %d: %s" % (first + i, text)) for i, (data, text) in enumerate(pairs)]
        payload += [(struct.pack("<Q", vertex), "imports vertex %d" % vertex) for vertex in imported]
        payload += [(struct.pack("<%dI" % len(t), *t), "%s of vertices %s" % (simplex, " ".join(map(str, t))))
                    for t in simplices]
        payload += [(struct.pack("<I", local), "finalizes local vertex %d" % local) for local in finalized]
        return self.block(b"PTCH", payload)

    def segments(self, *segments):
        """Segments: the number of the line, and four coordinates as those of points."""
        payload, axes = [], self.axes
        for line, *ends in segments:
            self.axes = 2
            pairs = [self.point(ends[:2]), self.point(ends[2:])]
            self.axes = axes
            text = " ".join(" ".join(text.split(" ")[:2]) for _, text in pairs)
            self.lines.append("segment %d %s" % (line, text))
            payload.append((struct.pack("<I", line) + pairs[0][0] + pairs[1][0], "line %d: %s" % (line, text)))
        return self.block(b"segm", payload)

    def sides(self, *sides):
        """Sides of the next patch: triangle, place and segment."""
        self.lines += ["side %d %d %d" % (self.triangles + t + 1, place + 1, s + 1) for t, place, s in sides]
        payload = [(struct.pack("<3I", *side), "triangle %d, place %d, segment %d" % side) for side in sides]
        return self.block(b"side", payload)

    def open(self, *numbers):
        self.lines += ["open %d" % (n + 1) for n in numbers]
        return self.block(b"open", [(struct.pack("<I", n), "open segment %d" % n) for n in numbers])

    def origins(self, *origins):
        """New vertices of the next patch that are vertices of other parts: local index and global id. The lines of the
        twin come with the patch."""
        payload = []
        for local, vertex in origins:
            comment = "local vertex %d is vertex %d of part %d" % (local, vertex % 2**40, vertex >> 40)
            payload.append((struct.pack("<IQ", local, vertex), comment))
        return self.block(b"from", payload)

    def kept(self, *locals):
        """Finalized vertices of the next patch that later parts may use."""
        return self.block(b"kept", [(struct.pack("<I", local), "keeps local vertex %d" % local) for local in locals])

    def regions(self, box, own=0, first=0, again=0, last=0):
        """A region: its box, and the counts of its points."""
        counts = dict(own=own, first=first, again=again, last=last)
        self.lines.append("region " + " ".join(map(number, [*box, *counts.values()])))
        payload = [(struct.pack("<3d", *map(float, half)), name) for half, name in ((box[:3], "min"), (box[3:], "max"))]
        return self.block(b"REGN", payload + [(struct.pack("<Q", n), name) for name, n in counts.items()])

    def labels(self, *labels):
        self.lines += ["label %d" % label for label in labels]
        return self.block(b"LABL", [(struct.pack("<Q", label), "label %d" % label) for label in labels])

    def residual(self, *points, rows=()):
        payload = []
        for number, (vertex, *point) in enumerate(points):
            data, text = self.point(point)
            self.with_rows(["r %s %s" % ("-" if vertex is None else vertex + 1, text)], rows[number : number + 1])
            name = "no vertex yet" if vertex is None else "vertex %d" % vertex
            payload += [(struct.pack("<Q", UNKNOWN if vertex is None else vertex), name), (data, "at " + text)]
        return self.block(b"RPNT", payload)

    def walls(self, *walls):
        self.lines += ["w " + " ".join(str(corner + 1) for corner in wall) for wall in walls]
        return self.block(b"WALL", [(struct.pack("<%dI" % len(wall), *wall), "wall " + " to ".join(map(str, wall)))
                                    for wall in walls])

    def points4(self, *points):
        """Points of four coordinates and an optional value, as decimals in strings; "nan" is an unknown
        value."""
        payload = []
        for point in points:
            assert len(point) == self.axes, point
            text = " ".join("nan" if c == "nan" else number(c) for c in point)
            self.lines.append("v4 " + text)
            payload.append((struct.pack("<%dd" % self.axes, *map(float, point)), "point " + text))
        return self.block(b"PNT4", payload)

    def cells4(self, *cells, split=(), amid=None):
        """Cells as triples: whether they are infinite, vertices, neighbours. A block ends after each number
        of words in `split`; a skipped block with the tag `amid` comes before each but the first."""
        words = []
        for infinite, vertices, neighbours in cells:
            self.lines += ["ci"[infinite] + "4 " + " ".join(str(v + 1) for v in vertices),
                           " ".join(["n4"] + [str(n + 1) for n in neighbours])]
            mark = 2**31 if infinite else 0
            words += [(len(vertices) | mark, "infinite cell of vertices" if infinite else "finite cell of vertices"),
                      (len(neighbours), "neighbours")]
            words += [(v, "vertex %d" % v) for v in vertices] + [(n, "neighbour %d" % n) for n in neighbours]
        ends = list(split) + [len(words)]
        for start, end in zip([0] + ends, ends):
            if amid and start:
                self.skip(amid)
            self.block(b"CEL4", [(struct.pack("<I", word), comment) for word, comment in words[start:end]])
        return self

    def simplices4(self, *simplices):
        texts = [" ".join(map(str, simplex)) for simplex in simplices]
        self.lines += ["s4 " + " ".join(str(v + 1) for v in simplex) for simplex in simplices]
        return self.block(b"SIM4", [(struct.pack("<5I", *simplex), "simplex of vertices " + text)
                                    for simplex, text in zip(simplices, texts)])

    def configurations(self, degree, *groups, standing=0, goes_on=False, head=None):
        """Groups of an interior set and boundaries; an infinite boundary has two knots. `goes_on` is true if
        the block before began the degree, and "group" if it also began the first group. `head` overrides
        degree, standing and count."""
        if not goes_on:
            self.lines.append("degree %d %s" % (degree, ("any", "delaunay", "lifted", "?")[standing]))
        for number, (interior, boundaries) in enumerate(groups):
            if number or goes_on != "group":
                self.lines.append(" ".join(["in"] + [str(v + 1) for v in interior]))
            self.lines += [" ".join(["on" if len(b) == 3 else "line"] + [str(v + 1) for v in b]) for b in boundaries]
        pack = lambda words: struct.pack("<%dI" % len(words), *words)
        payload = [(pack(head or (degree, standing, len(groups))), "degree, standing, groups")]
        payload += [(pack(interior), "interior set") for interior, _ in groups if interior]
        payload += [(pack([len(boundaries)]), "configurations of a group") for _, boundaries in groups]
        payload += [(pack(tuple(b) + (2**32 - 1,) * (3 - len(b))), "boundary" if len(b) == 3 else "infinite boundary")
                    for _, boundaries in groups for b in boundaries]
        return self.block(b"CONF", payload)

    def functions(self, *functions):
        """Functions as triples: a name or a code, knots, and terms of two knots and a factor as text."""
        payload = []
        for name, kind, terms in functions:
            code = FUNCTIONS.index(name) if name in FUNCTIONS else name
            self.lines.append(" ".join(["function %s" % name] + [str(v + 1) for v in kind]))
            self.lines += ["term %d %d %s" % (p + 1, q + 1, number(factor)) for p, q, factor in terms]
            words = (code, len(terms)) + tuple(kind)
            payload.append((struct.pack("<%dI" % len(words), *words), "%s, number of terms, knots" % name))
            payload += [(struct.pack("<2Id", p, q, float(factor)), "two knots, factor") for p, q, factor in terms]
        return self.block(b"FUNC", payload)

    def coefficients(self, *numbers):
        self.lines += ["coefficient " + number(value) for value in numbers]
        return self.block(b"COEF", [(struct.pack("<d", float(value)), "coefficient") for value in numbers])

    def end(self, points=0, cells=0, vertices=0, simplices=0, merged=0, residual=0, walls=0, **damage):
        totals = dict(points=points, cells=cells, vertices=vertices, simplices=simplices, merged=merged,
                      residual=residual, walls=walls)
        self.lines.append("# end " + " ".join("%s %d" % total for total in totals.items()))
        return self.block(b"END ", [(struct.pack("<Q", n), name) for name, n in totals.items()], **damage)

    def cut(self, length):
        """Cuts bytes off the end."""
        while length >= len(self.pieces[-1][0]):
            length -= len(self.pieces.pop()[0])
        data, comment = self.pieces[-1]
        self.pieces[-1] = (data[: len(data) - length], comment + ", cut off")
        return self

    def hex(self, title):
        lines = ["# " + title]
        for data, comment in self.pieces:
            rows = [data[i : i + 24].hex(" ") for i in range(0, len(data), 24)] or [""]
            lines += ["%-72s # %s" % (rows[0], comment)] + rows[1:]
        return "\n".join(lines) + "\n"

    def text(self):
        return "\n".join(self.lines) + "\n"


class Attribute:
    """An attribute: numbers are integers, or decimals or "0x" and the bits of a NaN in strings."""

    LETTERS = dict(u8="B", i8="b", u16="H", i16="h", u32="I", i32="i", u64="Q", i64="q", f32="f", f64="d")

    def __init__(self, name, type, components=1, unit="", las_name="", scale=None, unknown=None):
        self.name, self.type, self.components, self.unit, self.las_name = name, type, components, unit, las_name
        self.scale, self.unknown = scale, unknown

    def number(self, value):
        letter = self.LETTERS[self.type]
        if letter not in "fd":
            return struct.pack("<" + letter, value)
        if value.startswith("0x"):
            return bytes.fromhex(value[2:])[::-1]
        return struct.pack("<" + letter, float(value))

    def word(self, value):
        return str(value) if self.type[0] != "f" or value[:2] == "0x" or "inf" in value else number(value)

    def data(self, values):
        return b"".join(map(self.number, values))

    def pieces(self):
        flags = (self.scale is not None) + 2 * (self.unknown is not None)
        kind = bytes([list(self.LETTERS).index(self.type) + 1, self.components, flags])
        pieces = [(kind, "attribute: type, components, flags")]
        for text, comment in ((self.name, "name"), (self.unit, "unit"), (self.las_name, "LAS name")):
            pieces.append((bytes([len(text.encode())]) + text.encode(), comment))
        if self.scale is not None:
            pieces.append((struct.pack("<2d", *map(float, self.scale)), "scale and offset"))
        if self.unknown is not None:
            pieces.append((self.number(self.unknown), "unknown"))
        return pieces

    def text(self):
        scale = "- -" if self.scale is None else " ".join(map(number, self.scale))
        unknown = "-" if self.unknown is None else self.word(self.unknown)
        quoted = lambda text: json.dumps(text, ensure_ascii=False)
        texts = (quoted(self.unit), quoted(self.las_name))
        return "%s %s %d %s %s %s %s" % (quoted(self.name), self.type, self.components, *texts, scale, unknown)


CM = (("0.01", "0.01", "0.5"), ("1000", "-2000", "0"))
HALF = (("0.5", "0.5", "0.25"), ("0", "0", "0"))
EVEN = (("0.5", "0.5", "0.5"), ("0", "0", "0"))
UNEVEN = (("0.5", "0.25", "0.5"), ("0", "0", "0"))
QUADTREE = (2, 0, 0, 0, 4)
OCTREE = (2, 0, 0, 0, 4)
SQUARE = [(0, 0, 0), (2, 0, 1), (0, 2, 1), (2, 2, 4)]
# A corner of a cube, its three neighbours, and the opposite corner: two tetrahedra that share a facet.
CORNERS = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4), (4, 4, 4)]
TETRAHEDRAL = dict(kind="tetrahedral mesh", dims=3, grid=EVEN)
# A simplex in four dimensions with its points sorted, and the five infinite cells around it.
CORNERS4 = [("0",) * 4, ("0", "0", "0", "1"), ("0", "0", "1", "0"), ("0", "1", "0", "0"), ("1", "0", "0", "0")]
CELLS4 = [(0, (0, 1, 2, 3, 4), (1, 2, 3, 4, 5))] + [
    (1, tuple(v for v in range(5) if v != 4 - i), (0,) + tuple(1 + n for n in range(5) if n != i)) for i in range(5)]
POINTS4 = dict(kind="points in 4 dimensions", dims=4)
DIAGRAM4 = dict(kind="cells in 4 dimensions", dims=4)
SIMPLICES4 = dict(kind="simplices in 4 dimensions", dims=4)

# Four knots: a triangle with one inside. Degree 0, with the lines of the hull, and degree 1.
CONFIGURATIONS = dict(kind="configurations", grid=HALF)
KNOTS = [(0, 0), (8, 0), (0, 8), (2, 2)]
DEGREE0 = ((), [(0, 1, 3), (1, 2, 3), (0, 3, 2), (1, 0), (2, 1), (0, 2)])
DEGREE1 = [((0,), [(1, 3), (3, 2)]), ((1,), [(2, 3), (3, 0)]), ((2,), [(0, 3), (3, 1)]), ((3,), [(0, 1, 2)])]
SPLINES = dict(kind="splines", grid=HALF)
PAIRS = [("edge", pair, [pair + ("1",)]) for pair in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))]
PARTIAL = dict(kind="partial triangle mesh", grid=HALF, elevation=1, region=(0, 0, 8, 8))
PARTIAL_SPACE = dict(kind="partial tetrahedral mesh", dims=3, grid=EVEN, region=(0, 0, 0, 8, 8, 8))


# --- Compressed payloads -----------------------------------------------------------------------------------


def frame(content, blocks=None, head=None):
    """A zstd frame of raw blocks. `blocks` are triples of type, size and bytes instead; `head` is a header instead
    of that of one segment."""
    if head is None:
        size = len(content)
        head = bytes([0x20, size]) if size < 256 else struct.pack("<BH", 0x60, size - 256)
    blocks = blocks or [(0, len(content), content)]
    data = b"\x28\xb5\x2f\xfd" + head
    for number, (kind, size, body) in enumerate(blocks):
        data += (size << 3 | kind << 1 | (number == len(blocks) - 1)).to_bytes(3, "little") + body
    return data


def code(number):
    """The code of a signed integer of 32 bits."""
    number = (number + 2**31) % 2**32 - 2**31
    return 2 * number if number >= 0 else -2 * number - 1


def columns(*parts):
    """Tokens and bits of columns, which are pairs of k and numbers, and of bytes."""
    tokens, bits, count = b"", 0, 0
    for part in parts:
        if isinstance(part, bytes):
            tokens += part
            continue
        k, numbers = part
        for value in numbers:
            length = max(value.bit_length() - 1 - k, 0)
            tokens += bytes([(length << k) + (value >> length)])
            bits |= (value & (1 << length) - 1) << count
            count += length
    return tokens, bits.to_bytes((count + 7) // 8, "little")


def framed(tokens, bits):
    packed = frame(tokens)
    return [(struct.pack("<I", len(packed)), "bytes of the frame"), (packed, "zstd frame of tokens"), (bits, "bits")]


def packed_points(count, axes, *parts):
    """Method 1: `axes` are triples of predictor, k and first coordinate; `parts` are those of `columns`."""
    return [(b"\1", "method 1: points"), (struct.pack("<I", count), "points")] + [
        (struct.pack("<BBi", *axis), "predictor, k, first coordinate") for axis in axes] + framed(*columns(*parts))


def packed_patch(first, counts, operations, numbers, marks, edit=lambda tokens, bits: (tokens, bits)):
    """Method 2: `numbers` are eight pairs of k and a column; `edit` changes tokens and bits."""
    return [(b"\2", "method 2: triangles"), (struct.pack("<Q", first), "first id"),
            (struct.pack("<4I", *counts), "counts N M S F"), (bytes(k for k, _ in numbers), "parameters")] + framed(
        *edit(*columns(bytes(operations), *numbers, bytes(marks))))


def packed_records(record, word, length, content, packed=None):
    """Method 3."""
    return [(b"\3", "method 3: records"), (struct.pack("<H", record), "bytes of a record"),
            (bytes([word]), "bytes of a word"), (struct.pack("<I", length), "bytes of the payload"),
            (frame(content) if packed is None else packed, "zstd frame")]


def differences(vertices, parents):
    """Columns 4 to 6 of a patch: each vertex less its parent."""
    bases = [(0, 0, 0)] + [vertices[parent] for parent in parents[1:]]
    return [[code(vertex[axis] - base[axis]) for vertex, base in zip(vertices, bases)] for axis in range(3)]


# Six points whose columns are spelled out. The codes of x are 0 200 200 0 599 2000190, of 0 8 8 0 10 21 bits: y
# has the order 0 3 1 2 4 5. Its codes, after the median, are 0 20 20 20 0 0: z has the order 0 3 4 1 2 5.
SIX = [(5, 7, 1), (105, 17, 2), (205, 27, 0), (205, 37, 0), (-95, 47, 0), (1000000, 57, -(2**31))]
SIX_AXES = [(0, 3, 5), (1, 2, 7), (0, 2, 1)]
SIX_COLUMNS = [(3, [0, 200, 200, 0, 599, 2000190]), (2, [0, 20, 20, 20, 0, 0]), (2, [0, 0, 0, 2, 3, 2**32 - 1])]

# A patch with each way to give a vertex: a fan around vertex 0, triangles around it, and loose ones.
FAN = [(v * v % 7 - 3, 5 * v % 11, v) for v in range(13)]
FAN_PARENTS = [0, 0, 1, 2, 3, 2, 1, 6, 5, 8, 9, 10, 11]
FAN_TRIANGLES = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (1, 0, 4), (1, 5, 2), (3, 2, 5), (1, 6, 7), (1, 4, 5), (8, 9, 5),
                 (3, 5, 4), (10, 12, 11), (12, 10, 0)]
FAN_OPERATIONS = [0, 96, 96, 124, 32, 66, 9, 78, 1, 87, 3, 99]
FAN_NUMBERS = [(2, [2, 2, 2, 2]), (3, [4, 4, 12, 11]), (2, [])] + [
    (2, column) for column in differences(FAN, FAN_PARENTS)] + [(0, []), (7, [])]
FAN_COUNTS = (13, 0, 12, 10)
FAN_MARKS = (0xFF, 0x0C)
COMPRESSED = dict(grid=HALF, elevation=1, compressed=True)


# Attributes of every type.
CLASS = Attribute("class", "u8")
COLOUR = Attribute("rgb", "u16", 3, las_name="Red, Green, Blue")
ANGLE = Attribute("angle \u00fc\\", "i16", unit="degree", scale=("0.006", "-1.5"), unknown=-32768)
NUMBERS = [Attribute(name, name) for name in Attribute.LETTERS]
LEAST = [[0], [-128], [0], [-(2**15)], [0], [-(2**31)], [0], [-(2**63)], ["-3.4028235e38"], ["-1.7976931348623157e308"]]
MOST = [[255], [127], [2**16 - 1], [2**15 - 1], [2**32 - 1], [2**31 - 1], [2**64 - 1], [2**63 - 1], ["inf"], ["-inf"]]
ODD = [[7], [-1], [8], [-2], [9], [-3], [10], [-4], ["0x7fc00001"], ["0xfff8000000000001"]]
TINY = [[1], [1], [1], [1], [1], [1], [1], [1], ["0.1"], ["-5e-324"]]
RANKED = dict(grid=HALF, elevation=1, attributes=[CLASS, ANGLE])
ROWS = [([3], [-1]), ([2**8 - 1], [-32768]), ([0], [700])]


def passing_attributes():
    """Attributes of points."""
    yield "attributes-numbers", "An attribute of each type: least and greatest numbers, infinity, NaN of several bits", Vector(
        attributes=NUMBERS).points(("0", "0"), ("1", "0"), ("2", "0"), ("3", "0"), rows=[LEAST, MOST, ODD, TINY]).rows(
        LEAST, MOST, ODD, TINY).end(4)
    yield "attributes-tree", "Scale, unit and unknown; tags, blocks without points, and a skipped block before the rows", Vector(
        **RANKED, chunked=True, tree=QUADTREE).points(rows=[]).points((0, 0, 1), (0, 0, 2), rows=ROWS[:2]).skip().rows(
        *ROWS[:2]).cells(5, 4).points().points((3, 3, 1), rows=ROWS[2:]).rows(*ROWS[2:]).cells(1).end(3, 3)
    yield "attributes-mesh", "New vertices of patches have rows, patches without new vertices have none", Vector(
        "triangle mesh", grid=HALF, elevation=1, attributes=[COLOUR]).patch(
        0, SQUARE[:3], (), [(0, 1, 2)], (0,), rows=[([1, 2, 3],), ([0, 0, 65535],), ([4, 5, 6],)]).rows(
        ([1, 2, 3],), ([0, 0, 65535],), ([4, 5, 6],)).patch(3, SQUARE[3:], (1, 2), [(0, 2, 1)], (0, 1, 2),
        rows=[([7, 8, 9],)]).rows(([7, 8, 9],)).patch(4).end(4, vertices=4, simplices=2)
    yield "attributes-tetrahedra", "Rows stand before labels", Vector(**TETRAHEDRAL, attributes=[CLASS]).patch(
        0, CORNERS[:4], (), [(0, 1, 2, 3)], (0, 1, 2, 3), rows=[([1],), ([2],), ([3],), ([4],)]).rows(
        ([1],), ([2],), ([3],), ([4],)).labels(9, 8, 7, 6).end(4, vertices=4, simplices=1)
    yield "attributes-partial", "Residual points have rows, those that are vertices the same once more", Vector(
        **PARTIAL, attributes=[CLASS]).patch(0, SQUARE[:3], (), [(0, 1, 2)], rows=[([1],), ([2],), ([3],)]).rows(
        ([1],), ([2],), ([3],)).residual((0, 0, 0, 0), (None, 7, 7, 0), rows=[([1],), ([9],)]).rows(([1],), ([9],)).residual(
        (2, 0, 2, 1), (1, 2, 0, 1), rows=[([3],), ([2],)]).rows(([3],), ([2],)).walls((0, 3), (3, 2), (2, 0)).end(
        4, vertices=3, simplices=1, residual=4, walls=3)
    yield "attributes-none-written", "A header with attributes, and no points", Vector(attributes=[CLASS]).end()
    wide = Attribute("wide", "f64", 128)
    yield "attributes-longest", "The longest row", Vector(attributes=[wide]).points(
        ("0", "0"), rows=[(["0.5"] * 128,)]).rows((["0.5"] * 128,)).end(1)
    yield "attributes-compressed", "Compressed rows behind a block that is not", Vector(
        **COMPRESSED, attributes=[COLOUR]).points((0, 0, 0), (1, 1, 1), rows=[([1, 2, 3],), ([1, 2, 4],)]).instead(
        *packed_records(6, 0, 12, bytes([1, 1, 0, 0, 2, 2, 0, 0, 3, 4, 0, 0]))).rows().end(2)


def failing_attributes():
    """Attributes that break a rule."""
    of = lambda payload, **more: Vector(**{**dict(attributes=[CLASS]), **more}, raw=dict(attr=payload)).end()
    entry = lambda kind=1, components=1, flags=0, texts=(b"a", b"", b""), rest=b"": bytes(
        [kind, components, flags]) + b"".join(bytes([len(text)]) + text for text in texts) + rest
    yield "attributes-empty", "no attribute is listed", of(b"")
    yield "attributes-cut", "ends within an attribute", of(entry()[:-1])
    yield "attributes-tail", "ends within an attribute", of(entry() + bytes(2))
    yield "attributes-no-scale", "ends within an attribute", of(entry(flags=1, rest=bytes(8)))
    yield "attributes-no-unknown", "ends within an attribute", of(entry(kind=7, flags=2, rest=bytes(7)))
    yield "attributes-type", "type 11 of an attribute", of(entry(11))
    yield "attributes-type-zero", "type 0 of an attribute", of(entry(0))
    yield "attributes-flags", "flags 0x04", of(entry(flags=4))
    yield "attributes-components", "no components", of(entry(components=0))
    yield "attributes-nameless", "name has 0 bytes", of(entry(texts=(b"", b"", b"")))
    yield "attributes-control", "control characters", of(entry(texts=(b"a\n", b"", b"")))
    yield "attributes-control-unit", "control characters", of(entry(texts=(b"a", b"\xc2\x85", b"")))
    yield "attributes-control-las-name", "control characters", of(entry(texts=(b"a", b"", b"\x7f")))
    yield "attributes-text", "is not UTF-8", of(entry(texts=(b"\xff", b"", b"")))
    yield "attributes-names", 'two attributes "a"', of(entry() + entry(2))
    yield "attributes-scale-zero", "the scale 0 and the offset 1", of(entry(flags=1, rest=struct.pack("<2d", 0, 1)))
    yield "attributes-scale-infinite", "the scale inf", of(entry(flags=1, rest=struct.pack("<2d", INF, 1)))
    yield "attributes-offset-nan", "the offset", of(entry(flags=1, rest=struct.pack("<2d", 1, NAN)))
    yield "attributes-long", "rows of 1025 bytes", of(
        b"".join(entry(10, 64, texts=(b"%d" % n, b"", b"")) for n in range(2)) + entry(texts=(b"c", b"", b"")))
    yield "attributes-of-knots", "has no attributes", Vector(**CONFIGURATIONS, attributes=[CLASS]).end()
    yield "attributes-of-points4", "has no attributes", Vector(**POINTS4, attributes=[CLASS]).end()
    start = lambda **more: Vector(**{**dict(attributes=[CLASS], tree=QUADTREE), **more}).points(("0", "0"), ("1", "0"))
    two = [([1],), ([2],)]
    yield "rows-missing-end", 'block "END ", expected the attributes', start().end(2)
    yield "rows-missing", 'block "PNTS", expected the attributes', start().points(("1", "1")).rows(*two).end(3)
    yield "rows-after-cells", 'block "CELL", expected the attributes', start().cells(16).rows(*two).end(2, 1)
    yield "rows-few", "expected 2 rows of 1 bytes", start().rows(*two[:1]).end(2)
    yield "rows-many", "expected 2 rows of 1 bytes", start().rows(*two, *two).end(2)
    yield "rows-twice", "no points precede", start().rows(*two).rows(*two).end(2)
    yield "rows-first", "no points precede", Vector(attributes=[CLASS]).rows(*two).end()
    yield "rows-of-no-points", "no points precede", Vector(attributes=[CLASS]).points().rows().end()
    yield "rows-without-attributes", "without attributes", Vector().points(("0", "0")).block(b"attp", [(b"\1", "row")]).end(1)
    yield "rows-of-patch", "expected 3 rows of 1 bytes", Vector("triangle mesh", attributes=[CLASS]).patch(
        0, [("0", "0"), ("1", "0"), ("0", "1")], (), [(0, 1, 2)], (0, 1, 2)).rows(*two).end(3, vertices=3, simplices=1)
    yield "rows-of-labels", 'block "LABL", expected the attributes', Vector(**TETRAHEDRAL, attributes=[CLASS]).patch(
        0, CORNERS[:1], (), (), (0,)).labels(1).end(1, vertices=1)
    yield "rows-of-residual", 'block "WALL", expected the attributes', Vector(**PARTIAL, attributes=[CLASS]).residual(
        (None, 0, 0, 0), (None, 1, 0, 0)).walls((0, 1)).end(2, residual=2, walls=1)
    yield "rows-cut", "truncated", start().rows(*two).cut(1)
    yield "rows-unknown-required", "block tag \"ATTP\"", start().rows(*two, tag=b"ATTP").end(2)


CONSTRAINED = dict(kind="triangle mesh", grid=HALF, elevation=1, constrained=(True, 2.5))
# The first segment is the lower edge of the square and more, the second is its diagonal.
SEGMENTS = ((7, 0, 0, 4, 0), (4294967295, 2, 0, 0, 2))


def passing_constrained():
    """Constrained triangle meshes."""
    yield "constrained-square", "Two patches, an edge on a segment that both state, and a segment that leaves the mesh", Vector(
        **CONSTRAINED).segments(*SEGMENTS).patch(0, SQUARE[:3], (), [(0, 1, 2)], (0,), sides=[(0, 0, 1), (0, 2, 0)]).segments(
        (0, -1, -1, 5, 5)).patch(3, SQUARE[3:], (1, 2), [(0, 2, 1)], (0, 1, 2), sides=[(0, 0, 1)]).open(0).open(2).end(
        4, vertices=4, simplices=2)
    yield "constrained-f64", "In f64, with the whole hull; skipped blocks, and blocks without records", Vector(
        "triangle mesh", constrained=(False, 0)).segments().segments((1, "0", "0", "0.1", "0")).skip().patch(
        0, [("0", "0"), ("0.1", "0"), ("0", "1e-7")], (), [(0, 1, 2)], (0, 1, 2), sides=[(0, 2, 0)]).open().skip().end(
        3, vertices=3, simplices=1)
    yield "constrained-empty-sides", "A block of sides without records, a skipped block behind it, and attributes", Vector(
        **CONSTRAINED, attributes=[CLASS]).segments(*SEGMENTS).sides().skip().patch(
        0, SQUARE[:3], (), [(0, 1, 2)], (0, 1, 2), rows=[([1],), ([2],), ([3],)]).rows(([1],), ([2],), ([3],)).open(
        0, 1).end(3, vertices=3, simplices=1)
    yield "constrained-none", "A constrained mesh without segments", Vector("triangle mesh", constrained=(True, 0)).end()


def failing_constrained():
    """Constraints that break a rule."""
    of = lambda payload, **more: Vector(**{**CONSTRAINED, **more}, raw=dict(cons=payload)).end()
    cons = lambda flags, kill: bytes([flags]) + struct.pack("<d", kill)
    yield "constrained-short", "8 bytes, expected 9", of(cons(1, 0)[:-1])
    yield "constrained-long", "10 bytes, expected 9", of(cons(1, 0) + b"\0")
    yield "constrained-flags", "flags 0x02", of(cons(2, 0))
    yield "constrained-kill-negative", "kill length -1", of(cons(1, -1))
    yield "constrained-kill-infinite", "kill length inf", of(cons(1, INF))
    yield "constrained-kill-nan", "kill length", of(cons(1, NAN))
    yield "constrained-kill-of-hull", "a border that is not cut", of(cons(0, 1))
    yield "constrained-points", "is not constrained", Vector(constrained=(False, 0)).end()
    yield "constrained-partial", "is not constrained", Vector(**PARTIAL, constrained=(False, 0)).end()
    start = lambda: Vector(**CONSTRAINED).segments(*SEGMENTS)
    corners = (SQUARE[:3], (), [(0, 1, 2)], (0, 1, 2))
    whole = lambda vector: vector.end(3, vertices=3, simplices=1)
    patch = lambda sides, vector=None: whole((vector or start()).patch(0, *corners, sides=sides))
    plain = lambda: Vector("triangle mesh", grid=HALF, elevation=1)
    raw = lambda data: [(data, "payload")]
    yield "segments-not-constrained", 'block "segm" in a stream that is not constrained', plain().segments(SEGMENTS[0]).end()
    yield "sides-not-constrained", 'block "side" in a stream that is not constrained', plain().sides().patch(0).end()
    yield "open-not-constrained", 'block "open" in a stream that is not constrained', plain().open().end()
    yield "segments-of-points", "may stand here", Vector(grid=HALF, elevation=1).segments(SEGMENTS[0]).end()
    yield "segments-length", "whole number of records of 20", start().block(b"segm", raw(bytes(24))).end()
    yield "segments-equal-ends", "line 9 has equal ends", start().segments((9, 1, 1, 1, 1)).end()
    yield "segments-nan", "is not finite", Vector("triangle mesh", constrained=(False, 0)).segments(
        (1, "0", "0", "nan", "0")).end()
    yield "segments-after-open", "may stand here", whole(start().patch(0, *corners).open(0).segments(SEGMENTS[1]))
    yield "sides-length", "whole number of records of 12", start().block(b"side", raw(bytes(16))).patch(0, *corners).end()
    yield "sides-triangle", "triangle 1 of 1", patch([(1, 0, 0)])
    yield "sides-place", "side 3 of a triangle", patch([(0, 3, 0)])
    yield "sides-segment", "segment 2 of 2", patch([(0, 0, 2)])
    yield "sides-segment-later", "segment 0 of 0", Vector(**CONSTRAINED).patch(
        0, *corners, sides=[(0, 0, 0)]).segments(*SEGMENTS).end(3, vertices=3, simplices=1)
    yield "sides-order", "not increasing by triangle", patch([(0, 1, 0), (0, 0, 1)])
    yield "sides-repeated", "not increasing by triangle", patch([(0, 1, 0), (0, 1, 1)])
    yield "sides-twice", 'block "side", expected the patch', patch([(0, 1, 0)], start().sides())
    yield "sides-before-segments", 'block "segm", expected the patch', patch([(0, 1, 0)], start().sides().segments(SEGMENTS[0]))
    yield "sides-before-end", 'block "END ", expected the patch', start().sides().end()
    yield "open-length", "whole number of records of 4", start().block(b"open", raw(bytes(6))).end()
    yield "open-segment", "open segment 2 of 2", start().open(2).end()
    yield "open-order", "not increasing", start().open(1, 0).end()
    yield "open-repeated", "not increasing", start().open(1).open(1).end()
    yield "patch-after-open", "may stand here", patch([], start().open(0))


WEIGHT = Attribute("weight", "f64", 1)
WEIGHTED = dict(dims=3, grid=(("0.5",) * 3, ("0",) * 3), attributes=[CLASS, WEIGHT], weighted="2.25")
# Corners, and a point that is hidden among them.
HEAVY, HIDDEN = [([n], ["2.25"]) for n in range(4)], ([4], ["-7.5"])


def passing_weights():
    """Weighted points of space."""
    yield "weights-points", "Points with weights, the greatest below the limit", Vector(**WEIGHTED).points(
        (0, 0, 0), (1, 0, 0), rows=[([1], ["2.125"]), HIDDEN]).rows(([1], ["2.125"]), HIDDEN).end(2)
    yield "weights-mesh", "A vertex that is hidden, in an earlier patch than the tetrahedron around it", Vector(
        "tetrahedral mesh", **WEIGHTED).patch(0, [(1, 1, 1)], (), [], (0,), rows=[HIDDEN]).rows(HIDDEN).patch(
        1, [(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4)], (), [(0, 1, 2, 3)], (0, 1, 2, 3), rows=HEAVY).rows(*HEAVY).end(
        5, vertices=5, simplices=1)
    yield "weights-none", "No points, so no weights", Vector(**WEIGHTED, points=0).end()


def failing_weights():
    """Weights that break a rule."""
    of = lambda payload: Vector(**WEIGHTED, raw=dict(wght=payload)).end()
    limit = lambda value: Vector(**{**WEIGHTED, "weighted": value}).end()
    instead = lambda *attributes, **more: Vector(**{**WEIGHTED, "attributes": attributes, **more}).end()
    yield "weights-short", "7 bytes, expected 8", of(bytes(7))
    yield "weights-long", "9 bytes, expected 8", of(bytes(9))
    yield "weights-limit-infinite", "the greatest weight inf", limit("inf")
    yield "weights-limit-nan", "the greatest weight", limit("nan")
    yield "weights-plane", "of 2 dimensions", instead(WEIGHT, dims=2, elevation=1)
    yield "weights-partial", "weights in a stream of kind partial tetrahedral mesh", Vector(
        "partial tetrahedral mesh", **WEIGHTED, region=(0, 0, 0, 4, 4, 4)).end()
    yield "weights-without", 'need an attribute "weight"', instead()
    yield "weights-other", 'need an attribute "weight"', instead(CLASS)
    yield "weights-type", 'need an attribute "weight"', instead(Attribute("weight", "f32", 1))
    yield "weights-components", 'need an attribute "weight"', instead(Attribute("weight", "f64", 2))
    row = lambda value: Vector(**WEIGHTED).points((0, 0, 0), rows=[([1], [value])]).rows(([1], [value])).end(1)
    yield "weight-above", "weight 2.5, expected", row("2.5")
    yield "weight-infinite", "weight -inf, expected", row("-inf")
    yield "weight-nan", "weight", row("nan")


REGIONS = dict(kind="points in regions", dims=3)
ALL, LOW, HIGH = (-INF,) * 3 + (INF,) * 3, (-INF,) * 3 + (INF, INF, 2), (-INF, -INF, 2, INF, INF, INF)
ROW = [([1],), ([2],), ([3],)]


def passing_regions():
    """Points in regions that overlap."""
    yield "regions-three", "A point in all three regions, one in two of them, and points that one region has", Vector(
        **REGIONS, grid=EVEN, bounds=(0, 0, 0, 9, 0, 0), points=5).regions((0, 0, 0, 4, 4, 4), 1, 2).points(
        (0, 0, 0), (4, 0, 0)).points((5, 0, 0)).regions((4, 0, 0, "4.5", 4, 4), 0, 0, 1, 1).points(
        (5, 0, 0), (4, 0, 0)).regions((4, -1, 0, INF, 0, 4), 2, 0, 0, 1).points((8, 0, 0), (9, 0, 0), (5, 0, 0)).end(5)
    yield "regions-f64", "Coordinates of binary64; boxes may overlap, and points may lie outside of them", Vector(
        **REGIONS).regions(ALL, 1, 1).points(("0.1", "0", "-0.0"), ("1e22", "5", "5")).regions(
        ("-0.5", 0, 0, "5e-324", 1, 1), last=1).points(("1e22", "5", "5")).end(2)
    yield "regions-empty", "Regions without points, the first with an empty block", Vector(**REGIONS, points=0).regions(
        LOW).points().regions(HIGH).end()
    yield "regions-none", "No region, so no points", Vector(**REGIONS).end()
    yield "regions-attributes", "A point has a row in each region", Vector(**REGIONS, attributes=[CLASS]).regions(
        LOW, 1, 1).points(("0",) * 3, ("1",) * 3, rows=ROW[:2]).rows(*ROW[:2]).regions(HIGH, last=1).points(
        ("1",) * 3, rows=ROW[1:2]).rows(*ROW[1:2]).end(2)
    yield "regions-skipped", "Skipped blocks before the first region, within a region and at its end", Vector(
        **REGIONS).skip().regions(LOW, 2).points(("0",) * 3).skip().points(("1",) * 3).skip().regions(HIGH).skip().end(2)
    copies = packed_records(80, 0, 80, struct.pack("<6d4Q", *ALL, 1, 0, 0, 0))
    yield "regions-compressed", "A compressed region", Vector(**REGIONS, compressed=True).instead(*copies).regions(
        ALL, 1).points(("0",) * 3).end(1)


def failing_regions():
    """Points in regions that break a rule."""
    of = lambda **more: Vector(**{**REGIONS, **more}).end()
    yield "regions-plane", "points in regions in 2 dimensions", of(dims=2)
    yield "regions-tree", "a stream of kind points in regions has no finalization tree", of(tree=OCTREE)
    yield "regions-chunked", "can be chunked", of(chunked=True)
    yield "regions-weights", "weights in a stream of kind points in regions", of(**WEIGHTED)
    yield "regions-region", "a region goes with a partial mesh or a residual", of(region=ALL)
    yield "regions-scales", "expected one scale", of(grid=CM)
    yield "regions-part", "is no part of a mesh", of(part=(NODE, 0))
    one = lambda: Vector(**REGIONS)
    point = ("0",) * 3
    yield "regions-short", "region of 72 bytes, expected 80", one().block(b"REGN", [(bytes(72), "region")]).end()
    yield "regions-long", "region of 88 bytes, expected 80", one().block(b"REGN", [(bytes(88), "region")]).end()
    yield "regions-without", "region of 0 bytes, expected 80", one().block(b"REGN", []).end()
    for name, box in (("flat", (0, 0, 1, 1, 1, 1)), ("turned", (2, 0, 0, 1, 1, 1)), ("infinite", (0, INF, 0, 1, INF, 1)),
                      ("nan", (0, 0, "nan", 1, 1, 1)), ("nan-above", (0, 0, 0, 1, "nan", 1))):
        yield "regions-box-" + name, "region 1: the box is empty, or a side is NaN", one().regions(box).end()
    huge = 2**64 - 1
    yield "regions-own-huge", "region 1: its points are beyond counting", one().regions(ALL, huge).end()
    yield "regions-sum-huge", "region 1: its points are beyond counting", one().regions(ALL, 0, 2**63, 2**63).end()
    yield "regions-total-huge", "region 2 has 1 points of earlier regions", one().regions(LOW).regions(HIGH, huge - 2, 0, 0, 1).end()
    yield "regions-before-any", "points before the first region", one().points(point).end(1)
    yield "regions-before-any-empty", "points before the first region", one().points().regions(ALL).end()
    yield "regions-cells", "may stand here", one().regions(ALL).block(b"CELL", []).end()
    yield "regions-in-points", "may stand here", Vector(dims=3).regions(ALL, 1).points(point).end(1)
    yield "regions-few", "region 1 states 2 points, 1 follow", one().regions(LOW, 2).points(point).regions(HIGH).end(2)
    yield "regions-few-at-end", "region 1 states 2 points, 1 follow", one().regions(LOW, 2).points(point).end(2)
    yield "regions-none-at-end", "region 1 states 1 points, 0 follow", one().regions(LOW, 1).end(1)
    yield "regions-many", "region 1 states 1 points, at least 2 follow", one().regions(LOW, 1).points(point, point).end(1)
    yield "regions-many-later", "region 2 states 0 points, at least 1 follow", one().regions(LOW, 1).points(point).regions(
        HIGH).points(point).end(1)
    yield "regions-last-of-none", "region 1 has 1 points of earlier regions, but these share 0", one().regions(
        LOW, 0, 1, 0, 1).points(point, point).end(1)
    yield "regions-again-of-none", "region 1 has 2 points of earlier regions, but these share 0", one().regions(
        LOW, 0, 0, 2).points(point, point).end()
    shared = lambda: one().regions(LOW, 0, 1).points(point)
    yield "regions-last-of-final", "region 3 has 1 points of earlier regions, but these share 0", shared().regions(
        HIGH, last=1).points(point).regions(ALL, last=1).points(point).end(1)
    yield "regions-again-and-last", "region 2 has 2 points of earlier regions, but these share 1", shared().regions(
        HIGH, again=1, last=1).points(point, point).end(1)
    yield "regions-shared-at-end", "END: 1 points that regions share with later ones are in no later one", shared().regions(
        HIGH, again=1).points(point).end(1)
    yield "regions-outside-box", "outside of the header's bounding box", Vector(
        **REGIONS, bounds=(1, 1, 1, 2, 2, 2)).regions(ALL, 1).points(point).end(1)
    yield "regions-not-finite", "is not finite", one().regions(ALL, 1).points(("nan", "0", "0")).end(1)
    both = lambda **more: Vector(**REGIONS, **more).regions(LOW, 0, 1).points(point).regions(HIGH, last=1).points(point)
    yield "regions-end-copies", "END states 2 points, but the stream holds 1", both().end(2)
    yield "regions-end-header", "another number of points", both(points=2).end(1)
    yield "regions-no-end", "truncated", both()


NODE = 0x0123456789ABCDEF
# Parts 0 and 1 are leaves, part 2 joins what they leave, and part 3 is the root.
PART = lambda below, node=NODE, **more: dict(kind="triangle mesh", grid=HALF, elevation=1, part=(node, below), **more)
CLASSED = lambda below, node=NODE: PART(below, node, attributes=[CLASS])
SPACE_PART = lambda below: dict(**TETRAHEDRAL, part=(NODE, below))
# Corners of the joined mesh by letters, in the order of the parts that have them first: A to C in part 0, D to F in
# part 1, P in part 2, Q in part 3. Their classes count up.
PLACES = dict(A=(0, 0, 0), B=(2, 0, 1), C=(0, 2, 1), D=(8, 0, 2), E=(8, 8, 9), F=(6, 4, 3), P=(3, 6, 5), Q=(0, 8, 7))
GLOBAL = dict(A=(0, 0), B=(0, 1), C=(0, 2), D=(1, 0), E=(1, 1), F=(1, 2), P=(2, 0), Q=(3, 0))
GLOBAL = {letter: (part << 40) + number for letter, (part, number) in GLOBAL.items()}
CLASSES = {letter: ([number],) for number, letter in enumerate(PLACES)}
REST = dict(kind="residual of a triangle mesh", grid=HALF, elevation=1, region=(0, 0, 8, 8), part=(NODE, 2))
REST_SPACE = dict(kind="residual of a tetrahedral mesh", dims=3, grid=EVEN, region=(0, 0, 0, 8, 8, 8), part=(NODE, 2))


def part_patch(vector, first, letters, own, imported=(), simplices=(), finalized=(), kept=None):
    """A patch with the vertices `letters`, of which `own` are none of other parts, and their rows."""
    rows = [CLASSES[letter] for letter in letters]
    origins = [(local, GLOBAL[letter]) for local, letter in enumerate(letters) if letter not in own]
    new = [PLACES[letter] for letter in letters]
    vector.patch(first, new, imported, simplices, finalized, rows=rows, origins=origins or None, kept=kept)
    return vector.rows(*rows) if rows else vector


def leaf_part():
    """Keeps two vertices in a patch behind that which has them first."""
    vector = part_patch(Vector(**CLASSED(0)), 0, "ABC", "ABC", (), [(0, 1, 2)], (0,))
    return part_patch(vector, 3, "", "", (1, 2), (), (0, 1), (0, 1)).end(3, vertices=3, simplices=1)


def other_leaf_part():
    vector = part_patch(Vector(**CLASSED(0, NODE + 1)), 0, "DEF", "DEF", (), [(0, 1, 2)], (0, 1, 2), (0, 1, 2))
    return vector.end(5, vertices=3, simplices=1, merged=2)


def inner_part():
    vector = part_patch(Vector(**CLASSED(2)), 0, "BDPF", "P", (), [(0, 1, 3), (0, 3, 2)], (0, 1, 2, 3), (0, 2, 3))
    return vector.end(4, vertices=4, simplices=2)


def root_part():
    vector = part_patch(Vector(**CLASSED(3)), 0, "QCBP", "Q", (), [(2, 3, 1), (1, 3, 0)], (0, 1, 2))
    return part_patch(vector, 4, "FE", "", (3,), [(0, 1, 2)], (0, 1, 2)).end(6, vertices=6, simplices=3)


def passing_parts():
    """Parts of meshes, and residuals."""
    yield "parts-leaf", "The first part of a mesh: two vertices are kept, in a patch of their own, with attributes", leaf_part()
    yield "parts-leaf-second", "Another leaf: all its vertices are kept in the patch that has them", other_leaf_part()
    yield "parts-inner", "A part with vertices of other parts, some of which it keeps for its parent, and one of its own", inner_part()
    yield "parts-root", "The last part: its vertices are final everywhere, and only one is its own", root_part()
    yield "parts-space-leaf", "A tetrahedron that keeps three corners", Vector(**SPACE_PART(0)).patch(
        0, CORNERS[:4], (), [(0, 1, 2, 3)], (0, 1, 2, 3), kept=(1, 2, 3)).end(4, vertices=4, simplices=1)
    yield "parts-space-root", "A tetrahedron on three vertices of another part, whose ids do not increase", Vector(**SPACE_PART(5)).patch(
        0, [CORNERS[4], CORNERS[3], CORNERS[1], CORNERS[2]], (), [(0, 2, 1, 3)], (0, 1, 2, 3),
        origins=[(1, 3), (2, 1), (3, 2)]).end(4, vertices=4, simplices=1)
    yield "parts-empty", "A part without vertices, in f64", Vector("triangle mesh", part=(0, 3)).end()
    yield "parts-skipped", "Blocks without records, and skipped ones between those that belong together", Vector(**PART(1)).patch(
        0, SQUARE[:1], (), (), (0,), origins=[(0, 7)], kept=(), amid=b"note").skip().origins().kept().skip().patch(1).end(
        1, vertices=1)
    yield "parts-greatest", "The greatest name, number of parts below, and global id", Vector(
        **{**PART(0), "part": (2**64 - 1, 2**22 - 1)}).patch(
        0, SQUARE[:1], (), (), (0,), origins=[(0, (2**22 - 1 << 40) - 1)], kept=(0,)).end(1, vertices=1)
    pair = struct.pack("<IQIQ", 0, 1, 1, 2)
    yield "parts-compressed", "Compressed blocks of vertices of other parts", Vector(**COMPRESSED, kind="triangle mesh", part=(NODE, 1)).instead(
        *packed_records(12, 0, 24, bytes(pair[12 * record + at] for at in range(12) for record in range(2)))).patch(
        0, SQUARE[:2], (), (), (0, 1), origins=[(0, 1), (1, 2)]).end(2, vertices=2)
    yield "rest-plane", "The residual of a part: points of it and of earlier parts, and points that are no vertices yet", Vector(
        **REST).residual((GLOBAL["B"], 2, 0, 1), (GLOBAL["P"], 3, 6, 5)).residual((None, 1, 7, 1), (GLOBAL["F"], 6, 4, 3)).walls(
        (0, 1)).walls((3, 0), (1, 3)).end(23, residual=4, walls=3, merged=4)
    yield "rest-plane-attributes", "A residual with attributes, a box, the number of points, and a region without borders", Vector(
        **{**REST, "region": (-INF, -INF, INF, INF)}, bounds=(0, 0, 0, 8, 8, 9), points=6, attributes=[CLASS]).residual(
        (None, 8, 8, 9), (GLOBAL["B"], 2, 0, 1), rows=[([7],), CLASSES["B"]]).rows(([7],), CLASSES["B"]).end(6, residual=2)
    yield "rest-space", "The residual of a part in space", Vector(**REST_SPACE).residual(
        *[(number,) + corner for number, corner in enumerate(CORNERS[:3])], (2**41 + 5, 7, 7, 7)).walls(
        (0, 1, 2), (2, 1, 3)).end(9, residual=4, walls=2)
    yield "rest-empty", "A residual without points", Vector(**{**REST, "part": (NODE, 0)}, points=12).end(12, merged=12)


def failing_parts():
    """Parts that break a rule."""
    raw = lambda data: [(data, "payload")]
    header = lambda **fields: Vector(**{**PART(1), **fields}).end()
    yield "parts-short", 'header record "part": 11 bytes, expected 12', header(raw=dict(part=bytes(11)))
    yield "parts-long", 'header record "part": 13 bytes, expected 12', header(raw=dict(part=bytes(13)))
    yield "parts-below", "4194304 parts below, expected less than 4194304", header(part=(NODE, 2**22))
    yield "parts-below-greatest", "4294967295 parts below, expected less than", header(part=(NODE, 2**32 - 1))
    yield "parts-constrained", "neither constrained nor weighted", header(constrained=(False, 0))
    yield "parts-weighted", "neither constrained nor weighted", Vector(
        "tetrahedral mesh", **WEIGHTED, part=(NODE, 1)).end()
    yield "parts-of-points", "a stream of kind points is no part of a mesh", header(kind="points")
    yield "parts-partial", "is no part of a mesh", Vector(**PARTIAL, part=(NODE, 1)).end()
    yield "parts-partial-space", "is no part of a mesh", Vector(**PARTIAL_SPACE, part=(NODE, 1)).end()
    yield "parts-of-knots", "is no part of a mesh", Vector(**CONFIGURATIONS, part=(NODE, 1)).end()
    yield "parts-region", "a region goes with a partial mesh or a residual", header(region=(0, 0, 8, 8))
    part = lambda number=1, **more: Vector(**PART(number, **more))
    two = lambda vector, origins=None, kept=None, finalized=(0, 1): vector.patch(
        0, SQUARE[:2], (), (), finalized, origins=origins, kept=kept)
    ends = lambda vector: vector.end(2, vertices=2)
    plain = lambda: Vector("triangle mesh", grid=HALF, elevation=1)
    none = "in a stream that is no part of a mesh"
    yield "parts-from-without-part", 'block "from" ' + none, ends(two(plain(), [(0, 0)]))
    yield "parts-kept-without-part", 'block "kept" ' + none, ends(two(plain(), None, [0]))
    yield "parts-from-empty-without-part", 'block "from" ' + none, ends(two(plain(), []))
    yield "parts-from-of-points", 'may stand here', Vector(grid=HALF, elevation=1).origins().end()
    yield "parts-from-partial", 'may stand here', Vector(**PARTIAL).origins().patch().end()
    order = "vertices of other parts are not increasing numbers of new vertices"
    yield "parts-from-order", order, ends(two(part(), [(1, 0), (0, 1)]))
    yield "parts-from-repeated", order, ends(two(part(), [(0, 0), (0, 1)]))
    yield "parts-from-beyond", order, ends(two(part(), [(0, 0), (2, 1)]))
    yield "parts-from-imported", order, two(part(), None, None, (0,)).patch(
        2, SQUARE[2:3], (1,), (), (0, 1), origins=[(1, 0)]).end(3, vertices=3)
    yield "parts-from-same-part", "a vertex of part 1, expected one before part 1", ends(two(part(), [(0, 2**40)]))
    yield "parts-from-later-part", "a vertex of part 5, expected one before part 1", ends(two(part(), [(0, 5 << 40)]))
    yield "parts-from-first-part", "a vertex of part 0, expected one before part 0", ends(two(part(0), [(0, 0)]))
    yield "parts-from-beyond-bits", "a vertex of part 4194304, expected one before", ends(two(part(2**22 - 1), [(0, 2**62)]))
    yield "parts-from-no-vertex", "a vertex of part 16777215, expected one before", ends(two(part(), [(1, UNKNOWN)]))
    yield "parts-from-second-patch", "a vertex of part 1, expected one before part 1", two(part(), [(0, 0)]).patch(
        2, SQUARE[2:3], (), (), (0,), origins=[(0, 2**40)]).end(3, vertices=3)
    keeps = "is kept for other parts, but not finalized here, or not in order"
    yield "parts-kept-not-finalized", "vertex 1 of the patch " + keeps, two(part(), None, [0, 1], (0,)).patch(
        2, (), (1,), (), (0,)).end(2, vertices=2)
    yield "parts-kept-order", "vertex 0 of the patch " + keeps, ends(two(part(), None, [1, 0]))
    yield "parts-kept-repeated", "vertex 1 of the patch " + keeps, ends(two(part(), None, [1, 1]))
    yield "parts-kept-beyond", "vertex 2 of the patch " + keeps, ends(two(part(), None, [0, 1, 2]))
    yield "parts-kept-final-before", "vertex 0 of the patch " + keeps, two(part(), None, None, (0,)).patch(
        2, (), (1,), (), (), kept=(0,)).patch(2, (), (1,), (), (0,)).end(2, vertices=2)
    yield "parts-from-length", "whole number of records of 12", ends(two(part().block(b"from", raw(bytes(16)))))
    yield "parts-kept-length", "whole number of records of 4", ends(two(part().block(b"kept", raw(bytes(6)))))
    patch = "expected the patch of the vertices of other parts"
    yield "parts-from-twice", 'block "from", ' + patch, ends(two(part().origins((0, 0)), [(1, 1)]))
    yield "parts-from-empty-twice", 'block "from", ' + patch, ends(two(part().origins(), []))
    yield "parts-kept-twice", 'block "kept", ' + patch, ends(two(part().kept(0), None, [1]))
    yield "parts-from-after-kept", 'block "from", ' + patch, ends(two(part().kept(), []))
    yield "parts-kept-between", 'block "kept", ' + patch, ends(two(part().origins().kept(), None, []))
    yield "parts-from-before-end", 'block "END ", ' + patch, ends(two(part()).origins())
    yield "parts-kept-before-end", 'block "END ", ' + patch, ends(two(part()).kept())
    yield "parts-from-before-labels", 'block "LABL", ' + patch, Vector(**SPACE_PART(1)).origins().labels().end()
    yield "parts-from-before-segments", 'block "segm", ' + patch, part().origins().segments().end()
    yield "parts-from-before-required", 'the stream needs block tag "Kept"', part().origins().block(b"Kept", []).patch().end()
    yield "parts-from-before-rows", 'may stand here', Vector(**CLASSED(1)).origins().rows().end()
    yield "parts-rows-after-from", 'block "from", expected the attributes', Vector(**CLASSED(1)).patch(
        0, SQUARE[:1], (), (), (0,), rows=[([1],)]).origins().rows(([1],)).end(1, vertices=1)
    yield "parts-sides", 'block "side" in a stream that is not constrained', two(part(), None).sides().end()
    yield "parts-from-cut", "truncated", part().origins((0, 0)).cut(1)
    yield "parts-no-end", "truncated", two(part().origins())
    yield "parts-not-finalized", "1 of 2 vertices were finalized", ends(two(part(), [(1, 0)], None, (0,)))
    yield "parts-finalized-twice", "vertex 0 referenced after finalization", two(part(), None, [0]).patch(
        2, (), (0,), (), (0,)).end(2, vertices=2)
    yield "parts-points-of-others", "END states", two(part(), [(0, 0)]).end(1, vertices=2)
    yield "parts-vertices-of-others", "END states", two(part(), [(0, 0)]).end(2, vertices=1)
    yield "parts-residual", "may stand here", part().residual((None, 0, 0, 0)).end(1, residual=1)

    rest = lambda **fields: Vector(**{**REST, **fields})
    space = lambda **fields: Vector(**{**REST_SPACE, **fields})
    one = [(0, 1, 1, 0)]
    yield "rest-without-part", "a residual without the part that it is of", rest(part=None).end()
    yield "rest-space-without-part", "a residual without the part that it is of", space(part=None).end()
    yield "rest-below", "4194304 parts below, expected less than 4194304", rest(part=(NODE, 2**22)).end()
    yield "rest-without-region", "a region goes with a partial mesh or a residual", rest(region=None).end()
    yield "rest-space-without-region", "a region goes with a partial mesh or a residual", space(region=None).end()
    yield "rest-region-empty", "region is empty", rest(region=(0, 0, 0, 8)).end()
    yield "rest-region-length", "48 bytes, expected 32", rest(region=(0, 0, 0, 8, 8, 8)).end()
    yield "rest-tree", "no finalization tree", rest(tree=QUADTREE).end()
    yield "rest-space-tree", "no finalization tree", space(tree=OCTREE).end()
    yield "rest-chunked", "can be chunked", rest(chunked=True).end()
    yield "rest-in-space", "a residual of a triangle mesh in 3", rest(dims=3, elevation=0, grid=EVEN, region=(0,) * 3 + (8,) * 3).end()
    yield "rest-space-in-plane", "a residual of a tetrahedral mesh in 2", space(dims=2, region=(0, 0, 8, 8)).end()
    yield "rest-scales", "expected one scale", rest(grid=UNEVEN).end()
    yield "rest-space-scales", "expected one scale", space(grid=HALF).end()
    yield "rest-constrained", "is not constrained", rest(constrained=(False, 0)).end()
    yield "rest-weighted", "weights in a stream of kind residual of a tetrahedral mesh", Vector(
        "residual of a tetrahedral mesh", **WEIGHTED, region=(0,) * 3 + (8,) * 3, part=(NODE, 2)).end()
    yield "rest-patch", 'may stand here', rest().patch().end()
    yield "rest-space-patch", 'may stand here', space().patch().end()
    yield "rest-points", 'may stand here', rest().points().end()
    yield "rest-from", 'may stand here', rest().origins().end()
    yield "rest-kept", 'may stand here', rest().residual(*one).kept().end(1, residual=1)
    yield "rest-labels", 'may stand here', space().labels().end()
    yield "rest-after-walls", 'may stand here', rest().residual((None, 0, 0, 0), (None, 1, 1, 0)).walls(
        (0, 1)).residual((None, 2, 2, 0)).end(3, residual=3, walls=1)
    id_of = lambda vertex, number=2: rest(part=(NODE, number)).residual((vertex, 1, 1, 0)).end(1, residual=1)
    yield "rest-id-later-part", "residual point has the id %d of no vertex" % (3 << 40), id_of(3 << 40)
    yield "rest-id-first-part", "residual point has the id %d of no vertex" % 2**40, id_of(2**40, 0)
    yield "rest-id-beyond-bits", "residual point has the id %d of no vertex" % 2**62, id_of(2**62, 2**22 - 1)
    yield "rest-id-almost-none", "of no vertex", id_of(2**64 - 2)
    yield "rest-length", "whole number of records of 20", rest().block(b"RPNT", raw(bytes(24))).end(1, residual=1)
    yield "rest-outside-region", "outside of the region", rest().residual((None, 8, 0, 0)).end(1, residual=1)
    yield "rest-outside-box", "outside of the header's bounding box", rest(bounds=(0, 0, 0, 3, 3, 0)).residual(
        (None, 1, 1, 1)).end(1, residual=1)
    yield "rest-wall", "wall 0 to 1 between no", rest().residual(*one).walls((0, 1)).end(1, residual=1, walls=1)
    yield "rest-wall-length", "whole number of records of 12", space().residual(*one).block(b"WALL", raw(bytes(8))).end(
        1, residual=1)
    yield "rest-rows", 'block "END ", expected the attributes', rest(attributes=[CLASS]).residual(*one).end(1, residual=1)
    yield "rest-end-vertices", "END states", rest().residual(*one).end(1, residual=1, vertices=1)
    yield "rest-end-simplices", "END states", rest().residual(*one).end(1, residual=1, simplices=1)
    yield "rest-end-residual", "END states", rest().residual(*one).end(1)
    yield "rest-end-walls", "END states", rest().residual(*one).end(1, residual=1, walls=1)
    yield "rest-end-header", "another number of points", rest(points=2).residual(*one).end(1, residual=1)
    yield "rest-no-end", "truncated", rest().residual(*one)


def whole_mesh(parts, merged=0, bounds=None):
    """The manifest of parts: file, vector, name, parts below, own vertices, simplices and box."""
    entries = [dict(name="%016x" % node, below=below, file=file, bytes=len(vector.bytes()), vertices=vertices,
                    simplices=simplices, box=box)
               for file, vector, (node, below), vertices, simplices, box in parts]
    points = merged + sum(entry["vertices"] for entry in entries)
    return dict(format="spmesh mesh in parts", version=2, bounds=bounds, points=points, merged=merged, skipped=[],
                parts=entries)


def two_parts():
    """Two parts by names, and damaged ones. The first part keeps B and C."""
    parts = {}
    for name, keeps in (("leaf", (1, 2)), ("leaf-final", (1,))):
        parts[name] = Vector(**PART(0)).patch(0, [PLACES[letter] for letter in "ABC"], (), [(0, 1, 2)], (0, 1, 2), kept=keeps).end(
            3, vertices=3, simplices=1)
    for name, keeps, vertex in (("root", None, 2), ("root-keeps", (2,), 2), ("root-beyond", None, 3)):
        parts[name] = Vector(**PART(1)).patch(0, [PLACES[letter] for letter in "BCF"], (), [(0, 2, 1)], (0, 1, 2), origins=[
            (0, 1), (1, vertex)], kept=keeps).end(3, vertices=3, simplices=1)
    return parts


def joined():
    """Name of a mesh in parts, its manifest, and either its text twin or the words of the error, with an exit code."""
    parts = [("../pass/parts-leaf.spm", leaf_part(), (NODE, 0), 3, 1, [[0, 0, 0], [2, 2, 1]]),
             ("../pass/parts-leaf-second.spm", other_leaf_part(), (NODE + 1, 0), 3, 1, [[6, 0, 2], [8, 8, 9]]),
             ("../pass/parts-inner.spm", inner_part(), (NODE, 2), 1, 2, [[0, 0, 0], [8, 8, 9]]),
             ("../pass/parts-root.spm", root_part(), (NODE, 3), 1, 3, None)]
    whole = whole_mesh(parts, 2, [[0, 0, 0], [8, 8, 9]])
    vector = Vector("triangle mesh", grid=HALF, elevation=1, attributes=[CLASS], bounds=(0, 0, 0, 8, 8, 9))
    patch = lambda first, letters, *rest: vector.patch(
        first, [PLACES[letter] for letter in letters], *rest, rows=[CLASSES[letter] for letter in letters])
    patch(0, "ABC", (), [(0, 1, 2)], (0,))
    patch(3, "DEF", (), [(0, 1, 2)], ())
    # B, D and F are imported in the order of their ids: 1, 3, 5. D is final.
    patch(6, "P", (1, 3, 5), [(1, 2, 3), (1, 3, 0)], (2,))
    # B, C and P: 1, 2, 6.
    patch(7, "Q", (1, 2, 6), [(1, 3, 2), (2, 3, 0)], (0, 1, 2))
    # E, F and P: 4, 5, 6.
    patch(8, "", (4, 5, 6), [(1, 0, 2)], (0, 1, 2))
    yield "all", whole, vector.end(10, vertices=8, simplices=7, merged=2).text(), 0

    entries = whole["parts"]
    change = lambda at, **fields: dict(whole, parts=[dict(entry, **fields) if i == at else entry for i, entry in enumerate(entries)])
    order = lambda *places: dict(whole, parts=[entries[place] for place in places])
    none, other = "this is JSON, but no manifest of a mesh in parts", "this is another part than the manifest names"
    yield "version", dict(whole, version=3), "version 3 of a manifest", 6
    yield "format", dict(whole, format="spmesh plan"), "", 3
    yield "name-other", change(0, name="0123456789abcdee"), other, 3
    yield "name-none", change(2, name="plan"), "is no name of a part", 3
    yield "no-parts", dict(whole, parts=[]), "a mesh without parts", 3
    yield "unknown-field", dict(whole, colour=1), none, 3
    yield "box-not-ordered", dict(whole, bounds=[[0, 3, 0], [8, 2, 9]]), "bounding box is not ordered", 3
    yield "box-too-small", dict(whole, bounds=[[0, 0, 0], [7, 8, 9]]), "outside of the header's bounding box", 3
    yield "part-field-missing", dict(whole, parts=[{key: value for key, value in entry.items() if key != "vertices"}
                                                   for entry in entries]), none, 3
    yield "part-box-short", change(1, box=[[6, 0], [8, 8]]), none, 3
    yield "skipped-field", dict(whole, skipped=[dict(file="bad.laz")]), none, 3
    yield "part-twice", order(0, 1, 2, 2), "", 3
    yield "part-missing", order(0, 1, 3), "part 2 comes before one of the 3 below it", 3
    yield "part-other", change(3, file=entries[2]["file"]), other, 3
    yield "part-of-none", change(3, file="../pass/mesh-two-patches.spm"), other, 3
    yield "part-residual", change(2, file="../pass/rest-plane.spm"), other, 3
    yield "below-other", change(2, below=1), other, 3
    yield "vertices-many", change(0, vertices=4), "3 vertices of its own, expected 4", 3
    yield "vertices-few", change(0, vertices=2), "3 vertices of its own, expected 2", 3
    yield "order", order(0, 2, 1, 3), "part 1 comes before one of the 2 below it", 3
    # Parts use vertices of parts that have not kept them, or have fewer.
    two = two_parts()
    two["../fail/parts-kept-order"] = two["root"]
    pair = lambda first, second: whole_mesh([(first + ".spm", two[first], (NODE, 0), 3, 1, None),
                                             (second + ".spm", two[second], (NODE, 1), 1, 1, None)])
    vector = Vector("triangle mesh", grid=HALF, elevation=1).patch(
        0, [PLACES[letter] for letter in "ABC"], (), [(0, 1, 2)], (0,)).patch(
        3, [PLACES["F"]], (1, 2), [(1, 0, 2)], (0, 1, 2)).end(4, vertices=4, simplices=2)
    yield "two", dict(pair("leaf", "root"), skipped=[dict(file="bad.laz", reason="cut")]), vector.text(), 0
    yield "not-kept", pair("leaf-final", "root"), "", 3
    yield "kept-by-last", pair("leaf", "root-keeps"), "", 3
    yield "vertex-of-none", pair("leaf", "root-beyond"), "", 3
    yield "part-malformed", pair("leaf", "../fail/parts-kept-order"), "is kept for other parts", 3


def passing():
    """Name, title and vector of each stream that is well-formed."""
    yield "points-empty", "No points, nothing known but their number", Vector(
        grid=CM, elevation=1, points=0).end()
    yield "points-f64-2d", "Two dimensions without elevation, coordinates of every size", Vector(
        bounds=("-1e22", "-0.1", 0, "1.5", "5e-324", 0)).points(
        ("-1e22", "0"), ("-0.0", "5e-324"), ("1.5", "-0.1")).end(3)
    yield "points-f64-ties", "Numbers halfway between two decimals of 16 and of 17 digits: the last digit is even", Vector().points(
        ("900000000000000.2", "900000000000000.8"), ("3.0000076293945312", "-3.0000076293945312")).end(2)
    yield "points-i32-elevation", "Integers with a scale per axis, and well-known text with a line break", Vector(
        grid=CM, elevation=1, bounds=(-2147483648, -1, -7, 50, 2147483647, 7), points=3,
        wkt='LOCAL_CS["Gr\u00fcn",\nUNIT["m\\",1]]').points(
        (50, -1, 7), (-2147483648, 2147483647, 0)).points((0, 0, -7)).end(3)
    yield from passing_skipped()
    yield from passing_compressed()
    yield from passing_attributes()
    yield from passing_constrained()
    yield from passing_weights()
    yield from passing_regions()
    yield from passing_parts()
    yield "points-geokeys", "A CRS in GeoTIFF records, one of them empty", Vector(
        grid=HALF, elevation=1,
        geokeys=[bytes.fromhex("01000100000001000004000001000100"), b"", b"WGS 84|\0"]).points((1, 2, 3)).end(1)
    yield "points-millimetres", "Integers whose product with the scale is no short decimal in binary64", Vector(
        grid=(("0.001", "0.001", "0.0001"), ("0", "-4321987.65", "300000")), elevation=1).points(
        (28016, 1, 3), (-28016, 2147483647, -1), (2147483647, -2147483648, 2147483647), (-1, 0, -2147483648)).end(4)
    yield "points-feet", "A scale of many digits, and zero from a product and an offset", Vector(
        grid=(("0.3048006096012192", "0.3048006096012192", "0.01"), ("0", "0", "-500000")), elevation=1).points(
        (1, -1, 50000000), (0, 1000, 49999999)).end(2)
    yield "points-3d-octree", "Three dimensions, chunked by an octree that starts below zero", Vector(
        dims=3, chunked=True, tree=(1, -4, -4, -4, 8), bounds=(-4, -4, -1, 3, 1, "3.75")).cells(9, 10, 12, 13, 14).points(
        ("-4", "-4", "-1"), ("-1", "-0.5", "-1")).cells(8).points(("3", "1", "3.75"), ("0", "1", "-1")).cells(
        1).end(4, 7)
    yield "points-i32-3d", "Three dimensions in integers, no tree: each axis may have its own scale", Vector(
        grid=(("0.5", "0.25", "2"), ("0", "0", "0")), dims=3).points((1, 2, 3), (-1, -2, -3)).end(2)
    yield "points-uneven", "Two dimensions in integers, no tree: x and y may have their own scales", Vector(
        grid=UNEVEN).points((1, 2), (-1, -2)).end(2)
    yield "points-i32-octree", "An octree of integers: x, y and z have one scale", Vector(
        grid=EVEN, dims=3, tree=OCTREE).points((1, 2, 3)).cells(1).end(1, 1)
    yield "points-chunked", "Chunked by a quadtree; a run of tags in two blocks", Vector(
        grid=HALF, elevation=1, chunked=True, tree=QUADTREE, bounds=(0, 0, 0, 3, 3, 9), points=6).cells(
        24, 25).points((1, 0, 9), (1, 0, 8)).cells(16).cells(17).points((2, 1, 0)).points((3, 0, 0)).cells(
        5).points((2, 2, 1), (3, 3, 1)).cells(7).end(6, 6)
    yield "points-chunked-empty-blocks", "Chunked: blocks without records neither start nor end a run of tags", Vector(
        grid=HALF, chunked=True, tree=QUADTREE).cells().points((0, 0)).cells().points((0, 0)).points().cells(17).points(
        ).cells(16).points((3, 3)).cells(31).cells().points().cells(1).points().end(3, 4)
    yield "points-chunked-larger-cell", "Chunked: the cell that holds the points is tagged after others of its run", Vector(
        grid=HALF, chunked=True, tree=QUADTREE).points((0, 0), (1, 1), (3, 3)).cells(16, 5, 1).end(3, 3)
    yield "points-box-without-points", "A box without points says nothing", Vector(
        grid=HALF, bounds=(0, 0, 0, 3, 3, 0), points=0).points().end()
    yield "points-tagged", "Tags between points in input order: siblings one by one, then what is left of their parent", Vector(
        tree=QUADTREE).points(("0", "0"), ("3.5", "3.5"), ("1", "0")).cells(16, 17).points(("1", "1")).cells(
        19, 18).points(("3", "3")).cells(31).points(("2", "2")).cells(1).end(6, 6)
    yield "points-deep-tree", "A cell at the deepest level of a quadtree", Vector(
        grid=HALF, tree=(31, -(2**30), 0, 0, 2**31)).points((-(2**30), 0)).cells(2**62).points(
        (-(2**30) + 1, 0)).end(2, 1)
    yield "points-empty-blocks", "Blocks without records", Vector(grid=HALF, tree=QUADTREE).points().cells().points(
        (1, 1)).points().end(1)
    yield "mesh-empty", "A mesh without vertices", Vector("triangle mesh").end()
    yield "mesh-one-triangle", "One triangle in f64 without elevation", Vector("triangle mesh", points=3).patch(
        0, [("0", "0"), ("0.1", "0"), ("0", "1e-7")], (), [(0, 1, 2)], (0, 1, 2)).end(3, vertices=3, simplices=1)
    yield "mesh-two-patches", "Imports and finalization; one point was merged", Vector(
        "triangle mesh", grid=HALF, elevation=1, bounds=(0, 0, 0, 2, 2, 4), points=5).patch(
        0, SQUARE[:3], (), [(0, 1, 2)], (0,)).patch(3, SQUARE[3:], (1, 2), [(0, 2, 1)], (0, 1, 2)).end(
        5, vertices=4, simplices=2, merged=1)
    yield "mesh-late-finalization", "Patches that hold only vertices, only triangles, only finalization, and nothing", Vector(
        "triangle mesh", grid=HALF, elevation=1).patch(0, SQUARE).patch(4, (), (0, 1, 2), [(0, 1, 2)]).patch(
        4, (), (1, 2, 3), [(2, 1, 0)], (0,)).patch(4).patch(4, (), (0, 2, 3), (), (0, 1, 2)).end(
        4, vertices=4, simplices=2)
    yield "mesh-most-points", "As many points as END may state", Vector("triangle mesh", points=2**64 - 2).patch(
        0, [("0", "0")], (), (), (0,)).end(2**64 - 2, vertices=1, merged=2**64 - 3)
    yield "mesh-no-triangles", "Collinear points: vertices without triangles", Vector(
        "triangle mesh", grid=HALF).patch(0, [(0, 0), (1, 1), (2, 2)], (), (), (0, 1, 2)).end(7, vertices=3, merged=4)
    yield "partial-empty", "A partial mesh of the whole plane, without points", Vector(
        "partial triangle mesh", region=(-INF, -INF, INF, INF)).end()
    yield "partial-residual", "One final triangle, its walls, and two points that are no vertices yet", Vector(
        **PARTIAL, points=6).patch(0, SQUARE[:3], (), [(0, 1, 2)]).residual((0, 0, 0, 0), (None, 7, 7, 0)).residual(
        (2, 0, 2, 1), (1, 2, 0, 1), (None, 5, 0, 0)).walls((0, 3), (3, 2), (2, 0)).end(
        6, vertices=3, simplices=1, merged=1, residual=5, walls=3)
    yield "partial-finalized-inside", "A partial mesh of which one vertex is final", Vector(**PARTIAL).patch(
        0, [(2, 2, 0), (0, 0, 0), (6, 0, 0), (2, 6, 0)], (), [(0, 1, 2), (0, 2, 3), (0, 3, 1)], (0,)).residual(
        (1, 0, 0, 0), (2, 6, 0, 0), (3, 2, 6, 0)).walls((0, 1), (1, 2), (2, 0)).end(
        4, vertices=4, simplices=3, residual=3, walls=3)
    yield "partial-tetrahedra-empty", "A partial mesh of all of space, without points", Vector(
        "partial tetrahedral mesh", dims=3, region=(-INF, -INF, -INF, INF, INF, INF), points=0).end()
    yield ("partial-tetrahedra-residual", "One final tetrahedron, its walls in any turn, and two points that are no vertices yet",
        Vector(**PARTIAL_SPACE, bounds=(0, 0, 0, 7, 7, 7), points=7).patch(0, CORNERS[:4], (), [(0, 1, 2, 3)]).residual(
        (0, 0, 0, 0), (None, 7, 7, 7)).residual((2, 0, 4, 0), (1, 4, 0, 0), (3, 0, 0, 4), (None, 5, 0, 0)).walls(
        (4, 2, 3), (0, 2, 4)).walls((4, 3, 0), (0, 3, 2)).end(7, vertices=4, simplices=1, merged=1, residual=6, walls=4))
    yield "partial-tetrahedra-finalized-inside", "A partial mesh in space in f64 of which one vertex is final", Vector(
        "partial tetrahedral mesh", dims=3, region=("-0.5", -INF, "-1e-7", "4.5", INF, "5e-324")).patch(
        0, [("1", "1", "-1e-8"), ("0", "0", "0"), ("4", "0", "0"), ("0", "4", "0"), ("1", "1", "-1e-7")], (),
        [(1, 3, 2, 0), (1, 2, 4, 0), (2, 3, 4, 0), (3, 1, 4, 0)], (0,)).residual(
        (1, "0", "0", "0"), (2, "4", "0", "0"), (3, "0", "4", "0"), (4, "1", "1", "-1e-7")).walls(
        (0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)).end(5, vertices=5, simplices=4, residual=4, walls=4)
    yield "tetrahedra-empty", "A tetrahedral mesh without vertices", Vector(**TETRAHEDRAL).end()
    yield "tetrahedra-one", "One tetrahedron in f64 without labels", Vector(
        "tetrahedral mesh", dims=3, bounds=("-1e22", 0, "-0.0", "0.1", "5e-324", 3), points=4).patch(
        0, [("0", "0", "-0.0"), ("0.1", "0", "0"), ("-1e22", "5e-324", "0"), ("0", "0", "3")], (), [(0, 1, 2, 3)],
        (0, 1, 2, 3)).end(4, vertices=4, simplices=1)
    yield "tetrahedra-labels", "Two patches with their labels behind each; one point was merged", Vector(
        **TETRAHEDRAL, bounds=(0, 0, 0, 4, 4, 4), points=6).patch(0, CORNERS[:4], (), [(0, 1, 2, 3)], (0,)).labels(
        17, 4, 2**64 - 1, 4).patch(4, CORNERS[4:], (1, 2, 3), [(0, 1, 3, 2)], (0, 1, 2, 3)).labels(0).end(
        6, vertices=5, simplices=2, merged=1)
    yield "tetrahedra-labels-late", "Labels that lag behind, an empty block of them, and patches without tetrahedra", Vector(
        **TETRAHEDRAL).labels().patch(0, CORNERS[:3]).labels(1).patch(3, CORNERS[3:]).labels(2, 3).labels().patch(
        5, (), (0, 1, 2, 3, 4), [(0, 1, 2, 3), (4, 1, 3, 2)], (0, 1, 2, 3, 4)).labels(4, 5).end(
        5, vertices=5, simplices=2)
    yield "tetrahedra-none", "Coplanar points: vertices and labels without tetrahedra", Vector(**TETRAHEDRAL).patch(
        0, CORNERS[:3], (), (), (0, 1, 2)).labels(3, 2, 1).end(5, vertices=3, merged=2)
    yield "points4-empty", "No points in four dimensions", Vector(**POINTS4, points=0).end()
    yield "points4", "Points in four dimensions, in any order, one twice; an empty block", Vector(
        **POINTS4, points=4).points4(("1", "0", "-2.5", "1e22"), ("0", "-0.0", "5e-324", "0")).points4().points4(
        ("0", "-0.0", "5e-324", "0"), ("-1e-7", "0", "0", "0.1")).end(4)
    yield "points4-values", "Points in four dimensions with values, one of which is not known", Vector(
        **POINTS4, elevation=1).points4(
        ("0", "1", "2", "3", "280.15"), ("0", "1", "2", "3", "nan"), ("4", "5", "6", "7", "-0.0")).end(3)
    yield "cells4-empty", "A diagram without points", Vector(**DIAGRAM4).end()
    yield "cells4-simplex", "A simplex and the infinite cells around it", Vector(
        **DIAGRAM4, points=5).points4(*CORNERS4).cells4(*CELLS4).end(5, vertices=5, simplices=6)
    yield "cells4-split", "Cells that go on in later blocks, cut in counts and in lists, and values; a point was merged", Vector(
        **DIAGRAM4, elevation=1).points4(*[p + ("1.5",) for p in CORNERS4[:2]]).points4(
        *[p + ("nan",) for p in CORNERS4[2:]]).cells4(*CELLS4, split=(0, 1, 4, 10, 15, 15, 33)).end(
        6, vertices=5, simplices=6, merged=1)
    yield "cells4-none", "Points that span no cell, equal in all but the last coordinate", Vector(
        **DIAGRAM4).points4(("0", "0", "0", "-1"), ("-0.0", "0", "0", "0")).end(2, vertices=2)
    yield "cells4-no-neighbours", "A cell of six vertices that names no neighbour", Vector(**DIAGRAM4).points4(
        *CORNERS4, ("1", "1", "1", "1")).cells4((0, range(6), ())).end(6, vertices=6, simplices=1)
    yield "cells4-most-neighbours", "A cell of six vertices with as many neighbours as it can have", Vector(
        **DIAGRAM4).points4(*CORNERS4, ("1", "1", "1", "1")).cells4(
        (0, range(6), range(1, 10)), *[(1, (0, 1, 2, 3), ()) for _ in range(9)]).end(6, vertices=6, simplices=10)
    yield "simplices4", "Two simplices on a common facet, points in any order", Vector(
        **SIMPLICES4, points=7).points4(*CORNERS4[::-1]).points4(("1", "1", "1", "1")).simplices4(
        (4, 0, 1, 2, 3)).simplices4().simplices4((5, 0, 2, 1, 3)).end(7, vertices=6, simplices=2, merged=1)
    yield "simplices4-values", "Points with values, no simplices", Vector(**SIMPLICES4, elevation=1).points4(
        ("1", "0", "0", "0", "7"), ("0", "0", "0", "0", "7")).end(2, vertices=2)

    yield "configurations-empty", "No knots, no configurations", Vector(**CONFIGURATIONS).end()
    yield "configurations", "Four knots with all their configurations", Vector(
        **CONFIGURATIONS, bounds=(0, 0, 0, 8, 8, 0), points=4).points(*KNOTS).configurations(
        0, DEGREE0, standing=1).configurations(1, *DEGREE1, standing=1).end(4, simplices=13)
    yield "configurations-split", "Groups that go on in later blocks, an empty block, a degree that is left out", Vector(
        **CONFIGURATIONS).points(*KNOTS[:3]).points(*KNOTS[3:]).configurations(0, ((), DEGREE0[1][:1])).configurations(
        0, ((), DEGREE0[1][1:5]), goes_on="group").configurations(0, goes_on=True).configurations(
        0, ((), DEGREE0[1][5:]), goes_on="group").configurations(2, ((1, 2), [(0, 3)]), standing=2).configurations(
        2, ((1, 3), [(0, 2)]), standing=2, goes_on=True).end(4, simplices=8)
    yield "configurations-copies", "Knots at one place, with heights; a degree without configurations", Vector(
        "configurations", elevation=1).points(("0", "0", "1"), ("0", "0", "2"), ("1", "0", "0"), ("0", "1", "0")).configurations(
        0, ((), [(0, 1, 2), (0, 3, 1), (0, 2)])).configurations(3).end(4, simplices=3)
    yield "configurations-functions", "Functions of every kind, in two blocks", Vector(**CONFIGURATIONS).points(
        *KNOTS).configurations(1, *DEGREE1).functions(("edge", (0, 1), [(0, 1, "1")]), ("edge", (0, 3), [(0, 3, "0.5")]), (
            "vertex", (2,), [(0, 2, "0.1"), (1, 2, "-1e-7"), (2, 3, "1")])).functions(
        ("tent", (1, 3), [(1, 3, "1")]), ("crease", (0, 1, 3), [(0, 3, "1"), (1, 3, "1")]),
        ("face", (0, 1, 3, 2), [(0, 1, "0.5"), (0, 3, "0.5")])).end(4, vertices=6, simplices=7)
    yield "splines", "A spline of six functions of its own", Vector(**SPLINES).points(*KNOTS).configurations(
        1, *DEGREE1, standing=1).functions(*PAIRS).coefficients("1", "-2.5", "0", "1e300").coefficients(
        "0.1", "-5e-324").end(4, vertices=6, simplices=7, residual=6)
    yield "splines-no-functions", "A block FUNC without records is as good as none, whatever the degree", Vector(
        **SPLINES).points(*KNOTS).configurations(2, ((1, 2), [(0, 3)])).functions().coefficients("3").end(
        4, simplices=1, residual=1)
    yield "splines-cubic", "A spline of the B-splines of links, with heights of knots", Vector(
        "splines", elevation=1).points(("0", "0", "1"), ("8", "0", "2"), ("0", "8", "3"), ("2", "2", "4")).configurations(
        2, ((1, 2), [(0, 3)])).coefficients("3", "4").end(4, simplices=1, residual=2)


def passing_skipped():
    """Name, title and vector of streams with records in any order, and with records and blocks that are skipped."""
    records = lambda all: [(b"note", b"later")] + all[::-1] + [(b"a1 Z", b"")]
    yield "header-bare", "A header without records: no statement but the fixed fields", Vector(producer="").points(
        ("1", "2")).end(1)
    yield "header-producer-empty", "An empty name of the producer is as good as none", Vector(
        producer="", edit=lambda all: [(b"prod", b"")]).end()
    yield "header-records-turned", "Records in another order, among them two that are skipped, one of them empty", Vector(
        grid=HALF, tree=QUADTREE, bounds=(0, 0, 0, 3, 3, 0), wkt="LOCAL_CS", edit=records).points((1, 2)).end(1)
    yield "header-record-skipped", "Skipped records, one with a name that differs from that of a known one in its case", Vector(
        edit=lambda all: [(b"grid", bytes(range(48)))] + all + [(b"x   ", b"\0"), (b"cRS4", b"\xff")]).points(("1", "2")).end(1)
    yield ("header-record-skipped-region", "A region before other records, which are skipped", Vector(
        **PARTIAL_SPACE, edit=lambda all: all[1:2] + [(b"regn", b"ab")] + all[:1] + all[2:]).end())
    yield "skipped-only", "Skipped blocks alone; the last has the tag of END in small letters", Vector().skip().skip(
        b"pnts", bytes(15)).skip(b"end ", bytes(56)).end()
    yield "skipped-points", "Skipped blocks before the first block, between others and before END, empty and not", Vector(
        grid=HALF, tree=QUADTREE).skip(payload=b"first").points((1, 1)).skip().points((0, 0)).skip(b"q9 z", b"\0" * 40).cells(
        1).skip().skip(payload=b"last").end(2, 1)
    yield "skipped-chunked", "Skipped blocks neither start nor end a run of tags", Vector(
        grid=HALF, chunked=True, tree=QUADTREE).skip().points((0, 0)).skip(payload=b"in a chunk").points((0, 0)).cells(
        17).skip(payload=b"in a run").cells(16).skip().points((3, 3)).skip().cells(31).end(3, 3)
    yield "skipped-mesh", "Skipped blocks between patches", Vector("triangle mesh", grid=HALF, elevation=1).skip().patch(
        0, SQUARE[:3], (), [(0, 1, 2)], (0,)).skip(payload=b"amid").patch(
        3, SQUARE[3:], (1, 2), [(0, 2, 1)], (0, 1, 2)).skip().end(4, vertices=4, simplices=2)
    yield "skipped-partial", "Skipped blocks between blocks that have an order", Vector(**PARTIAL).skip(b"ptch").patch(
        0, SQUARE[:3], (), [(0, 1, 2)]).skip(b"wall", bytes(8)).residual((0, 0, 0, 0), (1, 2, 0, 1)).skip(b"ptch").residual(
        (2, 0, 2, 1)).skip(b"rpnt").walls((0, 1), (1, 2)).skip().walls((2, 0)).skip().end(
        3, vertices=3, simplices=1, residual=3, walls=3)
    yield "skipped-tetrahedra", "Skipped blocks between patches and labels", Vector(**TETRAHEDRAL).skip().patch(
        0, CORNERS[:4], (), [(0, 1, 2, 3)], (0, 1, 2, 3)).skip().labels(1, 2).skip(payload=b"amid").labels(3, 4).end(
        4, vertices=4, simplices=1)
    yield "skipped-cells4", "Skipped blocks within cells that go on in later blocks", Vector(**DIAGRAM4).skip().points4(
        *CORNERS4[:2]).skip().points4(*CORNERS4[2:]).skip(b"pnt4", b"3").cells4(*CELLS4, split=(1, 4, 33), amid=b"cel4").skip(
        ).end(5, vertices=5, simplices=6)
    yield "skipped-splines", "Skipped blocks between knots, within a group, and between functions and coefficients", Vector(
        **SPLINES).points(*KNOTS[:2]).skip().points(*KNOTS[2:]).skip(b"func").configurations(
        1, *DEGREE1[:1]).skip(payload=b"amid").configurations(1, *DEGREE1[1:], goes_on=True).skip().functions(*PAIRS[:3]).skip(
        b"conf").functions(*PAIRS[3:]).skip().coefficients("1", "2", "3").skip(b"coef").coefficients("4", "5", "6").skip().end(
        4, vertices=6, simplices=7, residual=6)


def passing_compressed():
    """Name, title and vector of streams with compressed blocks."""
    yield "compressed-points", "Points in columns: both predictors, sorted columns, a number of 32 bits", Vector(
        **COMPRESSED).instead(*packed_points(6, SIX_AXES, *SIX_COLUMNS)).points(*SIX).points((1, 2, 3)).end(7)
    one = packed_points(1, [(0, 7, -1), (1, 0, 2**31 - 1), (0, 0, -(2**31))], (7, [0]), (0, [1]), (0, [2]))
    yield "compressed-points-one", "One point: its first coordinates are changed, and wrap around", Vector(
        **COMPRESSED).instead(*one).points((-1, 2**31 - 2, -(2**31) + 1)).end(1)
    yield "compressed-patch", "Triangles by operations: loose, attached, by references and by open edges", Vector(
        "triangle mesh", **COMPRESSED).instead(
        *packed_patch(0, FAN_COUNTS, FAN_OPERATIONS, FAN_NUMBERS, FAN_MARKS)).patch(
        0, FAN, (), FAN_TRIANGLES, (0, 1, 2, 3, 4, 5, 6, 7, 10, 11)).instead(*packed_patch(
            13, (1, 3, 2, 4), [24, 108],
            [(2, []), (2, []), (2, [code(0), code(1), code(1)]), (2, [code(7)]), (2, [code(-7)]), (2, [code(70)]),
             (2, [8, 1, 3]), (2, [0, 0, 0])], [0x0F])).patch(
        13, [(7, -7, 70)], (8, 9, 12), [(1, 2, 0), (2, 1, 3)], (0, 1, 2, 3)).end(14, vertices=14, simplices=14)
    yield "compressed-patch-empty", "A patch of nothing, and one of vertices without triangles", Vector(
        "triangle mesh", **COMPRESSED).instead(*packed_patch(0, (0, 0, 0, 0), [], [(0, [])] * 8, [])).patch().instead(
        *packed_patch(0, (2, 0, 0, 2), [], [(0, [])] * 3 + [(2, [code(3), code(-1)])] * 3 + [(0, [])] * 2, [3])).patch(
        0, [(3, 3, 3), (2, 2, 2)], (), (), (0, 1)).end(2, vertices=2)
    doubles = struct.pack("<6d", 1, 2, 3, 4, 5, 6)
    planes = b"".join(doubles[place::16] for place in range(16))
    yield "compressed-records", "Records by planes, whole and with bytes left; frames of several blocks", Vector(
        compressed=True).instead(*packed_records(16, 0, 48, planes)).points(("1", "2"), ("3", "4"), ("5", "6")).instead(
        *packed_records(30, 0, 48, bytes(doubles[:30]) + doubles[30:])).points(("1", "2"), ("3", "4"), ("5", "6")).instead(
        *packed_records(65535, 0, 16, b"", frame(b"", [(1, 16, b"\0"), (0, 0, b"")], b"\0\x08"))).points(
        ("0", "0")).instead(*packed_records(1, 0, 0, b"")).points().end(7)
    # Cells 17 16 31: the differences 17, -1, 15 have the codes 34, 1, 30.
    words = bytes([34, 1, 30]) + bytes(21)
    # (1, 1, -1), (3, 1, 0) less the words before: 1, 1, -1 with the codes 2, 2, 1, and 2, 0, 1 with 4, 0, 2.
    deltas = bytes([2, 4, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 0, 0])
    yield "compressed-words", "Records with differences of words of 4 and of 8 bytes", Vector(
        tree=QUADTREE, **COMPRESSED).instead(*packed_records(12, 4, 24, deltas)).points((1, 1, -1), (3, 1, 0)).instead(
        *packed_records(8, 8, 24, words)).cells(17, 16, 31).end(2, 3)
    yield "compressed-skipped", "A skipped block is not decompressed", Vector(**COMPRESSED).instead(
        (b"\xff\xfe", "no method")).skip().points((1, 2, 3)).instead().skip().end(1)
    yield "compressed-none", "Blocks may be compressed, but none is", Vector(**COMPRESSED).points((1, 2, 3)).end(1)


def failing_compressed(raw):
    """Name, words of the error, and vector of streams with a compressed block that is malformed."""
    points = lambda *body, **fields: Vector(**dict(COMPRESSED, **fields)).instead(*body).block(b"PNTS", []).end(1)
    axes = [(0, 2, 0)] * 3
    zeros = [(2, [0])] * 3
    one = lambda count=1, axes=axes, parts=zeros: points(*packed_points(count, axes, *parts))
    records = lambda *fields: points(*packed_records(*fields))
    yield "compressed-no-feature", "a compressed block in a stream without feature bit 0", points(
        *packed_points(1, axes, *zeros), compressed=False)
    yield "compressed-skipped-no-feature", "a compressed block in a stream without feature bit 0", Vector(
        grid=HALF).instead((b"abc", "skipped")).skip().end()
    yield "compressed-end", "END is compressed: it must not be", Vector(**COMPRESSED).instead(
        *packed_records(8, 0, 56, bytes(56))).end()
    yield "compressed-oversize", "the maximum is 1048576", Vector(**COMPRESSED).instead().block(
        b"PNTS", [], length=2**20 + 1)
    yield "compressed-checksum", "checksum does not match", Vector(**COMPRESSED).instead(
        *packed_points(1, axes, *zeros)).points((0, 0, 0), checksum=0).end(1)
    yield "compressed-empty", "empty, expected a method", points()
    yield "compressed-method-0", "method 0, expected 1, 2 or 3", points((b"\0", "method"), (bytes(12), "a point"))
    yield "compressed-method-4", "method 4, expected 1, 2 or 3", points((b"\4", "method"))
    yield "compressed-cut-off", "cut off", points(*packed_points(1, axes, *zeros)[:3])
    yield "compressed-frame-long", "cut off", points(*packed_points(1, axes, *zeros)[:5], *raw(struct.pack("<I", 99)))
    yield "compressed-frame-magic", "not one zstd frame", records(12, 0, 12, b"", b"\x29" + frame(bytes(12))[1:])
    yield "compressed-frame-cut", "not one zstd frame", records(12, 0, 12, b"", frame(bytes(12))[:-1])
    yield "compressed-frames", "not one zstd frame", records(12, 0, 24, b"", frame(bytes(12)) * 2)
    yield "compressed-frame-skippable", "not one zstd frame", records(
        12, 0, 12, b"", b"\x50\x2a\x4d\x18\0\0\0\0" + frame(bytes(12)))
    yield "compressed-frame-none", "not one zstd frame", records(12, 0, 12, b"", b"")
    yield "compressed-frame-size", "the zstd frame is damaged", records(
        12, 0, 12, b"", frame(bytes(12), head=b"\x20\x0b"))
    yield "compressed-frame-dictionary", "the zstd frame is damaged", records(
        12, 0, 12, b"", frame(bytes(12), head=b"\x21\7\x0c"))
    yield "compressed-frame-window", "a window above 2^23 bytes", records(
        12, 0, 12, b"", frame(bytes(12), head=b"\0\x69"))
    yield "compressed-frame-size-many", "the zstd frame is damaged", records(
        12, 0, 12, b"", frame(bytes(12), head=b"\x20\x0d"))
    yield "compressed-records-long", "its content is too long", records(12, 0, 12, bytes(13))
    yield "compressed-records-bomb", "its content is too long", records(
        12, 0, 12, b"", frame(b"", [(1, 2**17, b"\0")] * 9, b"\0\x50"))
    yield "compressed-records-short", "fewer bytes than the payload", records(12, 0, 24, bytes(12))
    yield "compressed-records-huge", "more bytes than fit a block", records(12, 0, 2**20 + 1, bytes(12))
    yield "compressed-records-none", "records of 0 bytes", records(0, 0, 12, bytes(12))
    yield "compressed-records-word", "words of another width than 0, 4 or 8", records(12, 2, 12, bytes(12))
    yield "compressed-records-words", "of no whole number of words", records(12, 8, 12, bytes(12))
    yield "compressed-records-content", "whole number of records of 12", records(12, 0, 13, bytes(13))
    yield "compressed-points-none", "no points, or more than fit a block", one(0, parts=[])
    yield "compressed-points-many", "no points, or more than fit a block", one(87382)
    yield "compressed-points-predictor", "a predictor above 1", one(axes=[(0, 2, 0), (2, 2, 0), (0, 2, 0)])
    yield "compressed-points-k", "a parameter k above 7", one(axes=[(0, 8, 0)] + axes[1:])
    yield "compressed-points-token", "a token stands for no number of 32 bits", one(
        axes=[(0, 3, 0)] + axes[1:], parts=[b"\xf0"] + zeros[1:])
    yield "compressed-points-tokens-few", "too few tokens", one(parts=zeros[1:])
    yield "compressed-points-tokens-many", "its content is too long", one(parts=zeros + zeros[1:])
    yield "compressed-points-bits-few", "too few bits", one(parts=[b"\x15"] + zeros[1:])
    yield "compressed-points-bits-left", "bits are left", points(*packed_points(1, axes, *zeros), *raw(b"\0"))
    yield "compressed-points-box", "outside of the header's bounding box", Vector(
        bounds=(0, 0, 0, 1, 1, 1), **COMPRESSED).instead(*packed_points(1, [(0, 2, 2)] * 3, *zeros)).points(
        (2, 2, 2)).end(1)

    def patch(counts=(3, 0, 1, 3), operations=(0,), numbers=(), marks=(7,), first=0, edit=lambda t, b: (t, b)):
        new, imported = counts[:2]
        all = [(2, [])] * 3 + [(2, [0] * min(new, 8))] * 3 + [(2, [0] * min(imported, 8))] * 2
        for column, values in numbers:
            all[column] = (2, values)
        return Vector("triangle mesh", **COMPRESSED).instead(
            *packed_patch(first, counts, operations, all, marks, edit)).block(b"PTCH", []).end(3, vertices=3, simplices=1)

    attached = lambda operation, *numbers: patch((4, 0, 2, 4), (0, operation), numbers, (15,))
    yield "compressed-patch-counts", "counts of more than fits a block", patch(
        (87382, 0, 0, 0), numbers=[(column, []) for column in range(8)])
    yield "compressed-patch-counts-huge", "counts of more than fits a block", patch(
        (2**32 - 1,) * 4, numbers=[(column, []) for column in range(8)])
    yield "compressed-patch-operation", "an operation above 152", attached(153)
    yield "compressed-patch-first", "a distance to before the first triangle", patch(operations=(90,))
    yield "compressed-patch-distance", "a distance to before the first triangle", attached(27, (0, [0]))
    yield "compressed-patch-distance-huge", "a distance to before the first triangle", attached(27, (0, [2**32 - 1]))
    yield "compressed-patch-edge", "an open edge that does not exist", attached(27 + 63 + 9 * 5)
    yield "compressed-patch-new", "a new vertex that does not exist", patch((2, 0, 1, 2), marks=(3,))
    yield "compressed-patch-reference", "a new vertex that does not exist", patch(operations=(1,), numbers=[(1, [3])])
    yield "compressed-patch-import", "an imported vertex that does not exist", patch(
        (2, 1, 1, 3), (2,), [(2, [code(1)])])
    yield "compressed-patch-import-new", "an imported vertex that does not exist", patch(
        (2, 1, 1, 3), (2,), [(2, [code(-1)])])
    yield "compressed-patch-twice", "a triangle that uses a vertex twice", patch(operations=(1,), numbers=[(1, [0])])
    yield "compressed-patch-apex", "a triangle that uses a vertex twice", attached(27 + 63 + 9, (1, [1]))
    yield "compressed-patch-marks", "another number of finalized vertices", patch(marks=(3,))
    yield "compressed-patch-mark", "a finalized vertex that does not exist", patch(marks=(0x0B,))
    yield "compressed-patch-tokens-left", "tokens are left", patch(
        (3, 0, 1, 3), edit=lambda tokens, bits: (tokens + b"\0", bits))
    yield "compressed-patch-first-id", "patch starts with vertex 1, expected 0", patch(first=1)


def failing_headers():
    """Name, words of the error, and vector, for each broken rule of headers. Bytes override stored fields."""
    f64 = lambda *values: struct.pack("<%dd" % len(values), *values)
    damage = [
        ("magic", "not those of a spmesh stream", dict(magic=b"\x88SPM\r\n\x1a\n")),
        ("magic-text-mode", "not those of a spmesh stream", dict(magic=b"\x89SPM\n\x1a\n")),
        ("version", "version 3; this program reads version 2: a newer spmesh made it", dict(version=b"\3\0")),
        ("version-1", "version 1; this program reads version 2 only: an older spmesh made it, make it again", dict(version=b"\1\0")),
        ("version-huge", "version 65535; this program reads version 2: a newer spmesh made it", dict(version=b"\xff\xff", checksum=bytes(4))),
        ("kind", "the stream needs kind 99", dict(code=b"\x63\0")),
        ("feature-bit", "the stream needs feature bit 3", dict(features=b"\x08\0\0\0")),
        ("feature-bit-last", "the stream needs feature bit 31", dict(features=b"\0\0\0\x80", type=b"\3", dims=b"\7")),
        ("header-oversize", "the maximum is 1048576", dict(length=struct.pack("<I", 2**20 + 1))),
        ("header-undersize", "the minimum is 16", dict(length=struct.pack("<I", 15))),
        ("header-of-no-length", "the minimum is 16", dict(length=bytes(4))),
        ("header-short", "truncated", dict(length=struct.pack("<I", 2**20))),
        ("header-checksum", "checksum does not match", dict(checksum=bytes(4))),
        ("coordinate-type", "the stream needs coordinate type 3", dict(type=b"\3", dims=b"\7")),
        ("dims", "dimension", dict(dims=b"\4")),
        ("elevation-in-3d", "elevation", dict(dims=b"\3", elevation=b"\1")),
        ("elevation-of-two", "elevation 2, expected 0 or 1", dict(elevation=b"\2")),
        ("flag-of-none", "flags 0x10", dict(flags=b"\x10")),
        ("flag-of-none-and-chunked", "flags 0x03", dict(flags=b"\3", tree=QUADTREE)),
        ("record-required", 'the stream needs header record "ABCD"', dict(edit=lambda all: all + [(b"ABCD", b"")])),
        ("record-required-and-fault", 'the stream needs header record "X 1 "', dict(
            bounds=(1, 0, 0, 0, 0, 0), dims=b"\7", flags=b"\x80", edit=lambda all: all + [(b"X 1 ", b"\0"), (b"note", b"")])),
        ("record-twice", 'two header records "GRID"', dict(grid=HALF, edit=lambda all: all + all[:1])),
        ("record-skipped-twice", 'two header records "note"', dict(
            edit=lambda all: [(b"note", b"a")] + all + [(b"note", b"")])),
        ("record-required-twice", 'two header records "ABCD"', dict(edit=lambda all: [(b"ABCD", b"")] * 2)),
        ("record-cut", "7 bytes after the last header record", dict(tail=b"note\0\0\0")),
        ("record-longer-than-body", 'header record "note" of 7 bytes, but 6 are left', dict(tail=b"note\7\0\0\0abcdef")),
        ("record-huge", 'header record "ABCD" of 4294967295 bytes, but 0 are left', dict(tail=b"ABCD\xff\xff\xff\xff")),
        ("record-tag-digit-first", 'header record tag "1RID"', dict(edit=lambda all: [(b"1RID", b"")])),
        ("record-tag-space-first", 'header record tag " RID"', dict(edit=lambda all: [(b" RID", b"")])),
        ("record-tag-zero", 'header record tag "pr\\x00d"', dict(edit=lambda all: [(b"pr\0d", b"")])),
        ("record-tag-escape", 'header record tag "n\\x1b[2"', dict(edit=lambda all: [(b"n\x1b[2", b"")])),
        ("record-tag-not-ascii", 'header record tag "no\\xc3\\xa9"', dict(edit=lambda all: [(b"no\xc3\xa9", b"")])),
        ("record-tag-punctuation", 'header record tag "no_e"', dict(edit=lambda all: [(b"no_e", b"")])),
        ("grid-length", 'header record "GRID": 47 bytes, expected 48', dict(grid=HALF, GRID=bytes(47))),
        ("grid-of-f64", 'header record "GRID": f64 coordinates have no grid', dict(edit=lambda all: [(b"GRID", f64(1, 1, 1, 0, 0, 0))])),
        ("grid-missing", 'no header record "GRID"', dict(grid=HALF, edit=lambda all: all[1:])),
        ("box-length", 'header record "BBOX": 32 bytes, expected 48', dict(bounds=(0,) * 6, BBOX=bytes(32))),
        ("tree-length", 'header record "TREE": 36 bytes, expected 28', dict(tree=QUADTREE, TREE=f64(0, 0, 0, 4) + b"\2\0\0\0")),
        ("octree-length", 'header record "TREE": 28 bytes, expected 36', dict(dims=3, tree=OCTREE, TREE=f64(0, 0, 4) + b"\2\0\0\0")),
        ("region-length", 'header record "REGN": 48 bytes, expected 32', dict(kind="partial triangle mesh", region=(0, 0, 0, 8, 8, 8))),
        ("partial-tetrahedra-region-length", 'header record "REGN": 32 bytes, expected 48', dict(**{**PARTIAL_SPACE, "region": (0, 0, 8, 8)})),
        ("crs-twice", "the header has the CRS in another record already", dict(wkt="", geokeys=[b"", b"", b""])),
        ("crs-twice-turned", "the header has the CRS in another record already", dict(
            wkt="ab", geokeys=[b"", b"", b""], edit=lambda all: all[::-1])),
        ("crs-not-utf8", "CRS is not UTF-8", dict(wkt="ab", cWKT=b"\xff\xfe")),
        ("geokeys-short", "GeoKey records do not fit", dict(geokeys=[b"", b"", b""], cGEO=bytes(11))),
        ("geokeys-length", "GeoKey records do not fit", dict(geokeys=[b"", b"", b"ab"], cGEO=b"\0\0\0\0\0\0\0\0\3\0\0\0ab")),
        ("geokeys-left-over", "GeoKey records do not fit", dict(geokeys=[b"", b"", b"ab"], cGEO=bytes(12) + b"ab")),
        ("producer-not-utf8", "producer is not UTF-8", dict(prod=b"\xff" * 6)),
        ("scale-zero", "scale is not positive", dict(grid=HALF, GRID=f64(0.5, 0, 1, 0, 0, 0))),
        ("scale-nan", "scale is not positive", dict(grid=HALF, GRID=f64(0.5, NAN, 1, 0, 0, 0))),
        ("scale-infinite", "too far apart", dict(grid=HALF, GRID=f64(1, 1, INF, 0, 0, 0))),
        ("offset-too-far", "too far apart", dict(grid=HALF, GRID=f64(0.5, 0.5, 0.25, 0, 0.5 * 2.0**51 + 1, 0))),
        ("scales-quadtree", "expected one scale", dict(grid=UNEVEN, elevation=1, tree=QUADTREE)),
        ("scales-octree", "expected one scale", dict(grid=HALF, dims=3, tree=OCTREE)),
        ("scales-mesh", "expected one scale", dict(kind="triangle mesh", grid=UNEVEN)),
        ("scales-partial", "expected one scale", dict(**{**PARTIAL, "grid": UNEVEN})),
        ("scales-tetrahedra", "expected one scale", dict(**{**TETRAHEDRAL, "grid": HALF})),
        ("scales-partial-tetrahedra", "expected one scale", dict(**{**PARTIAL_SPACE, "grid": UNEVEN})),
        ("scales-configurations", "expected one scale", dict(**{**CONFIGURATIONS, "grid": UNEVEN})),
        ("scales-splines", "expected one scale", dict(**{**SPLINES, "grid": UNEVEN})),
        ("box-not-ordered", "box is not ordered", dict(bounds=(0, 1, 0, 1, 0, 0))),
        ("box-nan", "box is not ordered", dict(bounds=(0, 0, 0, 1, 1, 0), BBOX=f64(0, NAN, 0, 1, 1, 0))),
        ("box-infinite", "not storable", dict(bounds=(0, 0, 0, INF, 1, 0))),
        ("box-fraction", "not storable", dict(grid=HALF, bounds=(0, 0, 0, "0.5", 1, 0))),
        ("box-height", "no z", dict(bounds=(0, 0, 0, 1, 1, 1))),
        ("box-outside-tree", "box does not lie in the finalization tree", dict(bounds=(0, 0, 0, 4, 1, 0), tree=QUADTREE)),
        ("tree-side", "out of range or not exact", dict(tree=(2, 0, 0, 0, 3))),
        ("tree-side-negative", "out of range or not exact", dict(tree=(2, 0, 0, 0, -4))),
        ("tree-origin", "out of range or not exact", dict(tree=(2, "0.1", 0, 0, 4))),
        ("tree-origin-far", "out of range or not exact", dict(tree=(2, 2.0**24, 0, 0, 4))),
        ("tree-depth", "out of range or not exact", dict(tree=(32, 0, 0, 0, 4))),
        ("octree-depth", "out of range or not exact", dict(dims=3, tree=(21, 0, 0, 0, 4))),
        ("chunked-without-tree", "can be chunked", dict(chunked=True)),
        ("chunked-mesh", "can be chunked", dict(kind="triangle mesh", chunked=True, tree=QUADTREE)),
        ("region-of-points", "region goes with a partial mesh", dict(region=(0, 0, 1, 1))),
        ("region-missing", "region goes with a partial mesh", dict(kind="partial triangle mesh")),
        ("region-empty", "region is empty", dict(kind="partial triangle mesh", region=(0, 0, 0, 1))),
        ("region-nan", "region is empty", dict(kind="partial triangle mesh", region=(0, 0, 1, NAN))),
        ("mesh-in-3d", "a triangle mesh in 3", dict(kind="triangle mesh", dims=3)),
        ("tetrahedra-in-2d", "a tetrahedral mesh in 2", dict(kind="tetrahedral mesh", elevation=1)),
        ("tetrahedra-region", "region goes with a partial mesh", dict(kind="tetrahedral mesh", dims=3, region=(0, 0, 0, 1, 1, 1))),
        ("tetrahedra-chunked", "can be chunked",
            dict(kind="tetrahedral mesh", dims=3, chunked=True, tree=(2, 0, 0, 0, 4))),
        ("partial-tetrahedra-in-2d", "a partial tetrahedral mesh in 2", dict(kind="partial tetrahedral mesh", region=(0,) * 3 + (1,) * 3)),
        ("partial-in-3d", "a partial triangle mesh in 3", dict(kind="partial triangle mesh", dims=3, region=(0, 0, 1, 1))),
        ("partial-tetrahedra-region-missing", "region goes with a partial mesh", dict(kind="partial tetrahedral mesh", dims=3)),
        ("partial-tetrahedra-region-empty", "region is empty",
            dict(kind="partial tetrahedral mesh", dims=3, region=(0, 0, 1, 1, 1, 1))),
        ("partial-tetrahedra-region-nan", "region is empty",
            dict(kind="partial tetrahedral mesh", dims=3, region=(0, 0, 0, 1, 1, NAN))),
        ("partial-tetrahedra-tree", "no finalization tree", dict(**PARTIAL_SPACE, tree=OCTREE)),
        ("partial-tetrahedra-chunked", "can be chunked", dict(**PARTIAL_SPACE, chunked=True)),
        ("points4-in-3d", "expected 4", dict(kind="points in 4 dimensions", dims=3)),
        ("cells4-in-2d", "expected 4", dict(kind="cells in 4 dimensions", dims=2, elevation=1)),
        ("simplices4-in-3d", "expected 4", dict(kind="simplices in 4 dimensions", dims=3)),
        ("points-in-4d", "a points in 4 dimensions", dict(dims=4)),
        ("mesh-in-4d", "a tetrahedral mesh in 4 dimensions", dict(kind="tetrahedral mesh", dims=4)),
        ("points4-i32", "expected f64", dict(**POINTS4, grid=HALF)),
        ("cells4-tree", "no finalization tree", dict(**DIAGRAM4, tree=QUADTREE)),
        ("cells4-box", "no bounding box", dict(**DIAGRAM4, bounds=(0, 0, 0, 1, 1, 1))),
        ("simplices4-region", "no bounding box, tree or region", dict(**SIMPLICES4, region=(0, 0, 0, 0, 1, 1, 1, 1))),
        ("configurations-in-3d", "a configurations in 3", dict(kind="configurations", dims=3)),
        ("configurations-tree", "no finalization tree", dict(kind="configurations", tree=QUADTREE)),
        ("configurations-region", "region goes with a partial mesh", dict(kind="configurations", region=(0, 0, 1, 1))),
        ("configurations-chunked", "can be chunked", dict(kind="configurations", chunked=True)),
        ("cells4-chunked", "is not chunked", dict(**DIAGRAM4, chunked=True)),
    ]
    for name, words, fields in damage:
        raw = {field: value for field, value in fields.items() if isinstance(value, bytes)}
        arguments = {field: value for field, value in fields.items() if field not in raw}
        yield name, words, Vector(raw=raw, **arguments).end()


def failing_streams():
    """Name, words of the error, and vector of streams with a good header."""
    points = lambda **fields: Vector(grid=HALF, elevation=1, **fields)
    f64 = lambda **fields: Vector(**fields)
    mesh = lambda **fields: Vector("triangle mesh", grid=HALF, elevation=1, **fields)
    partial = lambda: Vector(**PARTIAL)
    first = lambda: mesh().patch(0, SQUARE[:3], (), [(0, 1, 2)], (0,))
    raw = lambda data, comment="payload": [(data, comment)]

    empty = points()
    empty.pieces = []
    yield "empty-input", "the input is empty", empty
    yield "cut-in-magic", "truncated", points().cut(len(points().bytes()) - 5)
    yield "cut-in-header", "truncated", points().cut(40)
    yield "no-blocks", "truncated", points()
    yield "no-end", "truncated", points().points((1, 1, 1))
    yield "cut-in-frame", "truncated", points().points((1, 1, 1)).end(1).cut(60)
    yield "cut-in-payload", "truncated", points().points((1, 1, 1)).end(1).cut(1)
    yield from failing_compressed(raw)
    yield "block-oversize", "the maximum is 1048576", points().block(b"PNTS", [], length=2**20 + 1)
    yield "block-checksum", "checksum does not match", points().points((1, 1, 1), checksum=0).end(1)
    yield ("sequence-gap", "sequence number 2, expected 1",
        points().points((1, 1, 1)).points((1, 1, 1), sequence=2).end(2))
    yield ("sequence-repeated", "sequence number 0, expected 1",
        points().points((1, 1, 1)).points((1, 1, 1), sequence=0).end(2))
    yield "tag-unknown", 'the stream needs block tag "XYZW"', points().block(b"XYZW", []).end()
    yield ("tag-unknown-after-skipped", 'the stream needs block tag "W 9 "',
        points().points((1, 1, 1)).skip().block(b"W 9 ", raw(b"\1")).end(1))
    yield ("tag-unknown-before-fault", 'the stream needs block tag "PNTX"',
        mesh().block(b"PNTX", raw(b"\1")).patch(1).end(3))
    yield "tag-unprintable", 'block tag "\\x00\\x1b[\\xff"', points().block(b"\0\x1b[\xff", []).end()
    yield "tag-unprintable-skipped", 'block tag "n\\x1b[2"', points().skip(b"n\x1b[2").end()
    yield "tag-digit-first", 'block tag "4PNT"', points().block(b"4PNT", []).end()
    yield "tag-space-first", 'block tag " END"', points().block(b" END", []).end()
    yield "tag-punctuation", 'block tag "no_e"', points().skip(b"no_e").end()
    yield "skipped-checksum", "checksum does not match", points().skip(payload=b"abc", checksum=0).end()
    yield "skipped-sequence", "sequence number 2, expected 1", points().points((1, 1, 1)).skip(sequence=2).end(1)
    yield "skipped-not-counted", "sequence number 0, expected 1", points().skip().end(sequence=0)
    yield "skipped-oversize", "the maximum is 1048576", points().skip(length=2**20 + 1)
    yield "skipped-cut", "truncated", points().skip(payload=b"abc").cut(1)
    yield "skipped-no-end", "truncated", points().points((1, 1, 1)).skip()
    yield "skipped-after-end", "goes on after END", points().end().skip()
    yield "skipped-amid-order", "may stand here", partial().residual((None, 0, 0, 0)).skip().patch().end(1, residual=1)
    yield "skipped-amid-chunk", "do not lie in one cell", points(tree=QUADTREE, chunked=True).points(
        (0, 0, 0)).skip().points((1, 0, 0)).cells(16).skip().cells(17).end(2, 2)
    yield "patch-in-points", "may stand here", points().patch().end()
    yield "cells-in-mesh", "may stand here", mesh(tree=QUADTREE).cells(1).end(cells=1)
    yield "residual-in-mesh", "may stand here", mesh().residual((None, 0, 0, 0)).end(1, residual=1)
    yield "patch-after-residual", "may stand here", partial().residual((None, 0, 0, 0)).patch().end(1, residual=1)
    yield "residual-after-walls", "may stand here", partial().residual((None, 0, 0, 0), (None, 1, 1, 0)).walls(
        (0, 1)).residual((None, 2, 2, 0)).end(3, residual=3, walls=1)
    yield "trailing-byte", "goes on after END", points().end().put(b"\0", "one byte too many")
    yield "two-streams", "goes on after END", points().end().put(points().end().bytes(), "another stream")

    yield "points-length", "whole number of records", points().block(b"PNTS", raw(bytes(13))).end(1)
    yield "point-nan", "not finite", f64().points(("nan", "0")).end(1)
    yield "point-infinite", "not finite", f64().points(("0", "inf")).end(1)
    yield "point-outside-box", "outside of the header's bounding box", points(bounds=(0, 0, 0, 3, 3, 0)).points(
        (3, 3, 0), (3, 4, 0)).end(2)
    yield "point-outside-tree", "outside of the finalization tree", points(tree=QUADTREE).points((4, 0, 0)).end(1)
    yield "point-outside-region", "outside of the region", partial().residual((None, 8, 0, 0)).end(1, residual=1)
    yield "cell-without-tree", "without a finalization tree", points().cells(1).end(cells=1)
    yield "cells-empty-without-tree", "without a finalization tree", points().block(b"CELL", []).end()
    yield "cell-zero", "location code 0", points(tree=QUADTREE).cells(0).end(cells=1)
    yield "cell-between-levels", "location code 9", points(tree=QUADTREE).cells(9).end(cells=1)
    yield "cell-too-deep", "location code 64", points(tree=QUADTREE).cells(64).end(cells=1)
    yield "cells-length", "whole number of records", points(tree=QUADTREE).block(b"CELL", raw(bytes(9))).end(cells=1)
    yield "cell-twice", "cell 16 is final already", points(tree=QUADTREE).cells(16, 17, 16).end(cells=3)
    yield "cell-after-ancestor", "cell 27 is final already", points(tree=QUADTREE).cells(6).cells(27).end(cells=2)
    yield ("cell-after-siblings", "cell 5 is final already",
        points(tree=QUADTREE).cells(20, 21, 22, 23, 5).end(cells=5))
    yield "point-in-final-cell", "in a cell that is final", points(tree=QUADTREE).points((0, 0, 0)).cells(16).points(
        (1, 1, 0)).points((0, 0, 1)).end(3, 1)
    yield ("point-in-final-ancestor", "in a cell that is final",
        points(tree=QUADTREE).cells(7).points((3, 2, 0)).end(1, 1))
    yield "point-on-lower-border", "in a cell that is final", f64(tree=QUADTREE).cells(7).points(
        ("1.9999999999999998", "2"), ("2", "2")).end(2, 1)
    yield "chunk-of-two-cells", "do not lie in one cell", points(tree=QUADTREE, chunked=True).points(
        (0, 0, 0), (1, 0, 0)).cells(16, 17).end(2, 2)
    yield "chunk-of-another-cell", "do not lie in one cell", points(tree=QUADTREE, chunked=True).points(
        (0, 0, 0)).cells(17).points((0, 0, 1)).cells(16).end(2, 2)
    yield "chunk-without-tag", "do not lie in one cell", points(tree=QUADTREE, chunked=True).cells(17).points(
        (0, 0, 0)).end(1, 1)
    yield "chunk-of-siblings", "do not lie in one cell", points(tree=QUADTREE, chunked=True).points(
        (0, 0, 0), (1, 0, 0)).cells(16, 17, 18, 19).end(2, 4)
    yield "chunk-over-empty-tags", "do not lie in one cell", points(tree=QUADTREE, chunked=True).points(
        (0, 0, 0)).cells().points((1, 0, 0)).cells(17, 16).end(2, 2)
    yield "chunk-after-last-tag", "do not lie in one cell", points(tree=QUADTREE, chunked=True).points(
        (0, 0, 0)).cells(16).points((3, 3, 0)).end(2, 1)
    yield "end-points", "END states", points().points((1, 1, 1)).end(2)
    yield "end-cells", "END states", points(tree=QUADTREE).cells(4).end()
    yield "end-merged-points", "END states", points().points((1, 1, 1)).end(1, merged=1)
    yield "end-header-points", "another number of points", points(points=2).points((1, 1, 1)).end(1)
    yield "end-length", "END of 48 bytes", points().block(b"END ", raw(bytes(48)))

    yield "patch-short", "expected at least 24", mesh().block(b"PTCH", raw(bytes(23))).end()
    yield "patch-empty", "expected at least 24", mesh().block(b"PTCH", []).end()
    yield "patch-counts", "do not add up", mesh().patch(0, SQUARE, counts=(5, 0, 0, 0)).end()
    yield "patch-counts-huge", "do not add up", mesh().patch(0, SQUARE, counts=(2**32 - 1,) * 4).end()
    yield "patch-first-id", "patch starts with vertex 1, expected 0", mesh().patch(1).end()
    yield ("import-not-increasing", "not increasing ids",
        first().patch(3, (), (2, 1), (), (0, 1)).end(3, vertices=3, simplices=1))
    yield "import-of-new-vertex", "not increasing ids", mesh().patch(0, SQUARE, (3,)).end(4, vertices=4)
    yield "import-unknown", "not increasing ids", first().patch(3, (), (1, 7)).end(3, vertices=3, simplices=1)
    yield "import-after-finalization", "vertex 0 referenced after finalization", first().patch(
        3, SQUARE[3:], (0, 1), [(0, 1, 2)], (0, 2)).end(4, vertices=4, simplices=2)
    yield "finalized-twice", "vertex 0 referenced after finalization", first().patch(3, (), (0, 1), (), (0, 1)).end(
        3, vertices=3, simplices=1)
    yield ("simplex-index", "simplex uses",
        mesh().patch(0, SQUARE[:3], (), [(0, 1, 3)], (0, 1, 2)).end(3, vertices=3, simplices=1))
    yield "simplex-repeats-vertex", "uses a vertex twice", mesh().patch(0, SQUARE[:3], (), [(0, 1, 0)], (0, 1, 2)).end(
        3, vertices=3, simplices=1)
    yield ("finalized-index", "not increasing indices",
        mesh().patch(0, SQUARE[:3], (), (), (0, 1, 3)).end(3, vertices=3))
    yield ("finalized-not-increasing", "not increasing indices",
        mesh().patch(0, SQUARE[:3], (), (), (0, 2, 1)).end(3, vertices=3))
    yield ("finalized-repeated", "not increasing indices",
        mesh().patch(0, SQUARE[:3], (), (), (0, 1, 1)).end(3, vertices=3))
    yield "vertex-not-finalized", "1 of 3 vertices were finalized", first().end(3, vertices=3, simplices=1)
    yield "end-vertices", "END states", mesh().patch(0, SQUARE[:1], (), (), (0,)).end(2, vertices=2)
    yield ("end-simplices", "END states",
        mesh().patch(0, SQUARE[:3], (), [(0, 1, 2)], (0, 1, 2)).end(3, vertices=3, simplices=2))
    yield "end-mesh-points", "END states", mesh().patch(0, SQUARE[:1], (), (), (0,)).end(3, vertices=1, merged=1)
    yield "end-beyond-counting", "END", mesh().patch(0, SQUARE[:1], (), (), (0,)).end(0, vertices=1, merged=2**64 - 1)

    yield "end-mesh-beyond-counting", "beyond counting", mesh().patch(0, SQUARE[:1], (), (), (0,)).end(
        2**64 - 1, vertices=1, merged=2**64 - 2)
    yield "end-points-beyond-counting", "beyond counting", points().end(2**64 - 1)

    yield "residual-length", "whole number of records", partial().block(b"RPNT", raw(bytes(19))).end(1, residual=1)
    yield "residual-unknown-id", "the id 3 of no vertex", partial().patch(0, SQUARE[:3], (), (), (0, 1, 2)).residual(
        (3, 0, 0, 0)).end(3, vertices=3, residual=1)
    yield "residual-finalized-id", "names vertex 0, which is not live", partial().patch(0, SQUARE[:2], (), (), (0,)).residual(
        (0, 0, 0, 0)).end(2, vertices=2, residual=1)
    yield "residual-id-twice", "names vertex 1, which is not live", partial().patch(0, SQUARE[:2]).residual(
        (1, 2, 0, 1), (1, 2, 0, 1)).end(2, vertices=2, residual=2)
    yield "residual-moved", "other coordinates than its vertex 1", partial().patch(0, SQUARE[:2]).residual(
        (0, 0, 0, 0), (1, 2, 0, 2)).end(2, vertices=2, residual=2)
    yield "residual-forgets-vertex", "1 of 2 vertices were finalized", partial().patch(0, SQUARE[:2]).residual(
        (1, 2, 0, 1)).end(2, vertices=2, residual=1)
    yield "end-partial-points", "END states", partial().residual((None, 0, 0, 0)).end(2, residual=1)
    yield ("wall-unknown-point", "wall 0 to 1 between no",
        partial().residual((None, 0, 0, 0)).walls((0, 1)).end(1, residual=1, walls=1))
    yield ("wall-to-itself", "wall 0 to 0 between no",
        partial().residual((None, 0, 0, 0)).walls((0, 0)).end(1, residual=1, walls=1))
    space = lambda: Vector(**PARTIAL_SPACE)
    three = [(None,) + corner for corner in CORNERS[:3]]
    yield ("partial-tetrahedra-outside-region", "outside of the region",
        space().residual((None, 0, 0, 7), (None, 0, 0, 8)).end(2, residual=2))
    yield ("partial-tetrahedra-vertex-outside-region", "outside of the region",
        space().patch(0, [(0, 0, 8)], (), (), (0,)).end(1, vertices=1))
    yield ("partial-tetrahedra-wall-length", "whole number of records",
        space().residual(*three).block(b"WALL", raw(bytes(8))).end(3, residual=3))
    yield ("partial-tetrahedra-wall-repeats-point", "wall 0 to 1 to 0 between no",
        space().residual(*three).walls((0, 1, 0)).end(3, residual=3, walls=1))
    yield ("partial-tetrahedra-wall-unknown-point", "wall 2 to 1 to 3 between no",
        space().residual(*three).walls((2, 1, 3)).end(3, residual=3, walls=1))
    yield ("partial-tetrahedra-end-walls", "END states", space().residual(*three).walls((0, 1, 2)).end(3, residual=3))
    yield ("partial-tetrahedra-forgets-vertex", "1 of 2 vertices were finalized",
        space().patch(0, CORNERS[:2]).residual((1, 4, 0, 0)).end(2, vertices=2, residual=1))
    yield ("partial-tetrahedra-moved", "other coordinates than its vertex 1",
        space().patch(0, CORNERS[:2]).residual((0, 0, 0, 0), (1, 4, 0, 1)).end(2, vertices=2, residual=2))
    yield ("labels-in-partial-tetrahedra", "may stand here",
        space().patch(0, CORNERS[:1], (), (), (0,)).labels(1).end(1, vertices=1))
    yield ("patch-after-walls", "may stand here",
        space().residual(*three).walls((0, 1, 2)).patch().end(3, residual=3, walls=1))
    cell = lambda **fields: Vector(**TETRAHEDRAL, **fields).patch(0, CORNERS[:4], (), [(0, 1, 2, 3)], (0,))
    four = lambda: Vector(**TETRAHEDRAL).patch(0, CORNERS[:4], (), [(0, 1, 2, 3)], (0, 1, 2, 3))
    tetrahedra = lambda new, simplices: Vector(**TETRAHEDRAL).patch(0, CORNERS[:new], (), simplices, range(new)).end(
        new, vertices=new, simplices=len(simplices))
    yield ("labels-too-many", "5 labels after 4 vertices", four().labels(1, 2, 3, 4, 5).end(4, vertices=4, simplices=1))
    yield ("labels-before-vertices", "2 labels after 0 vertices", Vector(**TETRAHEDRAL).labels(1, 2).patch(
        0, CORNERS[:2], (), (), (0, 1)).end(2, vertices=2))
    yield ("labels-ahead", "5 labels after 4 vertices", cell().labels(1, 2, 3).labels(4, 5).patch(
        4, CORNERS[4:], (1, 2, 3), [(0, 1, 3, 2)], (0, 1, 2, 3)).end(5, vertices=5, simplices=2))
    yield ("labels-too-few", "3 labels of 4 vertices", four().labels(1, 2, 3).end(4, vertices=4, simplices=1))
    yield ("labels-not-of-all", "4 labels of 5 vertices", cell().labels(1, 2, 3, 4).patch(
        4, CORNERS[4:], (1, 2, 3), [(0, 1, 3, 2)], (0, 1, 2, 3)).end(5, vertices=5, simplices=2))
    yield "labels-length", "whole number of records", four().block(b"LABL", raw(bytes(31))).end(
        4, vertices=4, simplices=1)
    yield "labels-in-points", "may stand here", Vector(grid=HALF, dims=3).points((0, 0, 0)).labels(1).end(1)
    yield ("labels-in-mesh", "may stand here",
        mesh().patch(0, SQUARE[:1], (), (), (0,)).labels(1).end(1, vertices=1))
    yield ("labels-in-partial", "may stand here",
        partial().patch(0, SQUARE[:1], (), (), (0,)).labels(1).end(1, vertices=1))
    yield "points-in-tetrahedra", "may stand here", Vector(**TETRAHEDRAL).points((0, 0, 0)).end(1)
    yield ("cells-in-tetrahedra", "may stand here",
        Vector(**TETRAHEDRAL, tree=(2, 0, 0, 0, 8)).cells(1).end(cells=1))
    yield "residual-in-tetrahedra", "may stand here", Vector(**TETRAHEDRAL).residual((None, 0, 0, 0)).end(1, residual=1)
    yield "walls-in-tetrahedra", "may stand here", Vector(**TETRAHEDRAL).walls((0, 1)).end(walls=1)
    yield "tetrahedron-repeats-vertex", "uses a vertex twice", tetrahedra(4, [(0, 1, 2, 0)])
    yield "tetrahedron-repeats-last", "uses a vertex twice", tetrahedra(5, [(0, 1, 2, 3), (4, 1, 3, 3)])
    yield "tetrahedron-index", "simplex uses", tetrahedra(4, [(0, 1, 2, 4)])
    yield "tetrahedron-of-three", "do not add up", tetrahedra(4, [(0, 1, 2)])
    yield "tetrahedra-counts", "do not add up", Vector(**TETRAHEDRAL).patch(0, CORNERS, counts=(5, 0, 2**30, 0)).end()
    yield "tetrahedra-import-finalized", "vertex 0 referenced after finalization", cell().patch(
        4, CORNERS[4:], (0, 1, 2, 3), [(0, 2, 4, 3)], (0, 2, 3, 4)).end(5, vertices=5, simplices=2)
    yield "tetrahedra-not-finalized", "1 of 4 vertices were finalized", cell().end(4, vertices=4, simplices=1)
    yield "tetrahedra-finalized-twice", "vertex 0 referenced after finalization", cell().patch(
        4, (), (0, 1, 2, 3), (), (0, 1, 2, 3)).end(4, vertices=4, simplices=1)
    yield "tetrahedra-outside-box", "outside of the header's bounding box", cell(bounds=(0, 0, 0, 4, 4, 3)).patch(
        4, (), (1, 2, 3), (), (0, 1, 2)).end(4, vertices=4, simplices=1)
    yield ("end-tetrahedra", "END states", Vector(**TETRAHEDRAL).patch(
        0, CORNERS[:4], (), [(0, 1, 2, 3)], (0, 1, 2, 3)).end(4, vertices=4, simplices=2))
    yield ("end-tetrahedra-points", "END states",
        four().labels(1, 2, 3, 4).end(5, vertices=4, simplices=1))
    yield "tetrahedra-no-end", "truncated", four().labels(1, 2, 3, 4)
    yield "end-walls", "END states", partial().residual((None, 0, 0, 0)).end(1, residual=1, walls=1)


    yield from failing_streams4(raw)
    yield from failing_configurations(raw)


def failing_streams4(raw):
    """Name, words of the error, and vector of streams of four dimensions; `raw` makes a payload of bytes."""
    words = lambda *numbers: raw(struct.pack("<%dI" % len(numbers), *numbers))
    points = lambda: Vector(**POINTS4)
    corners = lambda: Vector(**DIAGRAM4).points4(*CORNERS4)
    cells = lambda *cells: corners().cells4(*cells).end(5, vertices=5, simplices=len(cells))
    cell = lambda vertices, neighbours=(): cells((0, vertices, neighbours))
    simplices = lambda *all: Vector(**SIMPLICES4).points4(*CORNERS4).simplices4(*all).end(
        5, vertices=5, simplices=len(all))
    value = lambda bits: Vector(**POINTS4, elevation=1).block(
        b"PNT4", raw(bytes(32) + struct.pack("<Q", bits), "a point and its value")).end(1)

    yield "points4-length", "whole number of records of 32", points().block(b"PNT4", raw(bytes(40))).end(1)
    yield "points4-nan", "not finite", points().points4(("0", "0", "0", "nan")).end(1)
    yield "points4-infinite", "not finite", points().block(b"PNT4", raw(struct.pack("<4d", -INF, 0, 0, 0))).end(1)
    yield "points4-values-length", "whole number of records of 40", Vector(**POINTS4, elevation=1).block(
        b"PNT4", raw(bytes(32))).end(1)
    yield "points4-value-infinite", "neither finite nor", value(0x7FF0000000000000)
    yield "points4-value-other-nan", "neither finite nor", value(0xFFF8000000000000)
    yield "points4-value-payload", "neither finite nor", value(0x7FF8000000000001)
    yield "points4-nan-with-value", "not finite", Vector(**POINTS4, elevation=1).points4(
        ("0", "nan", "0", "0", "1")).end(1)
    yield "points-in-points4", "may stand here", points().block(b"PNTS", []).end()
    yield "points4-in-points", "may stand here", Vector().block(b"PNT4", []).end()
    yield "cells4-in-points4", "may stand here", points().block(b"CEL4", []).end()
    yield "simplices4-in-cells4", "may stand here", corners().block(b"SIM4", []).end(5, vertices=5)
    yield "cells4-in-simplices4", "may stand here", Vector(**SIMPLICES4).block(b"CEL4", []).end()
    yield "labels-in-cells4", "may stand here", corners().labels().end(5, vertices=5)
    yield "patch-in-cells4", "may stand here", Vector(**DIAGRAM4).block(b"PTCH", raw(bytes(24))).end()
    yield "points4-after-cells4", "may stand here", corners().cells4(CELLS4[0]).block(b"PNT4", []).end(
        5, vertices=5, simplices=1)
    yield "points4-after-simplices4", "may stand here", Vector(**SIMPLICES4).simplices4().points4(*CORNERS4).end(
        5, vertices=5)
    yield "points4-no-end", "truncated", points().points4(("0",) * 4)
    yield "end-points4", "END states", points().points4(("0",) * 4).end(2)
    yield "end-points4-vertices", "END states", points().points4(("0",) * 4).end(1, vertices=1)
    yield "end-points4-merged", "END states", points().points4(("0",) * 4).end(2, merged=1)
    yield "end-points4-header", "another number of points", Vector(**DIAGRAM4, points=5).points4(*CORNERS4).end(
        6, vertices=5, merged=1)

    yield "cells4-points-equal", "does not follow", Vector(**DIAGRAM4).points4(
        ("0", "0", "0", "0"), ("0", "-0.0", "0", "0")).end(2, vertices=2)
    yield "cells4-points-not-sorted", "does not follow", Vector(**DIAGRAM4).points4(CORNERS4[1]).points4(
        CORNERS4[0]).end(2, vertices=2)
    yield "cells4-points-not-sorted-last", "does not follow", Vector(**DIAGRAM4).points4(
        ("1", "2", "3", "4"), ("1", "2", "3", "3.5")).end(2, vertices=2)
    yield "cells4-length", "whole number of records of 4", corners().block(b"CEL4", raw(bytes(26))).end(
        5, vertices=5)
    yield "cell4-of-four", "a finite cell of 4 vertices", cell((0, 1, 2, 3))
    yield "cell4-infinite-of-three", "an infinite cell of 3 vertices", cells((1, (0, 1, 2), ()))
    yield "cell4-of-none", "a finite cell of 0 vertices", corners().block(b"CEL4", words(0, 0)).end(
        5, vertices=5, simplices=1)
    yield "cell4-vertex", "not increasing numbers of 5 points", cell((0, 1, 2, 3, 5))
    yield "cell4-vertex-without-points", "a finite cell of 5 vertices, but 0 points", Vector(**DIAGRAM4).cells4(
        CELLS4[0]).end(simplices=1)
    yield "cell4-vertices-not-sorted", "not increasing numbers", cell((0, 1, 3, 2, 4))
    yield "cell4-repeats-vertex", "not increasing numbers", cell((0, 1, 2, 2, 3))
    yield "cell4-neighbours-not-sorted", "neighbours of a cell are not increasing", cells(
        (0, range(5), (2, 1)), *CELLS4[1:])
    yield "cell4-neighbour-twice", "neighbours of a cell are not increasing", cells(
        (0, range(5), (1, 1)), *CELLS4[1:])
    yield "cell4-neighbour", "neighbour 6 of 6 cells", cells((0, range(5), (1, 6)), *CELLS4[1:])
    yield "cell4-huge", "vertices, but 5 points", corners().block(b"CEL4", words(2**31 - 1, 2)).end(5, vertices=5)
    yield "cell4-neighbours-huge", "5 facets at most", corners().block(b"CEL4", words(5, 2**32 - 1)).end(5, vertices=5)
    yield "cell4-announces-vertices", "a finite cell of 6 vertices, but 5 points", corners().block(
        b"CEL4", words(6)).end(5, vertices=5)
    yield "cell4-announces-infinite", "an infinite cell of 1073741824 vertices, but 5 points", corners().block(
        b"CEL4", words(2**31 + 2**30)).end(5, vertices=5)
    yield "cell4-announces-neighbours", "5 facets at most", corners().block(b"CEL4", words(5, 6)).end(5, vertices=5)
    yield "cell4-announces-infinite-neighbours", "5 facets at most", corners().block(
        b"CEL4", words(2**31 + 4, 6)).end(5, vertices=5)
    yield "cell4-cut", "the last cell is cut off after 6 words", corners().block(
        b"CEL4", words(5, 0, 0, 1, 2, 3)).end(5, vertices=5)
    yield "cell4-cut-in-counts", "the last cell is cut off after 1 words", corners().cells4(*CELLS4).block(
        b"CEL4", words(5)).end(5, vertices=5, simplices=6)
    yield "cell4-cut-promises", "the last cell is cut off after 2 words", corners().block(
        b"CEL4", words(5, 5)).end(5, vertices=5)
    yield "end-cells4", "END states", corners().cells4(*CELLS4).end(5, vertices=5, simplices=5)
    yield "end-cells4-tags", "END states", corners().cells4(*CELLS4).end(5, cells=6, vertices=5, simplices=6)
    yield "end-cells4-points", "END states", corners().cells4(*CELLS4).end(6, vertices=5, simplices=6)
    yield "end-cells4-vertices", "END states", corners().end(6, vertices=6)
    yield "cells4-no-end", "truncated", corners().cells4(*CELLS4)

    yield "simplices4-length", "whole number of records of 20", Vector(**SIMPLICES4).points4(*CORNERS4).block(
        b"SIM4", raw(bytes(24))).end(5, vertices=5)
    yield "simplex4-vertex", "simplex uses vertex 5 of 5", simplices((0, 1, 2, 3, 5))
    yield "simplex4-repeats-vertex", "uses a vertex twice", simplices((0, 1, 2, 3, 4), (4, 1, 2, 3, 4))
    yield "end-simplices4", "END states", Vector(**SIMPLICES4).points4(*CORNERS4).simplices4((4, 0, 1, 2, 3)).end(
        5, vertices=5, simplices=2)
    yield "simplices4-nan", "not finite", Vector(**SIMPLICES4).points4(("nan", "0", "0", "0")).end(1, vertices=1)


def failing_configurations(raw):
    """Name, words of the error, and vector of streams of configurations; `raw` makes a payload of bytes."""
    words = lambda *numbers: raw(struct.pack("<%dI" % len(numbers), *numbers))
    knots = lambda: Vector(**CONFIGURATIONS).points(*KNOTS)
    block = lambda *numbers: knots().block(b"CONF", words(*numbers)).end(4)
    both = lambda first, second: knots().configurations(*first).configurations(*second).end(4, simplices=2)
    degree = lambda k, *groups: knots().configurations(k, *groups).end(
        4, simplices=sum(len(boundaries) for _, boundaries in groups))
    boundary = lambda k, interior, *boundaries: degree(k, (interior, boundaries))

    yield "configurations-empty", "expected at least 12", block()
    yield "configurations-short", "expected at least 12", block(0, 0)
    yield "configurations-degree", "the maximum is 4096", block(4097, 0, 0)
    yield "configurations-standing", "standing 3", block(0, 3, 0)
    yield "configurations-groups-huge", "do not add up", block(4096, 0, 2**32 - 1)
    yield "configurations-counts-huge", "do not add up", block(0, 0, 1, 2**32 - 1, 0, 1, 3)
    yield "configurations-left-over", "do not add up", block(0, 0, 1, 1, 0, 1, 3, 0)
    yield "configurations-missing", "do not add up", block(0, 0, 1, 2, 0, 1, 3)
    yield "configurations-none", "has no configuration", block(1, 0, 1, 0, 0)
    yield "configurations-degree-lower", "of degree 0 after those of 1", both(
        (1, ((3,), [(0, 1, 2)])), (0, ((), [(0, 1, 3)])))
    yield "configurations-change-standing", "change their standing", knots().configurations(
        0, ((), [(0, 1, 3)])).configurations(0, ((), [(0, 1, 2)]), standing=1).end(4, simplices=2)
    yield "interior-unknown", "not of increasing numbers of 4 knots", boundary(1, (4,), (0, 1, 2))
    yield "interior-faraway", "not of increasing numbers of 4 knots", boundary(1, (2**32 - 1,), (0, 1, 2))
    yield "interior-not-increasing", "not of increasing numbers", boundary(2, (3, 2), (0, 1))
    yield "interior-repeats-knot", "not of increasing numbers", boundary(2, (2, 2), (0, 1))
    yield "interior-not-sorted", "does not follow", degree(1, ((3,), [(0, 1)]), ((2,), [(0, 1)]))
    yield "interior-twice", "does not follow", degree(1, ((3,), [(0, 1)]), ((3,), [(0, 2)]))
    yield "interior-again", "does not follow", both((1, ((3,), [(0, 1)])), (1, ((2,), [(0, 1)])))
    yield "boundary-unknown", "is not of numbers of 4 knots", boundary(0, (), (0, 1, 4))
    yield "boundary-infinite-unknown", "is not of numbers of 4 knots", boundary(0, (), (0, 4))
    yield "boundary-faraway-first", "is not of numbers of 4 knots", boundary(0, (), (0, 2**32 - 1, 1))
    yield "boundary-faraway-twice", "is not of numbers of 4 knots", boundary(0, (), (0, 2**32 - 1))
    yield "boundary-repeats-knot", "repeats a knot", boundary(0, (), (0, 1, 1))
    yield "boundary-infinite-repeats-knot", "repeats a knot", boundary(0, (), (1, 1))
    yield "boundary-not-least-first", "least knot first", boundary(0, (), (1, 3, 0))
    yield "boundary-in-interior", "which is in the interior set", boundary(1, (1,), (0, 1, 2))
    yield "boundary-not-sorted", "does not follow", boundary(1, (3,), (0, 2, 1), (0, 1, 2))
    yield "boundary-twice", "does not follow", boundary(1, (3,), (0, 1, 2), (0, 1, 2))
    yield "boundary-twice-again", "does not follow", both((1, ((3,), [(0, 1, 2)])), (1, ((3,), [(0, 1, 2)])))
    yield "boundary-infinite-not-sorted", "does not follow", boundary(1, (3,), (1, 2), (0, 1))
    yield "boundary-after-infinite", "does not follow", boundary(0, (), (0, 1), (0, 1, 3))
    yield "configurations-before-knots", "numbers of 0 knots", Vector(**CONFIGURATIONS).configurations(
        *(0, DEGREE0)).end(simplices=6)
    yield "knots-after-configurations", "may stand here", knots().configurations(0, DEGREE0).points((1, 1)).end(
        5, simplices=6)
    yield "configurations-in-points", "may stand here", Vector().block(b"CONF", words(0, 0, 0)).end()
    yield "configurations-in-mesh", "may stand here", Vector("triangle mesh").block(b"CONF", words(0, 0, 0)).end()
    yield "cells-in-configurations", "may stand here", knots().cells().end(4)
    yield "knot-outside-box", "outside of the header's bounding box", Vector(
        **CONFIGURATIONS, bounds=(0, 0, 0, 7, 8, 0)).points(*KNOTS).end(4)
    yield "end-configurations", "END states", knots().configurations(0, DEGREE0).end(4, simplices=3)
    yield "end-configurations-knots", "END states", knots().configurations(0, DEGREE0).end(5, simplices=6)
    yield "end-configurations-vertices", "END states", knots().end(4, vertices=4)
    yield "end-configurations-merged", "END states", knots().end(5, merged=1)
    yield "end-configurations-header", "another number of points", Vector(**CONFIGURATIONS, points=5).points(
        *KNOTS).end(4)
    yield "configurations-no-end", "truncated", knots().configurations(0, DEGREE0)

    functions = lambda *all: knots().configurations(1, *DEGREE1).functions(*all).end(4, vertices=len(all), simplices=7)
    one = lambda *terms: functions(("edge", (0, 1), list(terms)))
    cut = lambda data: knots().configurations(1, *DEGREE1).block(b"FUNC", raw(data)).end(4, vertices=1, simplices=7)
    yield "functions-short", "cut off at the end", cut(bytes(7))
    yield "functions-cut", "cut off at the end", cut(struct.pack("<5I", 0, 1, 0, 1, 0))
    yield "functions-terms-huge", "cut off at the end", cut(struct.pack("<4I", 0, 2**32 - 1, 0, 1))
    yield "functions-kind", "a function of kind 5", functions((5, (), [(0, 1, "1")]))
    yield "function-unknown", "is not of numbers of 4 knots", functions(("vertex", (4,), [(0, 1, "1")]))
    yield "function-repeats-knot", "repeats a knot", functions(("edge", (1, 1), [(0, 1, "1")]))
    yield "functions-not-sorted", "does not follow", functions(("edge", (0, 2), [(0, 1, "1")]), ("edge", (0, 1), [(0, 1, "1")]))
    yield "functions-kinds-not-sorted", "does not follow", functions(
        ("tent", (0, 2), [(0, 1, "1")]), ("edge", (0, 3), [(0, 1, "1")]))
    yield "function-twice", "does not follow", functions(*[("edge", (0, 2), [(0, 1, "1")])] * 2)
    yield "function-empty", "has no term", one()
    yield "term-unknown", "increasing numbers of 4 knots", one((0, 4, "1"))
    yield "term-not-increasing", "increasing numbers of 4 knots", one((1, 0, "1"))
    yield "term-repeats-knot", "increasing numbers of 4 knots", one((1, 1, "1"))
    yield "terms-not-sorted", "do not follow each other", one((0, 2, "1"), (0, 1, "1"))
    yield "terms-twice", "do not follow each other", one((0, 2, "1"), (0, 2, "1"))
    yield "factor-zero", "has the factor", one((0, 2, "0"))
    yield "factor-nan", "has the factor", one((0, 2, "nan"))
    yield "functions-before-configurations", "may stand here", knots().configurations(1, *DEGREE1[:1]).functions(
        PAIRS[0]).configurations(1, *DEGREE1[1:], goes_on=True).end(4, vertices=1, simplices=7)
    yield "functions-without-configurations", "without configurations of degree 1", knots().functions(PAIRS[0]).end(
        4, vertices=1)
    yield "functions-of-another-degree", "without configurations of degree 1", knots().configurations(
        2, ((1, 2), [(0, 3)])).functions(PAIRS[0]).end(4, vertices=1, simplices=1)
    yield "splines-functions-of-another-degree", "without configurations of degree 1", Vector(**SPLINES).points(
        *KNOTS).configurations(2, ((1, 2), [(0, 3)])).functions(PAIRS[0]).coefficients("1").end(
        4, vertices=1, simplices=1, residual=1)
    yield "splines-without-configurations", "without configurations", Vector(**SPLINES).points(*KNOTS).coefficients(
        "1").end(4, residual=1)
    yield "coefficients-in-configurations", "may stand here", knots().coefficients("1").end(4, residual=1)
    yield "end-functions", "END states", knots().configurations(1, *DEGREE1).functions(PAIRS[0]).end(4, simplices=7)
    spline = lambda *numbers: Vector(**SPLINES).points(*KNOTS).configurations(1, *DEGREE1).functions(
        *PAIRS).coefficients(*numbers).end(4, vertices=6, simplices=7, residual=len(numbers))
    yield "coefficients-few", "5 coefficients of 6 functions", spline(*["1"] * 5)
    yield "coefficients-many", "7 coefficients of 6 functions", spline(*["1"] * 7)
    yield "coefficients-none", "0 coefficients of 0 functions", Vector(**SPLINES).points(*KNOTS).end(4)
    yield "coefficients-infinite", "is not finite", spline(*["1"] * 5 + ["inf"])
    yield "coefficients-bytes", "no multiple of 8", Vector(**SPLINES).points(*KNOTS).block(
        b"COEF", raw(bytes(12))).end(4, residual=1)
    yield "coefficients-end", "END states", Vector(**SPLINES).points(*KNOTS).configurations(
        1, *DEGREE1).coefficients("1").end(4, simplices=7, residual=2)
    yield "splines-two-degrees", "splines have one degree", Vector(**SPLINES).points(*KNOTS).configurations(
        0, DEGREE0).configurations(1, *DEGREE1).coefficients("1").end(4, simplices=13, residual=1)
    yield "splines-tree", "no finalization tree", Vector(**SPLINES, tree=QUADTREE).end()


# Sections of the text about the parts of a stream.
SECTIONS = {b"PNTS": "4.2", b"CELL": "4.3", b"PTCH": "4.4", b"LABL": "4.5", b"RPNT": "4.6", b"WALL": "4.7",
            b"PNT4": "4.8", b"CEL4": "4.9", b"SIM4": "4.10", b"CONF": "4.11", b"FUNC": "4.12", b"COEF": "4.13",
            b"attp": "4.14", b"END ": "4.15", b"segm": "4.17", b"side": "4.17", b"open": "4.17",
            b"from": "4.18", b"kept": "4.18", b"REGN": "4.19"}


def place_of(name, data):
    """Where the Python reader refuses a vector, and the section about that part of the stream."""
    stream = spmesh_reader.Stream(io.BytesIO(data), spmesh_reader.Text(lambda line: None))
    try:
        stream.read()
    except spmesh_reader.REFUSED:
        pass
    words = stream.where.split()
    at = int(words[-1])
    if words[0] == "byte":
        return dict(block=None, byte=at, section="1")
    if words[0] == "header":
        return dict(block=None, byte=at, section="7" if name in TOO_NEW else "2")
    section = "7" if name in TOO_NEW else "6.1" if name in NEED_MEMORY else SECTIONS.get(data[at : at + 4], "4")
    return dict(block=int(words[1]), byte=at, section=section)


def files():
    """Path and content of every file."""
    manifest = []
    for name, title, vector in passing():
        yield "pass/%s.hex" % name, vector.hex(title)
        yield "pass/%s.txt" % name, vector.text()
        yield "pass/%s.spm" % name, vector.bytes()
        entry = dict(name=name, file="pass/%s.spm" % name, twin="pass/%s.txt" % name, what=title)
        manifest.append(dict(entry, **{"class": "well-formed", "exit_code": 0}))
    for source in (failing_headers(), failing_streams(), failing_attributes(), failing_constrained(), failing_weights(), failing_parts(), failing_regions()):
        for name, words, vector in source:
            who = " by a reader with memory of cells and vertices" if name in NEED_MEMORY else ""
            too_new = name in TOO_NEW
            title = "Must be refused%s%s: %s" % (who, " as too new" if too_new else "", words)
            yield "fail/%s.hex" % name, vector.hex(title)
            yield "fail/%s.err" % name, "%s\nexit code %d\n" % (words, 6 if too_new else 3)
            yield "fail/%s.spm" % name, vector.bytes()
            kind = {"class": "too new" if too_new else "malformed", "exit_code": 6 if too_new else 3}
            entry = dict(name=name, file="fail/%s.spm" % name, what=words, **kind)
            manifest.append(dict(entry, needs_memory=name in NEED_MEMORY, **place_of(name, vector.bytes())))
    for name, vector in two_parts().items():
        yield "joined/%s.spm" % name, vector.bytes()
    for name, found, expected, code in joined():
        head = json.dumps(dict(found, parts=[]), separators=(",", ":"))
        entries = ",\n".join(json.dumps(entry, separators=(",", ":")) for entry in found["parts"])
        yield "joined/%s.json" % name, head.replace('"parts":[]', '"parts":[\n%s\n]' % entries) + "\n"
        yield "joined/%s.%s" % (name, "err" if code else "txt"), "%s\nexit code %d\n" % (expected, code) if code else expected
    lines = ",\n".join("  " + json.dumps(entry, ensure_ascii=False) for entry in manifest)
    yield "manifest.json", '{"format": "spmesh", "version": 2, "vectors": [\n%s\n]}\n' % lines


def main(arguments):
    different = []
    for path, content in files():
        path = os.path.join(FOLDER, *path.split("/"))
        content = content.encode() if isinstance(content, str) else content
        if arguments == ["--check"]:
            with open(path, "rb") as file:
                if file.read() != content:
                    different.append(path)
        else:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "wb") as file:
                file.write(content)
    for path in different:
        print("make_vectors: %s differs" % path, file=sys.stderr)
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
