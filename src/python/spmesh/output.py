"""Files that get their names when they are complete."""

from __future__ import annotations

import os
import stat
import tempfile
import weakref
from typing import BinaryIO

from .types import Buffer, FilePath


def _discard(file: BinaryIO, name: str) -> None:
    file.close()
    if os.path.exists(name):
        os.unlink(name)


class OutputFile:
    """A file that appears at `path`, or replaces the one there, by `commit`; without it, nothing changes.

    A symbolic link stays: its target is replaced. What is no regular file, such as a pipe, is written in place.
    """

    def __init__(self, path: FilePath):
        self._path = os.path.realpath(path)
        self._permissions = _permissions_at(self._path)
        self._file: BinaryIO
        self._name: str | None = None
        if self._permissions is None:
            self._file = open(self._path, "wb")
            return
        number, self._name = tempfile.mkstemp(prefix=".spmesh-", dir=os.path.dirname(self._path))
        self._file = os.fdopen(number, "wb")
        self._finalizer = weakref.finalize(self, _discard, self._file, self._name)

    def write(self, data: Buffer) -> int:
        return self._file.write(data)

    def fileno(self) -> int:
        return self._file.fileno()

    def flush(self) -> None:
        self._file.flush()

    def commit(self) -> None:
        """Gives the file its name, once its data are on the disk."""
        if self._file.closed:
            return
        self._file.flush()
        if self._name is not None and self._permissions is not None:
            os.fchmod(self._file.fileno(), self._permissions)
            os.fsync(self._file.fileno())
            os.replace(self._name, self._path)
        self._file.close()

    def close(self) -> None:
        """Removes the file, unless it has its name."""
        if self._name is None:
            self._file.close()
        else:
            self._finalizer()


def _permissions_at(path: str) -> int | None:
    """Those of the file at `path`, or of a new one; None if it is no regular file."""
    if os.path.lexists(path):
        mode = os.stat(path).st_mode
        return stat.S_IMODE(mode) & 0o777 if stat.S_ISREG(mode) else None
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
