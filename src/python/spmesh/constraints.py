"""What constrains a triangle mesh: segments, sides on them, and open segments (format, section 4.17)."""

from __future__ import annotations

import numpy as np

from .blocks import OpenSegments, Patch, Segments
from .errors import require
from .header import Header

SEGMENTS_MAX = 2**32


def segment_dtype(header: Header) -> np.dtype:
    """The structured type of a segment in a stream."""
    return np.dtype([("line", "<u4"), ("ends", header.dtype, (2, 2))])


class Constraints:
    """Decodes the blocks, and checks the rules that span them."""

    def __init__(self, header: Header):
        self.header, self.segments, self.last_open = header, 0, -1

    def segment(self, payload: bytes) -> Segments:
        dtype = segment_dtype(self.header)
        require(len(payload) % dtype.itemsize == 0, "not a whole number of segments")
        records = np.frombuffer(payload, dtype)
        return self.check_segments(Segments(records["line"], records["ends"]))

    def check_segments(self, segments: Segments) -> Segments:
        require(np.isfinite(segments.ends).all(), "a coordinate of a segment is not finite")
        equal = (segments.ends[:, 0] == segments.ends[:, 1]).all(axis=1)
        require(not equal.any(), "a segment has equal ends")
        self.segments += len(segments.lines)
        require(self.segments <= SEGMENTS_MAX, f"more than {SEGMENTS_MAX} segments")
        return segments

    def check_sides(self, patch: Patch) -> None:
        if not len(patch.sides):
            return
        triangle, place, segment = patch.sides.astype(np.int64).T
        require(triangle.max() < len(patch.simplices), "a side of a triangle that its patch does not have")
        require(place.max() < 3, f"side {place.max()} of a triangle, expected 0, 1 or 2")
        require(segment.max() < self.segments, f"a side on segment {segment.max()} of {self.segments}")
        require((np.diff(3 * triangle + place) > 0).all(), "sides are not increasing by triangle and place")

    def open(self, payload: bytes) -> OpenSegments:
        require(len(payload) % 4 == 0, "not a whole number of open segments")
        return self.check_open(OpenSegments(np.frombuffer(payload, "<u4")))

    def check_open(self, segments: OpenSegments) -> OpenSegments:
        numbers = np.concatenate([[self.last_open], segments.numbers.astype(np.int64)])
        require(numbers.max() < self.segments or len(numbers) == 1, "an open segment that does not exist")
        require((np.diff(numbers) > 0).all(), "open segments are not increasing")
        self.last_open = int(numbers[-1])
        return segments


def sides_of(payload: bytes) -> np.ndarray:
    require(len(payload) % 12 == 0, "not a whole number of sides")
    return np.frombuffer(payload, "<u4").reshape(-1, 3)
