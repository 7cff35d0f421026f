"""Writes points and meshes that are in memory."""

from __future__ import annotations

import numpy as np

from .arguments import attributes_of, check_finite, columns_of, indices_of, points_of, rows_of, triple
from .header import Header
from .orientation import orientations
from .types import ArrayLike, Columns, File, Integers
from .writer import PAYLOAD_MAX, Writer

# Simplices of a patch: their new vertices and their indices fit a block.
PATCH = 4096
SHAPES = {3: ("triangle", "clockwise"), 4: ("tetrahedron", "negatively oriented")}


def write_points(
    file: File, xyz: ArrayLike, attributes: Columns | None = None, scale: float | ArrayLike | None = None,
    offset: ArrayLike = (0.0, 0.0, 0.0), dims: int = 2, wkt: str | None = None,
) -> None:
    """Writes points (n, 2) or (n, 3) of the world as a stream that `spfinalize` reads.

    With `scale` (one number, or one per axis) they are rounded to a grid of 32-bit integers, which starts at
    `offset`. `dims` is 2 if z is an elevation, 3 if it is geometry. `attributes` are columns by name: arrays
    (n,) or (n, components). `wkt` is the coordinate reference system. Raises ValueError, which names the
    argument, for arrays of other shapes and types.

        spmesh.write_points("points.spm", xyz, {"intensity": intensity}, scale=0.001)
    """
    points = points_of(xyz, axes=(2, 3) if dims == 2 else (3,))
    header = Header("points", dims, points.shape[1] > dims, points=len(points), wkt=wkt)
    stored = _prepare(header, points, attributes, scale, offset)
    rows = rows_of(attributes, header.attributes, len(points))
    with Writer(file, header) as writer:
        writer.points(stored, rows if header.attributes else None, stored=True)


def write_triangles(
    file: File, xyz: ArrayLike, triangles: ArrayLike, attributes: Columns | None = None,
    scale: float | ArrayLike | None = None, offset: ArrayLike = (0.0, 0.0, 0.0), wkt: str | None = None,
    orient: bool = False,
) -> None:
    """Writes a triangle mesh: vertices (n, 2) or (n, 3) of the world, and triangles (m, 3) as indices of
    vertices.

    Triangles must be counterclockwise in x and y, and not flat, after the rounding to the grid of `scale`; an
    exact test refuses others with a ValueError that names the first. `orient=True` turns clockwise ones. Four
    columns are tetrahedra, as in `write_tetrahedra`. Other arguments and errors are those of `write_points`.

    Vertices are written with their first triangle and finalized with their last, so triangles that are in a
    spatial order make a stream that needs little memory.

        spmesh.write_triangles("mesh.spm", xyz, scipy.spatial.Delaunay(xyz[:, :2]).simplices, orient=True)
    """
    _write_mesh(file, xyz, triangles, attributes, scale, offset, wkt, orient, "triangles", (3, 4))


def write_tetrahedra(
    file: File, xyz: ArrayLike, tetrahedra: ArrayLike, attributes: Columns | None = None,
    scale: float | ArrayLike | None = None, offset: ArrayLike = (0.0, 0.0, 0.0), wkt: str | None = None,
    orient: bool = False,
) -> None:
    """Writes a tetrahedral mesh: vertices (n, 3), and tetrahedra (m, 4) with det(b - a, c - a, d - a) > 0.

    Arguments and errors are those of `write_triangles`.

        spmesh.write_tetrahedra("mesh.spm", xyz, scipy.spatial.Delaunay(xyz).simplices, orient=True)
    """
    _write_mesh(file, xyz, tetrahedra, attributes, scale, offset, wkt, orient, "tetrahedra", (4,))


def _write_mesh(
    file: File, xyz: ArrayLike, simplices: ArrayLike, attributes: Columns | None, scale: float | ArrayLike | None,
    offset: ArrayLike, wkt: str | None, orient: bool, name: str, corners: tuple[int, ...],
) -> None:
    points = points_of(xyz)
    indices = indices_of(simplices, len(points), name, corners)
    dims = indices.shape[1] - 1
    points_of(points, axes=(2, 3) if dims == 2 else (3,))
    header = Header("triangle mesh" if dims == 2 else "tetrahedral mesh", dims, points.shape[1] > dims, wkt=wkt)
    stored = _prepare(header, points, attributes, scale, offset)
    rows = rows_of(attributes, header.attributes, len(points))
    with Writer(file, header) as writer:
        _write_patches(writer, stored, indices, rows, orient)


