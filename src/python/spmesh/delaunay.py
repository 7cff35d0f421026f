"""Exact Delaunay triangulations of arrays, with the names of `scipy.spatial.Delaunay`."""

from __future__ import annotations

import operator
import os
import warnings
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arguments import numbers_of
from .types import Floats

if TYPE_CHECKING:
    from ._native import Mesh

Ints = NDArray[np.int32]

_EPSILON = float(np.finfo(np.float64).eps)


def array_of(value: object, name: str, kinds: str = "biufO") -> NDArray[Any]:
    """Numbers as of `numbers_of`, as the compiled module takes them: in memory row by row."""
    numbers = numbers_of(value, name, kinds)
    return np.require(numbers, numbers.dtype, ["C", "A"])


def places_of(value: object, ndim: int, name: str = "xi") -> Floats:
    """(..., ndim) places."""
    places = array_of(value, name)
    if places.ndim == 0 or places.shape[-1] != ndim:
        raise ValueError(f"{name}: {ndim} coordinates each are needed, the shape is {places.shape}")
    return places


def points_of(points: object, name: str = "points") -> Floats:
    """An array of points as rows of numbers, or an error that names the argument."""
    array = array_of(points, name)
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ValueError(f"{name}: an array of 2 or 3 columns is needed, this one has the shape {array.shape}")
    return array


def threads_of(threads: int | None) -> int:
    """A number of threads; None stands for all processors that this process may use."""
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        count = operator.index(threads)
    except TypeError:
        count = 0
    if count < 1:
        raise ValueError(f"threads: a number of at least 1 is needed, not {threads!r}")
    return min(count, 1024)


