"""Interpolation of scattered values, with the names of `scipy.interpolate.LinearNDInterpolator`."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .delaunay import Delaunay, Floats, Ints, points_of

Points: TypeAlias = "ArrayLike | Delaunay | tuple[ArrayLike, ...]"


def _places(arguments: tuple[Any, ...], ndim: int) -> Floats:
    """(..., d) places from one array of them, or from arrays of each coordinate, which are broadcast."""
    if len(arguments) == 1 and isinstance(arguments[0], tuple):
        arguments = arguments[0]
    if len(arguments) == 1:
        places = np.asarray(arguments[0], dtype=np.float64)
    else:
        places = np.stack(np.broadcast_arrays(*[np.asarray(x, dtype=np.float64) for x in arguments]), axis=-1)
    if places.ndim == 0 or places.shape[-1] != ndim:
        raise ValueError(f"xi: {ndim} coordinates each are needed, the shape is {places.shape}")
    return places


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
        self._offset: Floats | float = 0.0
        self._scale: Floats | float = 1.0
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
                rows = _places(points, len(points)).reshape(-1, len(points))
            array = points_of(rows)
            if rescale and len(array):
                self._offset = array.mean(axis=0)
                spread = np.ptp(array, axis=0)
                self._scale = np.where(spread > 0, spread, 1.0)
                array = np.ascontiguousarray((array - self._offset) / self._scale)
            self.tri = Delaunay(array, threads=threads)
        numbers = np.asarray(values)
        if numbers.ndim == 0 or len(numbers) != self.tri.npoints:
            raise ValueError(
                f"values: one for each of {self.tri.npoints} points is needed, the shape is {numbers.shape}"
            )
        self.is_complex = np.issubdtype(numbers.dtype, np.complexfloating)
        self.values: NDArray[Any] = np.ascontiguousarray(numbers, dtype=complex if self.is_complex else float)
        self.fill_value = fill_value

    @property
    def points(self) -> Floats:
        """(n, d) points, rescaled if that was asked for."""
        return self.tri.points

    def _columns(self) -> Floats:
        """(n, k) real numbers of each point."""
        columns = self.values.reshape(len(self.values), -1)
        return np.ascontiguousarray(columns.view(np.float64) if self.is_complex else columns)

    def _evaluate(self, places: Floats) -> Floats:
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
        places = np.ascontiguousarray((xi.reshape(-1, self.tri.ndim) - self._offset) / self._scale)
        found = self._evaluate(places)
        if self.is_complex:
            found = found.view(np.complex128)
        if not np.isnan(self.fill_value):
            found[self.tri.find_simplex(places) < 0] = self.fill_value
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
        What places outside of the hull get; NaN by default.
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

    def _evaluate(self, places: Floats) -> Floats:
        return self.tri._mesh.linear(self._columns(), places)


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

    def _evaluate(self, places: Floats) -> Floats:
        return self.tri._mesh.natural(self._columns(), places)

    def weights(self, xi: ArrayLike) -> tuple[NDArray[np.int64], Ints, Floats]:
        """`indptr, indices, weights`: the natural neighbours of place k of `xi`, an (m, 2) array, are the points
        `indices[indptr[k]:indptr[k + 1]]`, with weights in the same places that sum to 1; none outside of the hull."""
        places = _places((xi,), 2).reshape(-1, 2)
        return self.tri._mesh.natural_weights(np.ascontiguousarray((places - self._offset) / self._scale))
