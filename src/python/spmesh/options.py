"""Flags of programs from keyword arguments."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from pathlib import Path
from typing import Any, Callable, Mapping, TypeVar

import numpy as np

from .types import FilePath


def flags_of(options: Mapping[str, Any]) -> list[str]:
    """Flags for options: `min_area=2` is `--min-area=2`, True a flag without value, a sequence its items with
    commas between them; None and False leave the flag out. Values stand behind "=", so that negative numbers
    are no flags."""
    flags = []
    for name, value in options.items():
        flag = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False:
            continue
        flags.append(flag if value is True else f"{flag}={text_of(value)}")
    return flags


def text_of(value: Any) -> str:
    """A value as the programs read it; numbers in full."""
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    if isinstance(value, (list, tuple, np.ndarray)):
        return ",".join(text_of(item) for item in value)
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return str(value)


def paths_of(source: object) -> list[str] | None:
    """The names of files, if `source` is a path or a sequence of paths."""
    several = source if isinstance(source, (list, tuple)) else [source]
    paths = [str(os.fspath(path)) for path in several if isinstance(path, (str, os.PathLike))]
    return paths if len(paths) == len(several) > 0 else None


class Place:
    """A file for results: at `output`, or in a temporary folder that is removed with the object that owns
    it.
    """

    def __init__(self, output: FilePath | None, name: str):
        self._remove: Callable[[], object] | None = None
        if output is not None:
            self.path = Path(output)
            return
        folder = tempfile.mkdtemp(prefix="spmesh-")
        self._remove = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self.path = Path(folder, name)

    def remove(self) -> None:
        """Removes the file if it is a temporary one."""
        if self._remove is not None:
            self._remove()


OwnerT = TypeVar("OwnerT", bound="Owner")


class Owner:
    """What reads a result in a file: a context manager that removes the file, if it is a temporary one.

    So does the end of the object, or of Python.
    """

    def __init__(self, path: FilePath | Place):
        self._place = path if isinstance(path, Place) else Place(path, "")

    @property
    def path(self) -> Path:
        """The file."""
        return self._place.path

    def close(self) -> None:
        """Removes the file if it is a temporary one."""
        self._place.remove()

    def __enter__(self: OwnerT) -> OwnerT:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({str(self.path)!r})"
