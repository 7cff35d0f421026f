"""Triangulations and interpolators of the compiled module, against definitions in fractions and against scipy."""

import itertools
import os
import pickle
import signal
import threading
import time
import unittest
from fractions import Fraction

import numpy as np

import spmesh

try:
    from spmesh import _native  # noqa: F401
except ImportError as error:
    raise unittest.SkipTest("the compiled module is not there") from error


def determinant(rows):
    if not rows:
        return 1
    minors = ([row[:i] + row[i + 1 :] for row in rows[1:]] for i in range(len(rows)))
    return sum((-1) ** i * value * determinant(minor) for i, (value, minor) in enumerate(zip(rows[0], minors)) if value)


def fractions(points):
    return [[Fraction(float(value)) for value in point] for point in points]


def differences(points, origin):
    return [[a - b for a, b in zip(point, origin)] for point in points]


def sets(seed=5):
    """Small sets of every kind, in the plane and in space."""
    random = np.random.default_rng(seed)
    for ndim in (2, 3):
        lattice = np.array(list(itertools.product(range(3), repeat=ndim)), float)
        yield from (lattice, lattice * 1e300, lattice * 1e-300, np.concatenate([lattice, lattice[::2]]))
        for count in (0, 1, 2, 3, 4, 5, 9):
            yield random.random((count, ndim))
            yield random.integers(0, 3, (count, ndim)).astype(float)
        yield np.outer(np.arange(5.0), np.ones(ndim))
        yield np.concatenate([random.random((8, ndim)), [[1e9] * ndim]])


class Child(spmesh.Delaunay):
    """A triangulation with a name."""

    def __init__(self, points, name):
        super().__init__(points)
        self.name = name


