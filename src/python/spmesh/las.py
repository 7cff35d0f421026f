"""The little of LAS 1.2 that points need on their way through `spheight`."""

from __future__ import annotations

import struct
from typing import Sequence

import numpy as np

from .errors import require
from .types import FilePath, Floats

HEAD, RECORD, EXTRA = 227, 20, 192


def write(path: FilePath, points: np.ndarray, scale: Sequence[float], offset: Sequence[float]) -> None:
    """Writes points (n, 3) int32 of a grid, as point format 0."""
    rows = np.zeros(len(points), np.dtype([("xyz", "<i4", 3), ("rest", "V8")]))
    rows["xyz"] = points
    box = [float(x) for side in (points.max(axis=0), points.min(axis=0)) for x in np.asarray(side) * scale + offset]
    high, low = box[:3], box[3:]
    head = b"LASF" + bytes(20) + bytes([1, 2]) + bytes(64) + struct.pack("<HHHII", 1, 2000, HEAD, HEAD, 0)
    head += struct.pack("<BHI5I", 0, RECORD, len(points), len(points), 0, 0, 0, 0)
    head += struct.pack("<12d", *scale, *offset, *(x for pair in zip(high, low) for x in pair))
    with open(path, "wb") as file:
        file.write(head + rows.tobytes())


def heights(path: FilePath) -> Floats:
    """The heights (n,) in the last four bytes of each record, as `spheight` adds them; NaN for none."""
    with open(path, "rb") as file:
        data = file.read()
    start, records = struct.unpack_from("<II", data, 96)
    size, count = struct.unpack_from("<HI", data, 105)
    (scale,) = struct.unpack_from("<d", data, 147)
    require(data[:4] == b"LASF" and size == RECORD + 4, f"{path}: no points of format 0 with heights")
    rows = np.frombuffer(data, np.dtype([("point", "V20"), ("height", "<i4")]), count, start)["height"]
    return np.where(rows == -(2**31), np.nan, rows * scale)
