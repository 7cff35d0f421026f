"""From scattered values to values anywhere: which simplex, linear and natural neighbour interpolation, and scipy beside it."""

import numpy as np

import spmesh

random = np.random.default_rng(1)
places = random.uniform(0, 10, (2000, 2))
heights = np.sin(places[:, 0]) * np.cos(places[:, 1])

mesh = spmesh.Delaunay(places)
print(f"{mesh.npoints} points, {mesh.nsimplex} triangles, {len(mesh.convex_hull)} edges of the hull")

# A triangulation serves many interpolators.
linear = spmesh.LinearNDInterpolator(mesh, heights)
natural = spmesh.NaturalNeighborInterpolator(mesh, heights)

x, y = np.meshgrid(np.linspace(0.5, 9.5, 300), np.linspace(0.5, 9.5, 300))
truth = np.sin(x) * np.cos(y)
for name, interpolator in (("linear", linear), ("natural neighbours", natural)):
    error = interpolator(x, y) - truth
    print(f"{name}: error {np.sqrt(np.nanmean(error**2)):.4f}")

print("in triangle", mesh.find_simplex([[5, 5], [20, 20]]), "(-1: outside)")

# The weights themselves are a sparse matrix: many functions at once, or derivatives by the values.
indptr, indices, weights = natural.weights(np.column_stack([x.ravel(), y.ravel()]))
print(f"{len(weights) / x.size:.1f} natural neighbours of a place")

# Grids and duplicates are ordinary input; points of space, too.
grid = np.stack(np.meshgrid(*[np.arange(20.0)] * 3), axis=-1).reshape(-1, 3)
cube = spmesh.Delaunay(np.concatenate([grid, grid]))
print(f"{cube.nsimplex} tetrahedra in a lattice, {len(cube.coplanar)} duplicates")

try:
    from scipy.interpolate import CloughTocher2DInterpolator

    smooth = CloughTocher2DInterpolator(mesh.to_scipy(), heights)
    print(f"Clough-Tocher of scipy: error {np.sqrt(np.nanmean((smooth(x, y) - truth) ** 2)):.4f}")
except ImportError:
    print("scipy is not installed")