class Triangulations(unittest.TestCase):
    def test_simplices_are_delaunay_and_cover_the_hull(self):
        for points in sets():
            mesh = spmesh.Delaunay(points)
            exact, ndim = fractions(points), points.shape[1]
            self.assertEqual((mesh.simplices.dtype, mesh.neighbors.dtype), (np.int32, np.int32))
            distinct = {tuple(point) for point in exact}
            self.assertEqual(len(points) - len(mesh.coplanar), len(distinct))
            volume = 0
            for simplex in mesh.simplices:
                corners = [exact[v] for v in simplex]
                part = determinant(differences(corners[1:], corners[0]))
                self.assertGreater(part, 0)
                volume += part
                for point in exact:
                    rows = [row + [sum(x * x for x in row)] for row in differences(corners, point)]
                    self.assertLessEqual((-1) ** ndim * determinant(rows), 0, (points, simplex, point))
            # The cone of the hull from one point has the same volume.
            hull = sum(determinant(differences([exact[v] for v in facet], exact[0])) for facet in mesh.convex_hull)
            self.assertEqual(volume, abs(hull))
            used = set(mesh.simplices.ravel().tolist())
            if len(mesh.simplices):
                self.assertEqual(used, set(range(len(points))) - set(mesh.coplanar[:, 0].tolist()))
            for index, simplex, vertex in mesh.coplanar.tolist():
                self.assertEqual(exact[index], exact[vertex])
                self.assertTrue(simplex == -1 or vertex in mesh.simplices[simplex])

    def test_neighbours_and_lookups(self):
        for points in sets():
            mesh = spmesh.Delaunay(points)
            facets = {}
            for number, simplex in enumerate(mesh.simplices.tolist()):
                for corner in range(len(simplex)):
                    facets.setdefault(frozenset(simplex[:corner] + simplex[corner + 1 :]), []).append((number, corner))
            for sides in facets.values():
                others = [number for number, _ in sides][::-1] if len(sides) == 2 else [-1]
                self.assertEqual([int(mesh.neighbors[side]) for side in sides], others)
            open_facets = {facet for facet, sides in facets.items() if len(sides) == 1}
            self.assertEqual({frozenset(facet) for facet in mesh.convex_hull.tolist()}, open_facets)
            indptr, indices = mesh.vertex_neighbor_vertices
            stars = [set() for _ in points]
            for a, b in (pair for simplex in mesh.simplices.tolist() for pair in itertools.permutations(simplex, 2)):
                stars[a].add(b)
            self.assertEqual([set(indices[i:j].tolist()) for i, j in zip(indptr, indptr[1:])], stars)
            if len(mesh.simplices):
                vertices = np.arange(len(points))
                vertices[mesh.coplanar[:, 0]] = mesh.coplanar[:, 2]
                self.assertTrue((mesh.simplices[mesh.vertex_to_simplex] == vertices[:, None]).any(axis=1).all())

    def test_points_are_found_in_closed_simplices(self):
        random = np.random.default_rng(1)
        for points in sets():
            mesh = spmesh.Delaunay(points)
            middles = [points[list(pair)].mean(axis=0) for pair in itertools.combinations(range(min(len(points), 4)), 2)]
            targets = np.array([*points, *middles, *random.random((9, points.shape[1])), [np.nan] * points.shape[1]])
            found = mesh.find_simplex(targets)
            for target, number in zip(fractions(targets[:-1]), found):
                contains = (
                    all(
                        determinant(differences([*corners[:i], target, *corners[i + 1 :]][1:], [*corners[:i], target, *corners[i + 1 :]][0])) >= 0
                        for i in range(len(corners))
                    )
                    for corners in ([fractions(points)[v] for v in simplex] for simplex in mesh.simplices)
                )
                self.assertEqual(number, next((i for i, is_in in enumerate(contains) if is_in), -1))
            self.assertEqual(found[-1], -1)

    def test_threads_and_order_make_no_difference(self):
        for ndim in (2, 3):
            points = np.random.default_rng(2).random((60_000, ndim))
            one, two = (spmesh.Delaunay(points, threads=threads) for threads in (1, 2))
            for name in ("simplices", "neighbors", "convex_hull"):
                np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
            order = np.random.default_rng(3).permutation(len(points))
            other = order[spmesh.Delaunay(points[order]).simplices]
            as_set = [np.unique(np.sort(simplices, axis=1), axis=0) for simplices in (one.simplices, other)]
            np.testing.assert_array_equal(*as_set)

    def test_arguments_are_named(self):
        for bad in ([1.0, 2.0], np.zeros((3, 4)), np.zeros((2, 2, 2)), np.ma.masked_all((3, 2)), [["a", "b"]], [[np.inf, 0]]):
            with self.assertRaises(ValueError):
                spmesh.Delaunay(bad)
        with self.assertRaisesRegex(ValueError, "points: .*shape"):
            spmesh.Delaunay([1.0, 2.0])
        with self.assertRaisesRegex(NotImplementedError, "furthest_site"):
            spmesh.Delaunay([[0, 0]], furthest_site=True)
        with self.assertWarnsRegex(UserWarning, "qhull_options"):
            mesh = spmesh.Delaunay([[0, 0], [1, 0], [0, 1]], qhull_options="QJ")
        with self.assertRaisesRegex(ValueError, "xi: 2 coordinates"):
            mesh.find_simplex([[1, 2, 3]])
        with self.assertRaisesRegex(ValueError, "tol"):
            mesh.find_simplex([[1, 2]], tol=0.1)
        with self.assertRaisesRegex(ValueError, "threads"):
            spmesh.Delaunay([[0, 0]], threads=0)
        with self.assertRaisesRegex(ValueError, "2 columns"):
            mesh.add_points([[1, 2, 3]])

    def test_strange_arrays(self):
        points = np.random.default_rng(15).random((20, 2))
        expected = spmesh.Delaunay(points).simplices
        unaligned = np.frombuffer(b"x" + points.tobytes(), np.float64, offset=1).reshape(-1, 2)
        for same in (unaligned, np.asfortranarray(points), points.astype(">f8"), points[::-1][::-1], points.tolist()):
            np.testing.assert_array_equal(spmesh.Delaunay(same).simplices, expected)
        for bad in ([[2**60, 0], [2**60 + 1, 0]], np.zeros((3, 2), "M8[s]"), [["1", "2"]], [[None, 1]], [[1], [2, 3]], [[1j, 0]]):
            with self.assertRaisesRegex(ValueError, "^points"):
                spmesh.Delaunay(bad)
        with self.assertRaisesRegex(ValueError, "^points: point 1"):
            spmesh.Delaunay([[0, 0], [np.nan, 0]])
        with self.assertRaisesRegex(ValueError, "^progress"):
            spmesh.Delaunay(points, progress=3)
        for threads in (2.5, "2", [1], -1):
            with self.assertRaisesRegex(ValueError, "^threads"):
                spmesh.Delaunay(points, threads=threads)
        for masked in (np.ma.masked_array([0.0, 1.0], [True, False]),):
            with self.assertRaisesRegex(ValueError, "^xi"):
                spmesh.Delaunay(points).find_simplex(masked)

    def test_what_fails_changes_nothing(self):
        mesh = spmesh.Delaunay([[0, 0], [4, 0], [0, 4], [4, 5]])
        simplices = mesh.simplices
        for bad in ([[np.nan, 1]], [[1, 2, 3]]):
            with self.assertRaises(ValueError):
                mesh.add_points(bad)
        self.assertEqual((mesh.npoints, len(mesh.points)), (4, 4))
        np.testing.assert_array_equal(mesh.simplices, simplices)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(mesh)).simplices, simplices)

    def test_subclasses(self):
        mesh = Child([[0, 0], [4, 0], [0, 4]], "name")
        self.assertEqual((mesh.nsimplex, pickle.loads(pickle.dumps(mesh)).name), (1, "name"))
        mesh.add_points([[1, 1]])
        self.assertEqual(mesh.nsimplex, 3)

    def test_transforms_of_great_and_small_simplices(self):
        for ndim, powers in ((2, (160, -170)), (3, (110, -110))):
            for power in powers:
                corners = np.concatenate([np.zeros((1, ndim)), np.eye(ndim)]) * 10.0**power
                mesh = spmesh.Delaunay(corners)
                weights = mesh.transform[0, :ndim] @ (corners.mean(axis=0) - mesh.transform[0, ndim])
                np.testing.assert_allclose(weights, 1 / (ndim + 1))

    def test_many_simplices_at_one_vertex(self):
        angles = np.linspace(0, 2 * np.pi, 20_000, endpoint=False)
        mesh = spmesh.Delaunay(np.concatenate([[[0, 0]], np.stack([np.cos(angles), np.sin(angles)], axis=1)]))
        at_centre = np.flatnonzero((mesh.simplices == 0).any(axis=1))
        started = time.process_time()
        self.assertEqual(mesh.find_simplex(np.zeros((20, 2))).tolist(), [at_centre.min()] * 20)
        # A second a target if each triangle is compared with all others.
        self.assertLess(time.process_time() - started, 5)

    def test_points_can_follow(self):
        points = np.random.default_rng(4).random((50, 2))
        mesh = spmesh.Delaunay(points[:20])
        self.assertEqual(mesh.simplices.max(), 19)
        mesh.add_points(points[20:])
        np.testing.assert_array_equal(mesh.simplices, spmesh.Delaunay(points).simplices)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(mesh)).simplices, mesh.simplices)
        np.testing.assert_array_equal(mesh.points, points)

    def test_lifted_and_barycentric_coordinates(self):
        for ndim in (2, 3):
            mesh = spmesh.Delaunay(np.random.default_rng(6).random((40, ndim)))
            corners = mesh.points[mesh.simplices]
            centre = corners.mean(axis=1)
            weights = np.einsum("mij,mj->mi", mesh.transform[:, :ndim], centre - mesh.transform[:, ndim])
            np.testing.assert_allclose(weights, 1 / (ndim + 1), rtol=1e-6)
            heights = np.einsum("mij,mj->mi", mesh.lift_points(corners), mesh.equations[:, :-1]) + mesh.equations[:, -1:]
            np.testing.assert_allclose(heights, 0, atol=1e-9)
            # The paraboloid is below its chords, and distances count downwards.
            self.assertGreaterEqual(np.diagonal(mesh.plane_distance(centre)).min(), -1e-12)

    def test_progress_and_interrupts(self):
        points = np.random.default_rng(7).random((400_000, 3))
        shares = []
        spmesh.Delaunay(points[:150_000], progress=shares.append)
        self.assertEqual(shares[-1], 1.0)
        self.assertEqual(shares, sorted(shares))

        def give_up(share):
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            spmesh.Delaunay(points, progress=give_up)
        # Where a test runs in the background, the shell makes it ignore the signal.
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            spmesh.Delaunay(points, threads=1)
            # The signal may come late on a machine that is busy, or fast.
            time.sleep(60)

    def test_other_threads_run_on(self):
        points = np.random.default_rng(8).random((300_000, 2))
        ticks = []
        done = threading.Event()

        def tick():
            while not done.wait(0.005):
                ticks.append(1)

        thread = threading.Thread(target=tick)
        thread.start()
        mesh = spmesh.Delaunay(points)
        mesh.find_simplex(points)
        done.set()
        thread.join()
        self.assertGreater(len(ticks), 5)