def _prepare(
    header: Header, points: np.ndarray, attributes: Columns | None, scale: float | ArrayLike | None, offset: ArrayLike,
) -> np.ndarray:
    """Completes the header: grid, attributes, and the box, so that programs need not be told where points
    are.
    """
    if scale is not None:
        header.scale, header.offset = triple(scale, "scale"), triple(offset, "offset")
    header.attributes = attributes_of(columns_of(attributes))
    header.check()
    if not len(points):
        return np.empty((0, header.axes), header.dtype)
    low, high = _box(points)
    if not np.isfinite(low + high).all():
        check_finite(points, "xyz")
    stored = header.stored(points)
    flat = [0.0] * (3 - header.axes)
    low, high = (header.stored(np.array(side)).tolist() for side in (low, high))
    header.stored_bounds = (*low, *flat, *high, *flat)
    return stored


def _box(points: np.ndarray) -> tuple[list[float], list[float]]:
    """The least and the greatest of each axis. Column by column is several times as fast as `min(axis=0)`."""
    columns = [points[:, axis] for axis in range(points.shape[1])]
    return [float(column.min()) for column in columns], [float(column.max()) for column in columns]


def _distinct(numbers: np.ndarray) -> np.ndarray:
    """Increasing numbers without repetitions; `np.unique` takes twice as long."""
    ordered: np.ndarray = np.sort(numbers)
    distinct: np.ndarray = ordered[np.concatenate([[True], ordered[1:] != ordered[:-1]])[: len(ordered)]]
    return distinct


def _write_patches(
    writer: Writer, stored: np.ndarray, simplices: Integers, rows: np.ndarray, orient: bool
) -> None:
    count, corners = len(stored), simplices.shape[1]
    step = min(PATCH, PAYLOAD_MAX // (corners * max(rows.itemsize, 1)))
    flat, dtype = simplices.ravel(), simplices.dtype
    places = np.arange(flat.size, dtype=dtype)
    # Of several assignments to one element the last one counts.
    first = np.full(count, flat.size, dtype)
    first[flat[::-1]] = places[::-1]
    starts = np.sort(first[first < flat.size])
    # Vertices get ids in the order of their first use; unused ones come at the end.
    order = np.concatenate([flat[starts], np.flatnonzero(first == flat.size).astype(dtype)])
    ids = np.empty(count, dtype)
    ids[order] = np.arange(count, dtype=dtype)
    flat = ids[flat]
    last = np.full(count, -1, dtype)
    last[flat] = np.repeat(np.arange(-(-len(simplices) // step), dtype=dtype), step * corners)[: flat.size]
    stored, rows = stored[order], rows[order]
    places_of = ids  # Scratch: local indices of imported vertices.
    ends = np.searchsorted(starts, np.arange(step * corners, flat.size + step * corners, step * corners)).tolist()
    written = 0
    for number, end in enumerate(ends):
        part = flat[number * step * corners : (number + 1) * step * corners]
        local, is_old = part - written, part < written
        old = part[is_old]
        imported, new = _distinct(old), end - written
        places_of[imported] = np.arange(new, new + len(imported))
        local[is_old] = places_of[old]
        points = np.concatenate([stored[written:end], stored[imported]])
        local = _oriented(points, local.reshape(-1, corners), number * step, orient)
        is_last = np.concatenate([last[written:end], last[imported]]) == number
        chosen = rows[written:end] if rows.itemsize else None
        writer.patch(points[:new], imported, local, np.flatnonzero(is_last), chosen, stored=True)
        written = end
    for at in range(written, count, step):
        alone = slice(at, min(at + step, count))
        size = alone.stop - at
        writer.patch(stored[alone], (), (), np.arange(size), rows[alone] if rows.itemsize else None, stored=True)


def _oriented(points: np.ndarray, simplices: np.ndarray, start: int, orient: bool) -> np.ndarray:
    """Simplices of a patch, all positive; `start` is the number of the first."""
    shape, wrong = SHAPES[simplices.shape[1]]
    signs = orientations(points[:, : simplices.shape[1] - 1].astype(np.float64), simplices)
    if (signs > 0).all():
        return simplices
    if (signs == 0).any():
        number = int((signs == 0).argmax())
        is_twice = len(set(simplices[number].tolist())) < simplices.shape[1]
        found = "uses a vertex twice" if is_twice else "is flat: its corners lie on a line or plane"
        raise ValueError(f"{shape} {start + number} {found}")
    if not orient:
        raise ValueError(f"{shape} {start + int((signs < 0).argmax())} is {wrong}: orient=True turns such ones")
    simplices[signs < 0, :2] = simplices[signs < 0, 1::-1]
    return simplices
