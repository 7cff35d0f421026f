"""Types of arguments and results."""

from __future__ import annotations

import os
from typing import Any, BinaryIO, Callable, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

FilePath = Union[str, "os.PathLike[str]"]
# A path, or an open binary file.
File = Union[FilePath, BinaryIO]
Buffer = Union[bytes, bytearray, memoryview]
# Gives the next n bytes of an input, fewer at its end.
Take = Callable[[int], bytes]
Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.signedinteger[Any]]
Masked = np.ma.MaskedArray[Any, Any]
# Numbers that are taken as an array: lists of lists, or arrays.
ArrayLike = npt.ArrayLike
Box = Sequence[float]
# Attributes of points: columns (n,) or (n, components) by name, or one structured array (n,).
Columns = Union[Mapping[str, Any], npt.NDArray[np.void]]
# Paths of files, or an array.
Files = Union[FilePath, Sequence[FilePath], ArrayLike]
