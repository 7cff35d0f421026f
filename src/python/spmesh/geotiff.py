"""Reads the GeoTIFF that the programs write: little-endian, classic or BigTIFF, one band in deflated tiles.

Other GeoTIFFs are for rasterio and GDAL. Source: TIFF 6.0, sections 2 and 14; Adobe Photoshop TIFF technical
note 3.
"""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import require
from .types import FilePath

WIDTH, HEIGHT, BITS, COMPRESSION, SAMPLES, PREDICTOR = 256, 257, 258, 259, 277, 317
TILE_WIDTH, TILE_HEIGHT, OFFSETS, LENGTHS, NO_DATA = 322, 323, 324, 325, 42113
PIXEL_SCALE, TIEPOINT = 33550, 33922
DEFLATE, HORIZONTAL, FLOATING_POINT = 8, 2, 3
TYPES = {2: "S1", 3: "<u2", 4: "<u4", 12: "<f8", 16: "<u8"}


def read(path: FilePath) -> tuple[npt.NDArray[np.float32], tuple[float, float, float, float, float, float]]:
    """The cells (rows, columns), NaN without data, and the affine transform in the order of rasterio.

    Raises MalformedError for files that the programs do not write, and OSError.
    """
    with open(path, "rb") as file:
        data = file.read()
    tags = _tags(data)
    needed = (WIDTH, HEIGHT, BITS, COMPRESSION, SAMPLES, PREDICTOR, TILE_WIDTH, TILE_HEIGHT)
    stated = [int(tags[tag][0]) if tag in tags else 0 for tag in needed]
    width, height, bits, compression, samples, predictor, *shape = stated
    known = compression == DEFLATE and samples == 1 and (bits, predictor) in ((32, FLOATING_POINT), (8, HORIZONTAL))
    require(known, f"{path}: the layout is not that of this project")
    across, down = -(-width // shape[0]), -(-height // shape[1])
    cells: npt.NDArray[np.float32] = np.full((down * shape[1], across * shape[0]), np.nan, np.float32)
    # With the default value, bytes of cells without data are 0.
    no_data = float(bytes(tags[NO_DATA].tobytes()).split(b"\0")[0])
    for number, (offset, length) in enumerate(zip(tags[OFFSETS].tolist(), tags[LENGTHS].tolist())):
        if length:
            tile = _tile(zlib.decompress(data[offset : offset + length]), shape[1], shape[0], bits)
            y, x = number // across * shape[1], number % across * shape[0]
            cells[y : y + shape[1], x : x + shape[0]] = np.where(tile == np.float32(no_data), np.float32(np.nan), tile)
    step, _, _ = tags[PIXEL_SCALE].tolist()
    left, top = tags[TIEPOINT].tolist()[3:5]
    return np.ascontiguousarray(cells[:height, :width]), (step, 0.0, left, 0.0, -step, top)


def _tags(data: bytes) -> dict[int, np.ndarray]:
    require(data[:4] in (b"II*\0", b"II+\0"), "no little-endian TIFF file")
    is_big = data[2] == 43
    head, entry, size = ("<Q", "<HHQ", 8) if is_big else ("<H", "<HHI", 4)
    (at,) = struct.unpack_from("<Q" if is_big else "<I", data, size)
    (count,) = struct.unpack_from(head, data, at)
    at += struct.calcsize(head)
    tags: dict[int, np.ndarray] = {}
    for _ in range(count):
        tag, kind, length = struct.unpack_from(entry, data, at)
        place = at + struct.calcsize(entry)
        at = place + size
        if kind in TYPES:
            dtype: np.dtype[Any] = np.dtype(TYPES[kind])
            if length * dtype.itemsize > size:
                (place,) = struct.unpack_from("<Q" if is_big else "<I", data, place)
            tags[tag] = np.frombuffer(data, dtype, length, place)
    return tags


def _tile(data: bytes, rows: int, columns: int, bits: int) -> npt.NDArray[np.float32]:
    differences = np.frombuffer(data, np.uint8).reshape(rows, columns * bits // 8)
    values = np.cumsum(differences, axis=1, dtype=np.uint8)
    if bits == 8:
        return values.astype(np.float32)
    # Bytes of equal significance stand together, the most significant first.
    parted = np.ascontiguousarray(values.reshape(rows, 4, columns).transpose(0, 2, 1))
    return parted.view(">f4").reshape(rows, columns).astype(np.float32)