class Interpolators(unittest.TestCase):
    def test_linear_functions_are_reproduced(self):
        random = np.random.default_rng(9)
        for ndim in (2, 3):
            points, places = random.random((200, ndim)), random.random((500, ndim))
            slopes = random.random((ndim, 3))
            names = [spmesh.LinearNDInterpolator] + [spmesh.NaturalNeighborInterpolator] * (ndim == 2)
            for interpolator in names:
                found = interpolator(points, points @ slopes)(places)
                self.assertEqual(found.shape, (500, 3))
                inside = spmesh.Delaunay(points).find_simplex(places) >= 0
                np.testing.assert_array_equal(np.isnan(found).any(axis=1), ~inside)
                np.testing.assert_allclose(found[inside], (places @ slopes)[inside], rtol=1e-11)
                np.testing.assert_array_equal(interpolator(points, points @ slopes)(points), points @ slopes)

    def test_shapes_of_values_and_places(self):
        points = np.array([[0, 0], [4, 0], [0, 4], [4, 4]])
        plane = points[:, 0] + 2j * points[:, 1]
        for interpolator in (spmesh.LinearNDInterpolator, spmesh.NaturalNeighborInterpolator):
            f = interpolator(points, plane)
            self.assertAlmostEqual(complex(f(1, 2)), 1 + 4j)
            self.assertEqual(f(np.ones((3, 1)), np.ones(2)).shape, (3, 2))
            self.assertEqual(f((np.ones(3), np.ones(3))).shape, (3,))
            self.assertEqual(f(np.zeros((0, 2))).shape, (0,))
            self.assertEqual(interpolator(points, plane, fill_value=-1)([9, 9]), -1)
            self.assertAlmostEqual(complex(interpolator(points * [1, 1e6], plane, rescale=True)(1, 2e6)), 1 + 4j)
            self.assertEqual(interpolator(spmesh.Delaunay(points), points)(points).tolist(), points.tolist())
            self.assertEqual(interpolator((points[:, 0], points[:, 1]), np.ones((4, 2, 5)))([[1, 1]]).shape, (1, 2, 5))
            with self.assertRaisesRegex(ValueError, "values: one for each of 4"):
                interpolator(points, [1, 2, 3])
            with self.assertRaisesRegex(ValueError, "xi: 2 coordinates"):
                f([[1, 2, 3]])
        with self.assertRaisesRegex(ValueError, "2 columns"):
            spmesh.NaturalNeighborInterpolator(np.eye(3), [1, 2, 3])

    def test_a_triangulation_may_grow(self):
        points = np.array([[0, 0], [4, 0], [0, 4]])
        for interpolator in (spmesh.LinearNDInterpolator, spmesh.NaturalNeighborInterpolator):
            mesh = spmesh.Delaunay(points)
            f = interpolator(mesh, [0, 4, 8])
            mesh.add_points([[9, 9], [1, 1]])
            np.testing.assert_array_equal(np.isnan(f([[1, 1], [8, 8]])), [False, True])
            self.assertAlmostEqual(float(f(1, 1)), 3)
            with self.assertRaisesRegex(ValueError, "^values"):
                interpolator(mesh, [0, 4, 8])
            whole = interpolator(points, [0, 4j, 8], fill_value=2)
            np.testing.assert_array_equal(pickle.loads(pickle.dumps(whole))([[1, 1], [9, 9]]), whole([[1, 1], [9, 9]]))

    def test_places_without_simplices_get_the_fill_value(self):
        for interpolator in (spmesh.LinearNDInterpolator, spmesh.NaturalNeighborInterpolator):
            self.assertEqual(interpolator(np.zeros((0, 2)), [], fill_value=7)([[1, 1]]).tolist(), [7])
            for fill in (np.nan, 7):
                f = interpolator([[0, 0], [1, 1], [2, 2]], [0, 1, 2], fill_value=fill)
                np.testing.assert_array_equal(f([[1, 1], [0, 1], [np.nan, 0]]), [1, fill, fill])
            self.assertEqual(interpolator([[0, 0], [1, 0], [0, 1]], np.zeros((3, 0)))([[0, 0]]).shape, (1, 0))
            with self.assertRaisesRegex(ValueError, "^fill_value"):
                interpolator([[0, 0], [1, 0], [0, 1]], [1, 2, 3], fill_value="x")
            for bad in (np.ma.masked_all(3), np.zeros(3, "M8[s]"), ["a", "b", "c"]):
                with self.assertRaisesRegex(ValueError, "^values"):
                    interpolator([[0, 0], [1, 0], [0, 1]], bad)

    def test_scales_far_apart(self):
        scales = np.array([1e102, 3e-138, 2e-202])
        corners = np.concatenate([np.zeros((1, 3)), np.eye(3)]) * scales
        self.assertAlmostEqual(float(spmesh.LinearNDInterpolator(corners, [0, 1, 0, 0])(*([0.3, 0.2, 0.37] * scales))), 0.3)
        least = [[1e-323, 5e-324], [-1e-323, 1e-323], [-1e-323, -1e-323], [1e-323, -5e-324], [1e-323, 1.5e-323]]
        _, indices, weights = spmesh.NaturalNeighborInterpolator(least, range(5)).weights([[1e-323, 0]])
        self.assertEqual(dict(zip(indices.tolist(), weights.tolist())), {0: 0.5, 3: 0.5})

    def test_weights_of_natural_neighbours(self):
        points = np.random.default_rng(10).random((300, 2))
        f = spmesh.NaturalNeighborInterpolator(points, points)
        places = np.random.default_rng(11).random((200, 2))
        indptr, indices, weights = f.weights(places)
        self.assertEqual((indptr.dtype, indices.dtype, weights.dtype), (np.int64, np.int32, np.float64))
        for k, place in enumerate(places):
            of_place = slice(indptr[k], indptr[k + 1])
            if indptr[k] == indptr[k + 1]:
                self.assertEqual(f.tri.find_simplex(place), -1)
                continue
            self.assertAlmostEqual(weights[of_place].sum(), 1)
            np.testing.assert_allclose(weights[of_place] @ points[indices[of_place]], place, rtol=1e-11)


