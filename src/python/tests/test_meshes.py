"""Meshes of arrays: what is written, in what order, and what is refused."""

import io
import itertools
import math
import unittest
from fractions import Fraction

import numpy as np

import spmesh
from spmesh.orientation import orientations
from support import cloud


def sign(points, simplex):
    """The orientation of a simplex by Leibniz' formula with fractions."""
    first, *others = ([Fraction(x) for x in points[corner].tolist()] for corner in simplex)
    rows = [[x - y for x, y in zip(other, first)] for other in others]
    total = Fraction(0)
    for order in itertools.permutations(range(len(rows))):
        inversions = sum(a > b for a, b in itertools.combinations(order, 2))
        total += (-1) ** inversions * math.prod(row[place] for row, place in zip(rows, order))
    return (total > 0) - (total < 0)


def grid(side):
    """Points of a grid in random places of a list, and two counterclockwise triangles for each square."""
    order = np.random.default_rng(side).permutation(side * side)
    y, x = np.divmod(np.arange(side * side), side)
    points = np.empty((side * side, 3))
    points[order] = np.column_stack([x, y, x * y])
    a = np.flatnonzero((x < side - 1) & (y < side - 1))
    corners = np.concatenate([np.column_stack([a, a + 1, a + 1 + side]), np.column_stack([a, a + 1 + side, a + side])])
    return points, order[corners]


def written(write, *arguments, **more):
    file = io.BytesIO()
    write(file, *arguments, **more)
    return spmesh.read(io.BytesIO(file.getvalue()))


class Orientations(unittest.TestCase):
    def test_signs_are_those_of_fractions(self):
        random = np.random.default_rng(1)
        for dims in (2, 3):
            places = [
                random.uniform(-1, 1, (200, dims)),
                random.integers(0, 3, (200, dims)).astype(float),
                random.integers(0, 4, (200, dims)) * 0.1 + 1e6,
                random.integers(-3, 4, (200, dims)) * 5e-324,
                random.integers(-3, 4, (200, dims)) * 5e307,
                random.uniform(-1, 1, (200, dims)) * 10.0 ** random.integers(-300, 300, (200, 1)),
                0.5 + random.integers(0, 9, (200, 1)) * 2.0**-53 + random.integers(0, 2, (200, dims)) * 2.0**-52,
            ]
            for points in places:
                simplices = random.integers(0, 200, (300, dims + 1))
                expected = [sign(points, simplex) for simplex in simplices]
                self.assertEqual(orientations(points, simplices).tolist(), expected)