class Delaunay:
    """Delaunay triangulation of points in the plane or in space, exact and canonical.

    All decisions are exact: no coordinates are joggled, no points are lost, and the same points give the same
    simplices, in any order, on any machine. Names and types are those of `scipy.spatial.Delaunay`, with these
    differences:

    * `coplanar` lists duplicates alone. No point is left out for lack of precision.
    * Points on a line (in space: in a plane), or fewer than three (four) different points, give no simplices;
      scipy raises an error.
    * `find_simplex` is exact. Of several simplices with a point on their common border it gives the least.
    * `simplices` of space are positively oriented, too.
    * Points have 2 or 3 columns. There is no furthest-site triangulation, and no option of Qhull has a meaning.

    Parameters
    ----------
    points : (n, 2) or (n, 3) array of float
        Coordinates; finite, from 5e-324 to 1.7e308. At most 268 million points of the plane, 60 million of space.
    furthest_site : bool
        Not supported.
    incremental : bool
        Has no effect: points can always be added.
    qhull_options : str
        Has no effect, with a warning.
    threads : int, optional
        Number of threads; all processors by default. The result does not depend on it. One thread triangulates
        points of the plane; all other steps use all.
    progress : callable, optional
        Called now and then with the share that is done, from 0 to 1, if there are 1,000 points or more. What it
        raises ends the work.

    Raises
    ------
    ValueError
        If the array has another shape, or a coordinate is not finite.
    OverflowError
        If there are too many points.
    KeyboardInterrupt
        Soon after the key is pressed: after some points, or between the steps before and after insertion.

    Notes
    -----
    `points` may be the caller's array, which must not be changed then. Several threads may ask at once; none may add
    points meanwhile.

    Examples
    --------
    >>> import spmesh
    >>> mesh = spmesh.Delaunay([[0, 0], [4, 0], [4, 4], [0, 4], [4, 4]])
    >>> mesh.simplices.shape, mesh.coplanar
    ((2, 3), array([[4, 0, 2]], dtype=int32))
    >>> mesh.find_simplex([[1, 0.5], [9, 9]]) >= 0
    array([ True, False])
    """

    def __init__(
        self,
        points: ArrayLike,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        threads: int | None = None,
        progress: Callable[[float], object] | None = None,
    ) -> None:
        if furthest_site:
            raise NotImplementedError("furthest_site: only nearest-site triangulations are made")
        if qhull_options is not None:
            warnings.warn("qhull_options have no effect: the triangulation is exact without them", stacklevel=2)
        self.furthest_site = False
        self._threads = threads
        self._triangulate(points_of(points), progress)

    def _triangulate(self, points: Floats, progress: Callable[[float], object] | None = None) -> None:
        from ._native import Mesh

        if progress is not None and not callable(progress):
            raise ValueError(f"progress: something to call is needed, not {progress!r}")
        mesh = Mesh(points, threads_of(self._threads), progress)
        # Only now, so that nothing changes if that failed.
        self._points, self._mesh = points, mesh
        for kind in type(self).__mro__:
            for name in [name for name, value in vars(kind).items() if isinstance(value, cached_property)]:
                self.__dict__.pop(name, None)

    # A triangulation is canonical: its points are all there is to know.

    def __getstate__(self) -> dict[str, Any]:
        members = (item for kind in type(self).__mro__ for item in vars(kind).items())
        caches = {name for name, value in members if isinstance(value, cached_property)}
        return {name: value for name, value in self.__dict__.items() if name not in caches | {"_mesh"}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._triangulate(self._points)

    @property
    def points(self) -> Floats:
        """(n, d) coordinates of the points."""
        return self._points

    @property
    def ndim(self) -> int:
        """Number of coordinates, d."""
        return int(self._points.shape[1])

    @property
    def npoints(self) -> int:
        """Number of points, n, with duplicates."""
        return int(self._points.shape[0])

    @property
    def nsimplex(self) -> int:
        """Number of simplices, m."""
        return int(self.simplices.shape[0])

    @cached_property
    def min_bound(self) -> Floats:
        """(d,) least coordinates."""
        return np.asarray(self._points.min(axis=0, initial=np.inf))

    @cached_property
    def max_bound(self) -> Floats:
        """(d,) greatest coordinates."""
        return np.asarray(self._points.max(axis=0, initial=-np.inf))

    @cached_property
    def simplices(self) -> Ints:
        """(m, d + 1) indices of the points of each simplex: triangles counterclockwise, tetrahedra positively
        oriented."""
        return self._mesh.simplices()

    @cached_property
    def neighbors(self) -> Ints:
        """(m, d + 1) indices of the simplices opposite to each vertex; -1 beyond the hull."""
        return self._mesh.neighbors()

    @cached_property
    def convex_hull(self) -> Ints:
        """(k, d) indices of the points of each facet of the hull; all points on the hull are in facets."""
        return self._mesh.hull()

    @cached_property
    def coplanar(self) -> Ints:
        """(k, 3) points that are no vertices because an equal point of lesser index is one: index, a simplex at
        that vertex (-1 if there are none), that vertex."""
        pairs = self._mesh.duplicates()
        simplex = self._simplex_of_vertex[pairs[:, 1]]
        return np.stack([pairs[:, 0], simplex, pairs[:, 1]], axis=1)

    @cached_property
    def _simplex_of_vertex(self) -> Ints:
        """For each point that is a vertex one of its simplices; else -1."""
        simplex = np.full(self.npoints, -1, dtype=np.int32)
        numbers = np.arange(self.nsimplex, dtype=np.int32)
        for corner in range(self.ndim, -1, -1):
            simplex[self.simplices[:, corner]] = numbers
        return simplex

    @cached_property
    def vertex_to_simplex(self) -> Ints:
        """(n,) index of a simplex at each point, or at the equal point that is a vertex; -1 if there are none."""
        simplex: Ints = np.array(self._simplex_of_vertex)
        simplex[self.coplanar[:, 0]] = self.coplanar[:, 1]
        return simplex

    @cached_property
    def vertex_neighbor_vertices(self) -> tuple[Ints, Ints]:
        """`indptr, indices`: the neighbours of point k are `indices[indptr[k]:indptr[k + 1]]`, increasing."""
        pairs = [
            self.simplices[:, first].astype(np.int64) << 32 | self.simplices[:, second]
            for first in range(self.ndim + 1)
            for second in range(self.ndim + 1)
            if first != second
        ]
        edges = np.unique(np.concatenate(pairs))
        starts = np.searchsorted(edges >> 32, np.arange(self.npoints + 1))
        return starts.astype(np.int32), (edges & 0xFFFFFFFF).astype(np.int32)

    @cached_property
    def transform(self) -> Floats:
        """(m, d + 1, d) affine transforms to barycentric coordinates, as scipy's: c[:d] = T (x - r) with T =
        `transform[i, :d]` and r = `transform[i, d]`. They are rounded: NaN for simplices so flat that they would
        have no digit right."""
        corners = self._points[self.simplices]
        origin = corners[:, -1]
        with np.errstate(all="ignore"):
            edges = np.swapaxes(corners[:, :-1] - origin[:, None], 1, 2)
            # By powers of two, so that determinants neither overflow nor underflow.
            exponents = np.frexp(np.abs(edges).max(axis=(1, 2), initial=0))[1][:, None, None]
            edges = np.ldexp(edges, -exponents)
            inverse = _inverses(edges)
            sizes = [np.abs(matrices).sum(axis=1).max(axis=1, initial=0) for matrices in (edges, inverse)]
            inverse[~(sizes[0] * sizes[1] * 1000 * _EPSILON < 1)] = np.nan
            inverse = np.ldexp(inverse, -exponents)
        return np.ascontiguousarray(np.concatenate([inverse, origin[:, None]], axis=1))

    def find_simplex(self, xi: ArrayLike, bruteforce: bool = False, tol: float | None = None) -> Ints:
        """The simplices that contain points: exactly, borders included.

        Parameters
        ----------
        xi : (..., d) array of float
            Points; those that are not finite are outside.
        bruteforce : bool
            Has no effect.
        tol : float, optional
            Not supported: nothing is nearly inside.

        Returns
        -------
        (...) array of int32
            Index of a simplex, the least if there are several; -1 outside of the hull.
        """
        if tol:
            raise ValueError("tol: decisions are exact, there is no tolerance")
        targets = places_of(xi, self.ndim)
        return self._mesh.locate(targets.reshape(-1, self.ndim)).reshape(targets.shape[:-1])

    def add_points(self, points: ArrayLike, restart: bool = False) -> None:
        """Adds points. The result is the triangulation of all points, which are triangulated anew.

        `restart` has no effect. Views of arrays that were taken before stay as they are.
        """
        more = points_of(points)
        if more.shape[1] != self.ndim:
            raise ValueError(f"points: {self.ndim} columns are needed, as the first points have")
        self._triangulate(np.concatenate([self._points, more]))

    def close(self) -> None:
        """Does nothing; for programs written for scipy."""

    # Lifted to the paraboloid x -> |x|^2.

    paraboloid_scale = 1.0
    paraboloid_shift = 0.0

    @cached_property
    def equations(self) -> Floats:
        """(m, d + 2) hyperplanes of the lifted simplices, [normal, offset] with unit normals that point down; the
        numbers are rounded. With `paraboloid_scale` 1 and `paraboloid_shift` 0."""
        with np.errstate(all="ignore"):
            lifted = self.lift_points(self._points)[self.simplices]
            edges = lifted[:, :-1] - lifted[:, -1:]
            slopes = _inverses(edges[:, :, :-1]) @ edges[:, :, -1:]
            normals = np.concatenate([slopes[:, :, 0], np.full((len(edges), 1), -1.0)], axis=1)
            normals /= np.linalg.norm(normals, axis=1)[:, None]
            offsets = -np.einsum("ij,ij->i", normals, lifted[:, -1])
        return np.ascontiguousarray(np.concatenate([normals, offsets[:, None]], axis=1))

    def lift_points(self, x: ArrayLike) -> Floats:
        """(..., d + 1) points of the paraboloid above points (..., d)."""
        points = places_of(x, self.ndim, "x")
        return np.concatenate([points, np.square(points).sum(axis=-1, keepdims=True)], axis=-1)

    def plane_distance(self, xi: ArrayLike) -> Floats:
        """(..., m) signed distances of lifted points from the hyperplanes of all simplices."""
        return np.asarray(self.lift_points(xi) @ self.equations[:, :-1].T + self.equations[:, -1])

    def to_scipy(self) -> Any:
        """A `scipy.spatial.Delaunay` with these simplices, for functions of scipy that ask for one, such as
        `scipy.interpolate.CloughTocher2DInterpolator`."""
        from scipy.spatial import Delaunay as ScipyDelaunay  # type: ignore[import-untyped, unused-ignore]

        other = ScipyDelaunay.__new__(ScipyDelaunay)
        other._qhull = None
        other._points = self._points
        for name in ("simplices", "neighbors", "equations", "coplanar", "min_bound", "max_bound", "ndim", "npoints"):
            setattr(other, name, getattr(self, name))
        other.nsimplex = self.nsimplex
        other.furthest_site = False
        other.paraboloid_scale, other.paraboloid_shift = self.paraboloid_scale, self.paraboloid_shift
        other.good = None
        other._transform = self.transform
        other._vertex_to_simplex = self.vertex_to_simplex
        other._vertex_neighbor_vertices = self.vertex_neighbor_vertices
        return other


def _inverses(matrices: Floats) -> Floats:
    """Inverses of (m, d, d) matrices by their adjugates; infinite or NaN where there is none."""
    if matrices.shape[1] == 2:
        (a, b), (c, d) = matrices[:, 0].T, matrices[:, 1].T
        adjugate = np.array([[d, -b], [-c, a]])
        return np.moveaxis(adjugate / (a * d - b * c), 2, 0)
    rows = [matrices[:, row] for row in range(3)]
    columns = np.stack([np.cross(rows[row - 2], rows[row - 1]) for row in range(3)], axis=2)
    determinants = np.einsum("ij,ij->i", rows[0], columns[:, :, 0])
    return np.asarray(columns / determinants[:, None, None])
