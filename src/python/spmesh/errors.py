"""What a reader refuses."""

from __future__ import annotations

import re
from typing import NoReturn


class SpmeshError(ValueError):
    """A stream that is refused. `place` says where: the header, or the block and its first byte."""

    def __init__(self, message: str, place: str = ""):
        super().__init__(f"{place}: {message}" if place else message)
        self.message, self.place = message, place


class MalformedError(SpmeshError):
    """The stream breaks a rule of the format, or is cut off (exit code 3 of the programs)."""


class TooNewError(SpmeshError):
    """The stream needs what this version does not know (exit code 6 of the programs)."""


class UpstreamError(SpmeshError):
    """The program that wrote the stream failed, and said so at its end; `exit_code` is that of the program."""

    exit_code = 1


def upstream_error(tail: bytes) -> UpstreamError | None:
    """The failure that the last bytes of a stream tell, if they do."""
    mark = re.search(rb"\nspmesh: failed (\d{3})\n\Z", tail)
    if mark is None:
        return None
    error = UpstreamError(f"the program that wrote the stream failed with exit code {int(mark[1])}; stderr says why")
    error.exit_code = int(mark[1])
    return error


def require(holds: object, message: str) -> None:
    if not holds:
        raise MalformedError(message)


def needs(part: str) -> NoReturn:
    raise TooNewError(f"the stream needs {part}, which this package does not know: a newer spmesh made it")