class Meshes(unittest.TestCase):
    def test_triangles_are_written_once_and_read_with_their_attributes(self):
        for side in (2, 3, 60, 130):
            points, triangles = grid(side)
            for scale in (None, 0.5):
                number = np.arange(len(points))
                mesh = written(spmesh.write_triangles, points, triangles, {"number": number}, scale=scale)
                back = np.asarray(mesh.attribute("number"))
                np.testing.assert_array_equal(mesh.xyz, points[back])
                np.testing.assert_array_equal(back[mesh.simplices], triangles)
                np.testing.assert_array_equal(np.sort(back), number)
                self.assertEqual(mesh.header.bounds, (*points.min(axis=0), *points.max(axis=0)))

    def test_few_vertices_are_live_if_triangles_are_in_order(self):
        points, triangles = grid(200)
        file = io.BytesIO()
        order = np.argsort(points[triangles[:, 0], 1], kind="stable")
        spmesh.write_triangles(file, points, triangles[order])
        reader, most = spmesh.open(io.BytesIO(file.getvalue())), 0
        for block in reader:
            most = max(most, len(reader._live.live))
        self.assertLess(most, 2 * 200 + 2)

    def test_tetrahedra_are_turned_or_refused(self):
        points = cloud(40)
        corners = np.array([[0, 1, 2, 3], [4, 5, 6, 7]])
        signs = orientations(points, corners)
        corners[signs < 0] = corners[signs < 0][:, [1, 0, 2, 3]]
        for write in (spmesh.write_tetrahedra, spmesh.write_triangles):
            mesh = written(write, points, corners)
            self.assertEqual((mesh.header.kind, len(mesh.xyz)), ("tetrahedral mesh", 40))
            np.testing.assert_array_equal(mesh.xyz[mesh.simplices], points[corners])
        with self.assertRaisesRegex(ValueError, "tetrahedron 1 is negatively oriented: orient=True"):
            written(spmesh.write_tetrahedra, points, [corners[0], corners[1][[1, 0, 2, 3]]])
        turned = written(spmesh.write_tetrahedra, points, corners[:, [1, 0, 2, 3]], orient=True)
        np.testing.assert_array_equal(turned.xyz[turned.simplices], points[corners])

    def test_clockwise_and_flat_triangles_are_named(self):
        points, triangles = grid(100)
        triangles[5000] = triangles[5000, ::-1]
        with self.assertRaisesRegex(ValueError, "triangle 5000 is clockwise"):
            written(spmesh.write_triangles, points, triangles)
        mesh = written(spmesh.write_triangles, points, triangles, orient=True)
        self.assertTrue((orientations(mesh.xyz[:, :2], mesh.simplices) > 0).all())
        triangles[7000] = triangles[6999, [0, 1, 1]]
        with self.assertRaisesRegex(ValueError, "triangle 7000 uses a vertex twice"):
            written(spmesh.write_triangles, points, triangles, orient=True)
        with self.assertRaisesRegex(ValueError, "triangle 0 is flat"):
            written(spmesh.write_triangles, [[0, 0], [1, 1], [2, 2]], [[0, 1, 2]], orient=True)
        # Flat only after it is rounded.
        thin = [[0, 0], [1, 1], [2, 2.0001]]
        self.assertEqual(len(written(spmesh.write_triangles, thin, [[0, 1, 2]]).simplices), 1)
        with self.assertRaisesRegex(ValueError, "triangle 0 is flat"):
            written(spmesh.write_triangles, thin, [[0, 1, 2]], scale=0.01)

    def test_numbers_of_vertices_stay_integers(self):
        mesh = written(spmesh.write_triangles, *grid(3))
        self.assertEqual(mesh.simplices.dtype, np.int32)
        for other in (np.arange(3), np.uint32(1), 1):
            self.assertIn((mesh.simplices + other).dtype.kind, "iu")
        patch = next(iter(spmesh.open(io.BytesIO(self.stream()))))
        self.assertEqual((patch.simplices_by_id - np.arange(3)).dtype, np.int64)

    @staticmethod
    def stream():
        file = io.BytesIO()
        spmesh.write_triangles(file, *grid(3))
        return file.getvalue()

    def test_bounds_are_those_of_the_world(self):
        points = np.array([[500000.0, 4e6, 12.25], [500010.0, 4e6 + 7, 90.5]])
        for scale, offset in ((None, 0), (0.25, (500000, 4000000, 0))):
            header = written(spmesh.write_points, points, scale=scale, offset=offset).header
            self.assertEqual(header.bounds, (500000, 4e6, 12.25, 500010, 4e6 + 7, 90.5))
        self.assertEqual(header.stored_bounds, (0, 0, 49, 40, 28, 362))
        self.assertEqual(written(spmesh.write_points, points[:, :2]).header.bounds[2::3], (0, 0))

    def test_arguments_that_do_not_fit_are_named(self):
        points, triangles = grid(3)
        frame = type("DataFrame", (), {"__array__": lambda *_, **__: np.array([["a", 1, 2]], object)})()
        refused = (
            (dict(xyz=np.arange(9)), r"xyz has the shape \(9,\)"),
            (dict(xyz=points[:, :1]), "xyz has the shape"),
            (dict(xyz=frame), "xyz has the type object"),
            (dict(xyz=points.astype(str)), "xyz has the type"),
            (dict(xyz=points.astype(complex)), "xyz has the type complex128"),
            (dict(xyz=np.ma.masked_equal(points, 4)), "xyz is a masked array"),
            (dict(xyz=points.astype(int) + 2**60), "xyz has integers beyond 2.53"),
            (dict(xyz=np.where(points == 4, np.nan, points)), "xyz has a coordinate that is not finite, in row"),
            (dict(triangles=triangles.ravel()), r"triangles has the shape \(24,\)"),
            (dict(triangles=triangles[:, :2]), "triangles has the shape"),
            (dict(triangles=triangles + 0.5), "triangles has an index that is no whole number"),
            (dict(triangles=triangles > 0), "triangles has the type bool"),
            (dict(triangles=triangles + 1), "triangles uses a vertex beyond the 9 given"),
            (dict(triangles=triangles - 1), "triangles uses a vertex beyond"),
            (dict(attributes={"a": np.arange(8)}), "attribute 'a' has 8 values, expected 9"),
            (dict(attributes=[1, 2]), "attributes is a list"),
            (dict(scale="fine"), "scale is 'fine'"),
            (dict(scale=[1, 2, 3, 4]), "scale has the shape"),
            (dict(scale=-1), "scale is not positive"),
        )
        for arguments, words in refused:
            with self.subTest(words), self.assertRaisesRegex(ValueError, words):
                written(spmesh.write_triangles, **{"xyz": points, "triangles": triangles, **arguments})

    def test_long_rows_fit_into_blocks(self):
        points, triangles = grid(40)
        values = np.arange(1600 * 128.0).reshape(1600, 128)
        mesh = written(spmesh.write_triangles, points, triangles[::7], {"values": values})
        np.testing.assert_array_equal(mesh.xyz[:, 2], points[(np.asarray(mesh.rows["values"])[:, 0] / 128).astype(int), 2])


if __name__ == "__main__":
    unittest.main()
