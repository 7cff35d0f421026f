"""Decodes compressed payloads (format, section 4.16).

The compiled module does it, if it is there. Without it, records (method 3) and points are decoded with numpy; triangles
depend on each other one by one: expect about 1 MB/s of plain stream. `spconvert` expands whole files faster.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

import numpy as np

from .errors import MalformedError, require

PAYLOAD_MAX = 2**20
Triangle = tuple[int, int, int]


def decompressor() -> Callable[[bytes], bytes]:
    """What decompresses payloads, with buffers of its own."""
    try:
        from ._native import Payloads
    except ImportError:
        return decompress
    payloads = Payloads()

    def compiled(data: bytes) -> bytes:
        try:
            return payloads.decompress(data)
        except ValueError as error:
            raise MalformedError(str(error)) from None

    return compiled


def decompress(data: bytes) -> bytes:
    """The payload that a compressed payload stands for, without the compiled module."""
    require(data, "a compressed payload without a method")
    require(1 <= data[0] <= 3, f"compressed payload of method {data[0]}, expected 1, 2 or 3")
    try:
        return (_points, _triangles, _records)[data[0] - 1](data)
    except struct.error:
        raise MalformedError("a compressed payload is cut off") from None


# --- Frames


def _frame_length(data: bytes) -> int:
    """Bytes of the zstd frame at the start, by the lengths of its blocks (RFC 8878)."""
    require(data[:4] == b"\x28\xb5\x2f\xfd" and len(data) > 5, "no zstd frame")
    descriptor = data[4]
    single = descriptor >> 5 & 1
    dictionary = (0, 1, 2, 4)[descriptor & 3]
    at = 5 + (1 - single)
    require(not any(data[at : at + dictionary]), "a zstd frame with a dictionary")
    at += dictionary + (single, 2, 4, 8)[descriptor >> 6]
    last = 0
    while not last:
        require(at + 3 <= len(data), "a zstd frame is cut off")
        head = int.from_bytes(data[at : at + 3], "little")
        last, kind, size = head & 1, head >> 1 & 3, head >> 3
        require(kind < 3, "a zstd block of a reserved type")
        at += 3 + (1 if kind == 1 else size)
    return at + (descriptor & 4)


def _content(frame: bytes, limit: int) -> bytes:
    """The content of one frame that fills its place, of at most `limit` bytes."""
    require(_frame_length(frame) == len(frame), "not one zstd frame")
    try:
        import zstandard
    except ImportError:
        raise ImportError("the stream is compressed: install zstandard (pip install 'spmesh[zstd]')") from None
    try:
        reader = zstandard.ZstdDecompressor(max_window_size=2**23).stream_reader(frame)
        content = reader.read(limit + 1)
        while len(content) <= limit and (more := reader.read(limit + 1 - len(content))):
            content += more
        stated = zstandard.get_frame_parameters(frame).content_size
    except zstandard.ZstdError:
        raise MalformedError("a damaged zstd frame") from None
    require(len(content) <= limit, "a zstd frame of too many bytes")
    require(stated in (zstandard.CONTENTSIZE_UNKNOWN, len(content)), "a zstd frame of another length than it states")
    return content


# --- Columns


def _zigzag(u: np.ndarray) -> np.ndarray:
    u = u.astype(np.int64)
    return u >> 1 ^ -(u & 1)


class _Columns:
    """Columns of numbers of 32 bits, from the tokens of a frame and the bits behind it."""

    def __init__(self, data: bytes, at: int, tokens_max: int):
        (size,) = struct.unpack_from("<I", data, at)
        require(at + 4 + size <= len(data), "a compressed payload is cut off")
        self.tokens = np.frombuffer(_content(data[at + 4 : at + 4 + size], tokens_max), np.uint8)
        packed = np.frombuffer(data, np.uint8, offset=at + 4 + size) if at + 4 + size < len(data) else self.tokens[:0]
        # Eight bytes more, so that a window of 64 bits can start at any byte.
        self.bytes = np.concatenate([packed, np.zeros(8, np.uint8)])
        self.bits, self.next = 8 * len(packed), 0

    def raw(self, count: int) -> np.ndarray:
        require(count <= len(self.tokens), "too few tokens")
        taken, self.tokens = self.tokens[:count], self.tokens[count:]
        return taken

    def column(self, count: int, k: int) -> np.ndarray:
        require(k <= 7, "a parameter above 7")
        tokens = self.raw(count).astype(np.int64)
        lengths = np.where(tokens < 2 << k, 0, (tokens >> k) - 1)
        require((lengths + k <= 31).all(), "a token stands for no number of 32 bits")
        ends = self.next + np.cumsum(lengths)
        starts = ends - lengths
        if count:
            self.next = int(ends[-1])
        require(self.next <= self.bits, "too few bits")
        numbers = (tokens - (lengths << k)) << lengths
        some = np.flatnonzero(lengths)
        first = starts[some] >> 3
        window = np.zeros(len(some), np.uint64)
        for byte in range(5):
            window |= self.bytes[first + byte].astype(np.uint64) << np.uint64(8 * byte)
        window >>= (starts[some] & 7).astype(np.uint64)
        numbers[some] += (window & ((np.uint64(1) << lengths[some].astype(np.uint64)) - np.uint64(1))).astype(np.int64)
        return numbers

    def end(self) -> None:
        require(not len(self.tokens), "tokens are left")
        require(self.bits - self.next < 8, "bits are left")


def _bit_lengths(u: np.ndarray) -> np.ndarray:
    exponents: np.ndarray = np.frexp(u.astype(float))[1]
    return exponents


# --- Methods


def _points(data: bytes) -> bytes:
    (count,) = struct.unpack_from("<I", data, 1)
    require(1 <= count <= PAYLOAD_MAX // 12, "no points, or more than fit a block")
    axes = [struct.unpack_from("<BBi", data, 5 + 6 * axis) for axis in range(3)]
    require(all(predictor < 2 for predictor, _, _ in axes), "a predictor above 1")
    columns = _Columns(data, 23, 3 * count)
    keys, points = np.zeros(count, np.int64), np.empty((count, 3), np.int64)
    for axis, (predictor, k, first) in enumerate(axes):
        column = columns.column(count, k)
        if axis:
            order = np.argsort(keys, kind="stable")
            sorted_column, column = column, np.empty(count, np.int64)
            column[order] = sorted_column
        keys += _bit_lengths(column)
        differences = _zigzag(column)
        if predictor:
            differences = np.array(_with_medians(differences.tolist()), np.int64)
        points[:, axis] = first + np.cumsum(differences)
    columns.end()
    return points.astype("<u4").tobytes()


def _with_medians(residuals: list[int]) -> list[int]:
    """Adds to each the median of the five before it, modulo 2^32."""
    a = b = c = d = e = 0
    result = []
    for residual in residuals:
        difference = (residual + sorted((a, b, c, d, e))[2] + 2**31) % 2**32 - 2**31
        a, b, c, d, e = b, c, d, e, difference
        result.append(difference)
    return result


def _records(data: bytes) -> bytes:
    record, width, length = struct.unpack_from("<HBI", data, 1)
    require(width in (0, 4, 8), "words of another width than 0, 4 or 8")
    require(record and not (width and record % width), "records of no whole number of words")
    require(length <= PAYLOAD_MAX, "more bytes than fit a block")
    content = _content(data[8:], length)
    require(len(content) == length, "the zstd frame has fewer bytes than the payload")
    count = length // record
    planes = np.frombuffer(content, np.uint8, count * record).reshape(record, count)
    records = np.ascontiguousarray(planes.T)
    if width and count:
        words = records.view(f"<u{width}").reshape(count, record // width)
        one = words.dtype.type(1)
        signed = words >> one ^ (~(words & one) + one)
        records = np.cumsum(signed, axis=0, dtype=words.dtype)
    return records.tobytes() + content[count * record :]


def _triangles(data: bytes) -> bytes:
    _, new, imported, count, finalized = struct.unpack_from("<Q4I", data, 1)
    vertices = new + imported
    marks_size = (vertices + 7) // 8
    require(24 + 12 * new + 8 * imported + 12 * count + 4 * finalized <= PAYLOAD_MAX, "counts of more than fits a block")
    require(len(data) >= 33, "a compressed payload is cut off")
    ks = data[25:33]
    columns = _Columns(data, 33, 4 * count + 3 * new + 2 * imported + marks_size)
    operations = columns.raw(count)
    require(not count or operations.max() <= 152, "an operation above 152")
    counts = _taken(operations)
    given = [columns.column(size, k).tolist() for size, k in zip(counts, ks)]
    triangles, parents = _walk(operations.tolist(), new, vertices, given)
    axes = [_zigzag(columns.column(new, k)) for k in ks[3:6]]
    points = _from_parents(parents, np.stack(axes, axis=1).tolist())
    low, high = columns.column(imported, ks[6]), columns.column(imported, ks[7])
    ids = np.cumsum(low.astype(np.uint64) + (high.astype(np.uint64) << np.uint64(32)), dtype=np.uint64)
    marks = np.flatnonzero(np.unpackbits(columns.raw(marks_size), bitorder="little"))
    require(len(marks) == finalized, "another number of finalized vertices than the count")
    require(not len(marks) or marks[-1] < vertices, "a finalized vertex that does not exist")
    columns.end()
    parts = [points.astype("<u4"), ids.astype("<u8"), np.array(triangles, "<u4"), marks.astype("<u4")]
    return data[1:25] + b"".join(part.tobytes() for part in parts)


def _taken(operations: np.ndarray) -> list[int]:
    """How many distances, references and imports the operations take."""
    loose = operations[operations < 27].astype(int)
    attached = operations[operations >= 27].astype(int) - 27
    ways = np.concatenate([loose // 9, loose // 3 % 3, loose % 3, attached // 9 % 7])
    return [int((attached < 63).sum()), int((ways == 1).sum()), int((ways == 2).sum())]


def _walk(
    operations: list[int], new: int, vertices: int, given: list[list[int]]
) -> tuple[list[Triangle], list[int]]:
    """The triangles of all operations, and the parents of new vertices."""
    distances, references, imports = (iter(column) for column in given)
    leave: list[tuple[int, ...]] = [()] * vertices
    reach: list[tuple[int, ...]] = [()] * vertices
    parents = [max(vertex - 1, 0) for vertex in range(new)]
    triangles: list[Triangle] = []
    following, last = 0, new

    def give(way: int) -> int:
        nonlocal following, last
        if way == 2:
            number = next(imports)
            last = (last + (number >> 1 ^ -(number & 1))) % 2**32
            require(new <= last < vertices, "an imported vertex that does not exist")
            return last
        if way == 0:
            vertex, following = following, following + 1
        else:
            number = next(references)
            vertex = following - 1 - number if number < following else number
        require(vertex < new, "a new vertex that does not exist")
        return vertex

    for operation in operations:
        first = following
        if operation < 27:
            entered = triangle = (give(operation // 9), give(operation // 3 % 3), give(operation % 3))
        else:
            near, way = (operation - 27) // 63, (operation - 27) // 9 % 7
            edge, turn = operation // 3 % 3, operation % 3
            distance = 1 if near else next(distances) + 2
            require(distance <= len(triangles), "a distance to before the first triangle")
            base = triangles[-distance]
            q, p = base[edge], base[(edge + 1) % 3]
            if way < 3:
                x = give(way)
            else:
                edges, age = (leave[p], reach[q])[(way - 3) % 2], (way - 3) // 2
                require(age < len(edges), "an open edge that does not exist")
                x = edges[age]
            entered = (p, q, x)
            triangle = (entered, (x, p, q), (q, x, p))[turn]
        a, b, c = entered
        require(a != b and b != c and c != a, "a triangle that uses a vertex twice")
        for a, b in ((a, b), (b, c), (c, a)):
            if b in reach[a] or a in leave[b]:
                reach[a], leave[b] = _without(reach[a], b), _without(leave[b], a)
            else:
                leave[a], reach[b] = (b, *leave[a][:1]), (a, *reach[b][:1])
        for vertex in range(first, following):
            parents[vertex] = max((v for v in triangle if v < vertex), default=parents[vertex])
        triangles.append(triangle)
    return triangles, parents


def _without(edges: tuple[int, ...], vertex: int) -> tuple[int, ...]:
    if not edges or edges[0] == vertex:
        return edges[1:]
    return edges[:1] if edges[1:] == (vertex,) else edges


def _from_parents(parents: list[int], differences: list[list[int]]) -> np.ndarray:
    points: list[tuple[int, int, int]] = []
    for vertex, (parent, (x, y, z)) in enumerate(zip(parents, differences)):
        px, py, pz = points[parent] if vertex else (0, 0, 0)
        points.append((px + x, py + y, pz + z))
    return np.array(points, np.int64).reshape(-1, 3)
