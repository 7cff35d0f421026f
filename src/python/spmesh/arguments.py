"""Arrays that callers pass: what does not fit is refused by the name of the argument."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from .attributes import TYPES, Attribute
from .types import ArrayLike, Columns, Floats, Integers

# Integers up to here are exact as float64.
EXACT = 2**53


def numbers_of(value: object, name: str, kinds: str = "iuf") -> npt.NDArray[Any]:
    """Numbers as float64, or as complex128 if they are complex.

    `kinds` are those of dtypes that are taken: "O" for objects that are such numbers. Raises ValueError for others,
    for masked arrays, which have no place for what is masked, and for integers that float64 rounds.
    """
    if isinstance(value, np.ma.MaskedArray):
        raise ValueError(f"{name} is a masked array, which has no numbers where it is masked: use .compressed()")
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O" and "O" in kinds:
            array = np.asarray(array, np.complex128 if "c" in kinds else np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name}: {error}") from None
    if array.dtype.kind not in kinds:
        raise ValueError(f"{name} has the type {array.dtype}, expected numbers")
    if array.dtype.kind in "iu" and array.size and not -EXACT <= int(array.min()) <= int(array.max()) <= EXACT:
        raise ValueError(f"{name} has integers beyond 2^53, which float64 cannot hold")
    return array.astype(np.complex128 if array.dtype.kind == "c" else np.float64, copy=False)


def points_of(points: ArrayLike, name: str = "xyz", axes: tuple[int, ...] = (2, 3)) -> Floats:
    """Points as float64 (n, axes). Raises ValueError for other shapes, and as `numbers_of`."""
    array = numbers_of(points, name)
    if array.ndim != 2 or array.shape[1] not in axes:
        expected = " or ".join(f"(n, {count})" for count in axes)
        raise ValueError(f"{name} has the shape {array.shape}, expected {expected}")
    return array


def check_finite(points: Floats, name: str) -> None:
    """Raises ValueError, with the row, if a coordinate of points (n, axes) is not finite."""
    is_finite = np.isfinite(points).all(axis=1)
    if not is_finite.all():
        raise ValueError(f"{name} has a coordinate that is not finite, in row {int(is_finite.argmin())}")


def indices_of(indices: ArrayLike, count: int, name: str, corners: tuple[int, ...]) -> Integers:
    """Simplices (m, corners) as indices below `count`; `corners` lists the allowed numbers of columns."""
    array = np.asarray(indices)
    if array.size == 0:
        return np.empty((0, array.shape[1] if array.ndim == 2 and array.shape[1] in corners else corners[0]), np.int32)
    if array.ndim != 2 or array.shape[1] not in corners:
        expected = " or ".join(f"(m, {columns})" for columns in corners)
        raise ValueError(f"{name} has the shape {array.shape}, expected {expected}")
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name} has the type {array.dtype}, expected integers")
    if array.dtype.kind == "f" and not np.array_equal(array, np.rint(array)):
        raise ValueError(f"{name} has an index that is no whole number")
    if not (0 <= array.min() and array.max() < count):
        raise ValueError(f"{name} uses a vertex beyond the {count} given")
    small = max(count, array.size) < 2**31
    return np.ascontiguousarray(array, np.int32 if small else np.int64)


def triple(numbers: float | ArrayLike, name: str) -> tuple[float, float, float]:
    """One number for all axes, or one for each of two or three."""
    try:
        array = np.asarray(numbers, np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {numbers!r}, expected one to three numbers") from None
    values = array.ravel().tolist()
    if array.ndim > 1 or not 1 <= len(values) <= 3:
        raise ValueError(f"{name} has the shape {array.shape}, expected one to three numbers")
    x, y, z = values * 3 if len(values) == 1 else (*values, values[0])[:3]
    return x, y, z


def columns_of(attributes: Columns | None) -> dict[str, Any]:
    """Columns by name: of a dictionary, a structured array such as `Stream.rows`, or a DataFrame."""
    if attributes is None:
        return {}
    if isinstance(attributes, Mapping):
        return dict(attributes)
    if hasattr(attributes, "columns"):
        return {str(name): attributes[name].to_numpy() for name in attributes.columns}
    names = getattr(getattr(attributes, "dtype", None), "names", None)
    if names is None:
        found = type(attributes).__name__
        raise ValueError(f"attributes is a {found}, expected a dictionary of arrays or a structured array")
    return {name: attributes[name] for name in names}


def attributes_of(columns: Columns) -> list[Attribute]:
    """A list of attributes for columns: arrays (n,) or (n, components) by name.

    Masked values are written as a number that does not occur in the column, which the list states.
    """
    found = []
    for name, values in columns_of(columns).items():
        column = np.ma.asanyarray(values)
        if column.ndim not in (1, 2):
            raise ValueError(f"attribute {name!r} has the shape {column.shape}, expected (n,) or (n, components)")
        components = 1 if column.ndim == 1 else column.shape[1]
        dtype: np.dtype[Any] = np.dtype("u1") if column.dtype == bool else column.dtype
        if dtype.newbyteorder("<") not in [np.dtype(known) for known in TYPES]:
            raise ValueError(f"attribute {name!r} has the type {dtype}, expected one of {', '.join(TYPES)}")
        unknown = _free_number(name, column, dtype) if np.ma.getmaskarray(column).any() else None
        found.append(Attribute(name, dtype, components, unknown=unknown))
    return found


def rows_of(columns: Columns | None, attributes: list[Attribute], count: int) -> np.ndarray:
    """Rows (count,) of attributes, with the stated number in place of masked values."""
    rows = np.empty(count, np.dtype([attribute.field for attribute in attributes]))
    for attribute, values in zip(attributes, columns_of(columns).values()):
        column = np.ma.asanyarray(values)
        if len(column) != count:
            raise ValueError(f"attribute {attribute.name!r} has {len(column)} values, expected {count}")
        if attribute.unknown is not None:
            column = column.astype(attribute.dtype).filled(np.frombuffer(attribute.unknown, attribute.dtype)[0])
        rows[attribute.name] = np.asarray(column)
    return rows


def _free_number(name: str, column: Any, dtype: np.dtype[Any]) -> bytes:
    """The bytes of a number that is no value of the column: NaN, or the greatest or least integer that is
    free.
    """
    if dtype.kind == "f":
        return np.array(np.nan, dtype.newbyteorder("<")).tobytes()
    values = np.unique(column.compressed())
    for step in range(len(values) + 1):
        for number in (np.iinfo(dtype).max - step, np.iinfo(dtype).min + step):
            if np.iinfo(dtype).min <= number <= np.iinfo(dtype).max and number not in values:
                return np.array(number, dtype.newbyteorder("<")).tobytes()
    raise ValueError(f"attribute {name!r} has masked values, and no number of its type is free to stand for them")
