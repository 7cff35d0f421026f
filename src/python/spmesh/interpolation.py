"""Interpolation of scattered values, with the names of `scipy.interpolate.LinearNDInterpolator`."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .delaunay import Delaunay, Ints, array_of, places_of, points_of
from .types import Floats

Points: TypeAlias = "ArrayLike | Delaunay | tuple[ArrayLike, ...]"


def _places(arguments: tuple[Any, ...], ndim: int, name: str = "xi") -> Floats:
    """(..., d) places from one array of them, or from arrays of each coordinate, which are broadcast."""
    if len(arguments) == 1 and isinstance(arguments[0], tuple):
        arguments = arguments[0]
    if len(arguments) == 1:
        return places_of(arguments[0], ndim, name)
    if not arguments:
        raise ValueError(f"{name}: places are needed")
    columns = [array_of(x, name) for x in arguments]
    try:
        columns = list(np.broadcast_arrays(*columns))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    return places_of(np.stack(columns, axis=-1), ndim, name)


class _Interpolator:
    """Values at points, on their triangulation."""

    def __init__(
        self,
        points: Points,
        values: ArrayLike,
        fill_value: complex = np.nan,
        rescale: bool = False,
        *,
        threads: int | None = None,
    ) -> None:
        # How points are scaled: what is taken off, and what divides the rest.
        self._rescaling: tuple[Floats, Floats] | None = None
        if isinstance(points, Delaunay):
            if rescale:
                raise ValueError(
                    "Rescaling is not supported when passing a Delaunay triangulation as ``points``."
                )
            self.tri = points
        else:
            if hasattr(points, "simplices"):
                raise TypeError("points: only a spmesh.Delaunay is taken as a triangulation: pass its points")
            rows: Any = points
            if isinstance(points, tuple):
                rows = _places(points, max(len(points), 2), "points").reshape(-1, max(len(points), 2))
            array = points_of(rows)
            if rescale and len(array):
                spread = np.ptp(array, axis=0)
                self._rescaling = array.mean(axis=0), np.where(spread > 0, spread, 1.0)
                array = self._rescaled(array)
            self.tri = Delaunay(array, threads=threads)
        # Of the triangulation as it is now: points that are added later have no values.
        self._mesh = self.tri._mesh
        numbers = array_of(values, "values", "biufcO")
        if numbers.ndim == 0 or len(numbers) != self.tri.npoints:
            raise ValueError(
                f"values: one for each of {self.tri.npoints} points is needed, the shape is {numbers.shape}"
            )
        self.is_complex = numbers.dtype.kind == "c"
        self.fill_value = fill_value
        try:
            self._fill = np.array([fill_value], dtype=numbers.dtype).view(np.float64)
        except (TypeError, ValueError, OverflowError) as error:
            raise ValueError(f"fill_value: {error}") from None
        # A copy that nobody writes to: threads read it without the lock of the interpreter.
        self.values: NDArray[Any] = numbers.copy()
        self.values.flags.writeable = False
        width = math.prod(numbers.shape[1:]) * (2 if self.is_complex else 1)
        self._columns: Floats = np.zeros((len(numbers), width))
        if numbers.size:
            self._columns = self.values.reshape(-1).view(np.float64).reshape(len(numbers), width)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name not in ("_mesh", "_columns")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(state["tri"], state["values"], state["fill_value"])  # type: ignore[misc]
        self.__dict__.update(state)

    @property
    def points(self) -> Floats:
        """(n, d) points, rescaled if that was asked for."""
        return self.tri.points

    def _rescaled(self, places: Floats) -> Floats:
        """Places (n, d) of the world among the points of the triangulation."""
        if self._rescaling is None:
            return places
        offset, scale = self._rescaling
        return np.asarray((places - offset) / scale)

    def _evaluate(self, places: Floats, fill: list[float]) -> Floats:
        raise NotImplementedError

    def __call__(self, *args: Any) -> NDArray[Any]:
        """Values at places.

        Parameters
        ----------
        *args : one (..., d) array, or d arrays of coordinates that can be broadcast

        Returns
        -------
        (...) + the shape of one point's value; `fill_value` outside of the hull and where coordinates are not finite
        """
        xi = _places(args, self.tri.ndim)
        places = self._rescaled(xi.reshape(-1, self.tri.ndim))
        width = self._columns.shape[1]
        found: NDArray[Any] = self._evaluate(places, np.resize(self._fill, width).tolist())
        if self.is_complex and width:
            found = found.view(np.complex128)
        return found.reshape(xi.shape[:-1] + self.values.shape[1:])


class LinearNDInterpolator(_Interpolator):
    """Linear interpolation in the triangles or tetrahedra of a Delaunay triangulation.

    As `scipy.interpolate.LinearNDInterpolator`; the triangulation is exact and canonical, and so is the choice of
    the simplex. At points the result is exactly their value.

    Parameters
    ----------
    points : (n, 2) or (n, 3) array of float, tuple of coordinate arrays, or spmesh.Delaunay
    values : (n, ...) array of float or complex
        Values at the points. Those of duplicates do not count, but for the first.
    fill_value : number
        What places outside of the hull get, and those that are not finite; NaN by default.
    rescale : bool
        Whether points are scaled to a box with sides of 1 before they are triangulated.
    threads : int, optional
        Number of threads; all processors by default.

    Examples
    --------
    >>> import spmesh
    >>> f = spmesh.LinearNDInterpolator([[0, 0], [4, 0], [0, 4]], [0, 4, 8])
    >>> f([[1, 1], [5, 5]])
    array([ 3., nan])
    """

    def _evaluate(self, places: Floats, fill: list[float]) -> Floats:
        return self._mesh.linear(self._columns, fill, places)


class NaturalNeighborInterpolator(_Interpolator):
    """Natural neighbour interpolation (Sibson) in the plane: smooth but at the points, local, without parameters.

    A place takes the values of its natural neighbours in proportion to the areas that its Voronoi cell would take
    from theirs. Weights are off by less than 1e-12.

    Parameters
    ----------
    points, values, fill_value, rescale, threads
        As of `LinearNDInterpolator`; two columns.

    Examples
    --------
    >>> import spmesh
    >>> f = spmesh.NaturalNeighborInterpolator([[0, 0], [4, 0], [4, 4], [0, 4], [2, 2]], [0, 4, 8, 4, 4])
    >>> float(f(2, 1).round(9))
    3.0
    """

    def __init__(
        self,
        points: Points,
        values: ArrayLike,
        fill_value: complex = np.nan,
        rescale: bool = False,
        *,
        threads: int | None = None,
    ) -> None:
        super().__init__(points, values, fill_value, rescale, threads=threads)
        if self.tri.ndim != 2:
            raise ValueError("points: natural neighbours are those of the plane, 2 columns")

    def _evaluate(self, places: Floats, fill: list[float]) -> Floats:
        return self._mesh.natural(self._columns, fill, places)

    def weights(self, xi: ArrayLike) -> tuple[NDArray[np.int64], Ints, Floats]:
        """`indptr, indices, weights`: the natural neighbours of place k of `xi`, an (m, 2) array, are the points
        `indices[indptr[k]:indptr[k + 1]]`, with weights in the same places that sum to 1; none outside of the hull."""
        places = _places((xi,), 2).reshape(-1, 2)
        return self._mesh.natural_weights(self._rescaled(places))
