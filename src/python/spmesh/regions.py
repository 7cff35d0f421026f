"""The rules of points in regions (format, section 4.19)."""

from __future__ import annotations

import struct

from .blocks import Region
from .errors import require

LAYOUT = struct.Struct("<6d4Q")
POINTS_MAX = 2**64 - 2


def region_of(payload: bytes) -> Region:
    require(len(payload) == LAYOUT.size, f"region of {len(payload)} bytes, expected {LAYOUT.size}")
    *bounds, own, first, again, last = LAYOUT.unpack(payload)
    return Region(tuple(bounds), own, first, again, last)


def payload_of(region: Region) -> bytes:
    return LAYOUT.pack(*region.bounds, region.own, region.first, region.again, region.last)


class Regions:
    """Counts the points of regions. `total` counts each point once, `shared` those that a later region must have."""

    def __init__(self) -> None:
        self.number = self._stated = self._found = self.shared = self.total = 0

    def region(self, region: Region) -> None:
        self._check_complete()
        self.number += 1
        low, high = region.bounds[:3], region.bounds[3:]
        require(all(a < b for a, b in zip(low, high)), f"region {self.number}: the box is empty, or a side is NaN")
        self.total += region.own + region.first
        require(max(self.total, region.points) <= POINTS_MAX, f"region {self.number}: its points are beyond counting")
        before = region.again + region.last
        require(before <= self.shared, f"region {self.number} has {before} points of earlier regions, of {self.shared}")
        self.shared += region.first - region.last
        self._stated, self._found = region.points, 0

    def points(self, count: int) -> None:
        require(self.number > 0, "points before the first region")
        self._found += count
        require(self._found <= self._stated, f"region {self.number} states {self._stated} points, at least {self._found} follow")

    def end(self) -> None:
        self._check_complete()
        require(not self.shared, f"END: {self.shared} points that regions share are in no later one")

    def _check_complete(self) -> None:
        same = self._found == self._stated
        require(same, f"region {self.number} states {self._stated} points, {self._found} follow")
