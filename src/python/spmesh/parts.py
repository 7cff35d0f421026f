"""Vertices that parts of a mesh share (format, sections 2.10 and 4.18)."""

from __future__ import annotations

from typing import Iterable, Sequence

import numpy as np

from .blocks import ORIGIN, Patch
from .errors import require
from .header import NUMBER_BITS, Header


def shared_of(tag: bytes, payload: bytes) -> np.ndarray:
    """The records of a block `from` or `kept`."""
    dtype = ORIGIN if tag == b"from" else np.dtype("<u4")
    require(len(payload) % dtype.itemsize == 0, f"{len(payload)} bytes are not a whole number of records")
    return np.frombuffer(payload, dtype)


def origins_of(origins: Iterable[Sequence[int]]) -> np.ndarray:
    """Pairs of local index and global id as an array."""
    return np.array([tuple(origin) for origin in origins], ORIGIN)


def check_shared(header: Header, patch: Patch) -> None:
    """Checks what a patch of a part says about vertices of other parts."""
    if len(patch.origins) and header.part is not None:
        local = patch.origins["local"].astype(np.int64)
        increasing = (np.diff(local) > 0).all() and local[-1] < len(patch.new)
        require(increasing, "vertices of other parts are not increasing numbers of new vertices")
        parts = patch.origins["id"] >> np.uint64(NUMBER_BITS)
        require(parts.max() < header.part[1], f"a vertex of part {parts.max()}, expected one before part {header.part[1]}")
    if len(patch.kept):
        final = (np.diff(patch.kept.astype(np.int64)) > 0).all() and np.isin(patch.kept, patch.finalized).all()
        require(final, "a vertex is kept for other parts, but not finalized here, or not in order")