class BesideScipy(unittest.TestCase):
    def setUp(self):
        try:
            import scipy.interpolate
            import scipy.spatial
        except ImportError:
            self.skipTest("scipy is not installed")
        self.spatial, self.interpolate = scipy.spatial, scipy.interpolate

    def test_the_same_where_there_are_no_ties(self):
        random = np.random.default_rng(12)
        for ndim in (2, 3):
            points, places = random.random((2000, ndim)), random.random((3000, ndim))
            values = random.random(2000)
            ours, theirs = spmesh.Delaunay(points), self.spatial.Delaunay(points)
            as_set = [np.unique(np.sort(mesh.simplices, axis=1), axis=0) for mesh in (ours, theirs)]
            np.testing.assert_array_equal(*as_set)
            found = [np.sort(mesh.simplices[mesh.find_simplex(places)], axis=1) for mesh in (ours, theirs)]
            inside = theirs.find_simplex(places) >= 0
            np.testing.assert_array_equal(found[0][inside], found[1][inside])
            linear = spmesh.LinearNDInterpolator(points, values)(places)
            np.testing.assert_allclose(linear, self.interpolate.LinearNDInterpolator(points, values)(places), rtol=0, atol=1e-12)

    def test_scipy_takes_our_triangulation(self):
        points = np.random.default_rng(13).random((500, 2))
        values = np.sin(points.sum(axis=1))
        places = np.random.default_rng(14).random((300, 2))
        mine = self.interpolate.CloughTocher2DInterpolator(spmesh.Delaunay(points).to_scipy(), values)(places)
        np.testing.assert_allclose(mine, self.interpolate.CloughTocher2DInterpolator(points, values)(places), atol=1e-5)


if __name__ == "__main__":
    unittest.main()
