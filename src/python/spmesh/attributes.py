"""What points carry beside their coordinates (format, section 2.8)."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import MalformedError, require
from .types import Masked

TYPES = ("u1", "i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f4", "<f8")


@dataclass
class Attribute:
    """What each point carries beside its coordinates.

    `dtype` is that of the stored numbers; `scale` is a pair (scale, offset): value = stored * scale + offset;
    `unknown` holds the bytes of the stored number that stands for an unknown value.
    """

    name: str
    dtype: np.dtype[Any]
    components: int = 1
    unit: str = ""
    las_name: str = ""
    scale: tuple[float, float] | None = None
    unknown: bytes | None = None

    def __post_init__(self) -> None:
        self.dtype = np.dtype(self.dtype).newbyteorder("<")

    @property
    def field(self) -> tuple[str, np.dtype[Any]] | tuple[str, np.dtype[Any], tuple[int]]:
        """Its field in the structured dtype of a row."""
        return (self.name, self.dtype) if self.components == 1 else (self.name, self.dtype, (self.components,))

    def check(self) -> None:
        require(1 <= len(self.name.encode()) <= 255, "an attribute without a name, or with one above 255 bytes")
        for text in (self.name, self.unit, self.las_name):
            plain = len(text.encode()) <= 255 and all(ord(c) >= 32 and not 127 <= ord(c) < 160 for c in text)
            require(plain, f"name, unit or LAS name of attribute {self.name!r} is too long or has control characters")
        require(1 <= self.components <= 255, f"attribute {self.name!r} has {self.components} components")
        if self.scale is not None:
            scale, offset = self.scale
            valid = math.isfinite(scale) and math.isfinite(offset) and scale != 0
            require(valid, f"attribute {self.name!r} has the scale {scale} and the offset {offset}")

    def is_weight(self) -> bool:
        """Whether it can hold the weights of points."""
        plain = self.components == 1 and self.scale is None and self.unknown is None
        return self.name == "weight" and self.dtype == np.dtype("<f8") and plain

    def encode(self) -> bytes:
        code = [np.dtype(t) for t in TYPES].index(self.dtype) + 1
        flags = (self.scale is not None) | (self.unknown is not None) << 1
        texts = [text.encode() for text in (self.name, self.unit, self.las_name)]
        data = bytes([code, self.components, flags]) + b"".join(bytes([len(t)]) + t for t in texts)
        return data + (struct.pack("<2d", *self.scale) if self.scale is not None else b"") + (self.unknown or b"")

    def values(self, stored: np.ndarray) -> Masked:
        """The values of stored numbers, as float64 if there is a scale; unknown ones are masked."""
        stored = np.asarray(stored)
        mask = np.zeros(stored.shape, bool)
        if self.unknown is not None:
            plain = np.ascontiguousarray(stored, self.dtype)
            raw = plain.view(f"V{self.dtype.itemsize}")
            mask = (raw == np.frombuffer(self.unknown, raw.dtype)[0]).reshape(stored.shape)
        if self.scale is not None:
            scale, offset = self.scale
            stored = stored.astype(float) * scale + offset
        return np.ma.MaskedArray(stored, mask)


def attributes_of(data: bytes) -> list[Attribute]:
    require(data, 'header record "attr": no attribute is listed')
    at, found = 0, []

    def take(size: int) -> bytes:
        nonlocal at
        require(at + size <= len(data), 'header record "attr": it ends within an attribute')
        at += size
        return data[at - size : at]

    while at < len(data):
        code, components, flags = take(3)
        require(1 <= code <= 10, f"type {code} of an attribute, expected 1 to 10")
        require(flags < 4, f"flags {flags} of an attribute, of which all bits but 0 and 1 must be 0")
        require(components, "an attribute without components")
        texts = [text_of(take(take(1)[0]), "a text") for _ in range(3)]
        scale = struct.unpack("<2d", take(16)) if flags & 1 else None
        dtype = np.dtype(TYPES[code - 1])
        unknown = take(dtype.itemsize) if flags & 2 else None
        found.append(Attribute(texts[0], dtype, components, texts[1], texts[2], scale, unknown))
    return found


def text_of(data: bytes, what: str) -> str:
    try:
        return data.decode()
    except UnicodeDecodeError:
        raise MalformedError(f"{what} is not UTF-8") from None
