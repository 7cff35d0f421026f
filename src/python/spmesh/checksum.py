"""The checksum of blocks. Its package takes a tenth of a second to load, so that waits for the first
block.
"""

from __future__ import annotations

from typing import Callable

from .types import Buffer

_loaded: Callable[[Buffer, int], int] | None = None


def crc32c(data: Buffer, value: int = 0) -> int:
    """CRC-32C of bytes, continued from `value`."""
    global _loaded
    if _loaded is None:
        from crc32c import crc32c as loaded

        _loaded = loaded
    return _loaded(data, value)
