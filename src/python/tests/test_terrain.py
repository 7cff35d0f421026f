"""TINs and splines by the programs, compared with scipy, with fractions of a plane, and with polynomials."""

import gc
import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

import spmesh
from support import DATA, cloud

try:
    import scipy.interpolate
    import scipy.spatial
except ImportError:
    scipy = None


def hill(count=3000, seed=2):
    """Points of a smooth hill, on a grid of 2^-10."""
    x, y = np.round(np.random.default_rng(seed).uniform(0, 64, (2, count)) * 1024) / 1024
    return np.column_stack([x, y, np.round((x * y / 32 + y) * 1024) / 1024])


def plane(xy):
    return 0.5 * xy[..., 0] - 0.25 * xy[..., 1] + 100


class Tins(unittest.TestCase):
    def test_triangles_are_those_of_qhull(self):
        if scipy is None:
            self.skipTest("scipy is not installed")
        xyz = hill()
        with spmesh.tin(xyz, attributes={"number": np.arange(len(xyz))}) as tin:
            mesh = tin.read()
        number = np.asarray(mesh.attribute("number"))
        np.testing.assert_array_equal(mesh.xyz, xyz[number])
        expected = scipy.spatial.Delaunay(xyz[:, :2]).simplices
        self.assertEqual(set(map(frozenset, number[mesh.simplices].tolist())), set(map(frozenset, expected.tolist())))

    def test_few_and_degenerate_points_are_ordinary(self):
        square = np.array([[0, 0, 1], [1, 0, 2], [1, 1, 3], [0, 1, 4]], float)
        line = np.column_stack([np.arange(6.0)] * 3)
        grid = np.stack(np.meshgrid(np.arange(9.0), np.arange(9.0), 5.0), -1).reshape(-1, 3)
        cases = ((square[:0], 0), (square[:1], 0), (square[:2], 0), (square[:3], 1), (square, 2), (line, 0), (grid, 128))
        for points, triangles in cases:
            for factor in (1, 2.0**-60, 2.0**60):
                with spmesh.tin(np.repeat(points, 2, axis=0) * factor) as tin:
                    self.assertEqual(len(tin.read().simplices), triangles)
                    tin.audit()

    def test_cells_have_the_elevations_of_their_centres(self):
        if scipy is None:
            self.skipTest("scipy is not installed")
        xyz = hill()
        with spmesh.tin(xyz) as tin:
            mesh, raster = tin.read(), tin.dem(step=0.5)
            coarse = tin.dem(columns=16, bounds=(8, 8, 40, 24), sample="mean")
        rows, columns = raster.array.shape
        a, b, left, d, e, top = raster.transform
        self.assertEqual((a, b, d, e), (0.5, 0, 0, -0.5))
        x, y = left + a * (np.arange(columns) + 0.5), top + e * (np.arange(rows) + 0.5)
        expected = scipy.interpolate.LinearNDInterpolator(scipy.spatial.Delaunay(mesh.xyz[:, :2]), mesh.xyz[:, 2])(*np.meshgrid(x, y))
        np.testing.assert_allclose(raster.array, expected, rtol=1e-6)
        self.assertEqual(raster.bounds, (left, top + e * rows, left + a * columns, top))
        self.assertEqual((coarse.array.shape, coarse.bounds), ((8, 16), (8, 8, 40, 24)))

    def test_slopes_and_hillshades_are_rasters_too(self):
        xyz = cloud(500)
        xyz[:, 2] = plane(xyz)
        with spmesh.tin(xyz) as tin:
            slopes, shades = tin.dem(step=20, kind="slope").array, tin.dem(step=20, kind="hillshade").array
            np.testing.assert_allclose(slopes[np.isfinite(slopes)], np.degrees(np.arctan(np.hypot(0.5, 0.25))), rtol=1e-4)
            inner = shades[np.isfinite(shades)]
            self.assertTrue(len(inner) and len(np.unique(inner)) == 1 and np.isnan(shades[0, 0]))
            with self.assertRaisesRegex(ValueError, "no array"):
                tin.dem(kind="shaded-relief")

    def test_contour_lines_are_level(self):
        xyz = hill()
        xyz[:, 2] = plane(xyz)
        with spmesh.tin(xyz) as tin:
            lines = tin.contours(2)
            self.assertEqual(tin.contours(1000), [])
        self.assertEqual({elevation for elevation, _ in lines}, set(range(86, 132, 2)))
        for elevation, line in lines:
            np.testing.assert_allclose(plane(line), elevation, atol=0.01)

    def test_heights_are_those_above_the_surface(self):
        if scipy is None:
            self.skipTest("scipy is not installed")
        # On the grid of the mesh, so that no site is moved across its border.
        sites = np.round(np.random.default_rng(5).uniform(-4, 68, (2000, 3)) * 1024) / 1024
        for scale in (None, (2.0**-10,) * 3):
            with spmesh.tin(hill(), scale=scale) as tin:
                mesh = tin.read()
                ground = scipy.interpolate.LinearNDInterpolator(scipy.spatial.Delaunay(mesh.xyz[:, :2]), mesh.xyz[:, 2])(sites[:, :2])
                # A height is rounded to the step of z.
                error = 2**-11 * 1.001 if scale else 1e-6
                np.testing.assert_allclose(tin.heights(sites), sites[:, 2] - ground, atol=error)
                np.testing.assert_allclose(tin.heights(sites[:, :2]), ground, atol=error)
                self.assertFalse(np.isnan(tin.heights(sites, outside="nearest")).any())
                self.assertEqual(len(tin.heights(sites[:0])), 0)
                with self.assertRaisesRegex(ValueError, "xyz has a coordinate that is not finite"):
                    tin.heights([[0, 0, np.nan]])

    def test_files_are_read_with_their_classes_and_their_system(self):
        with spmesh.tin(DATA / "point10.laz") as ground, spmesh.tin([DATA / "point10.laz"], keep_class=None) as all_points:
            self.assertLess(0, len(ground.read().xyz))
            self.assertLess(len(ground.read().xyz), len(all_points.read().xyz))
        box = spmesh.tin(DATA / "lareunion.laz", keep_class=None).header.bounds
        half = (*box[:2], (box[0] + box[3]) / 2, box[4])
        with spmesh.tin(DATA / "lareunion.laz", None, "EPSG:2975", half, "64M", first_only=True) as part:
            self.assertIn("UTM zone 40S", part.crs)
            self.assertLessEqual(part.header.bounds[3], half[2])

    def test_names_that_look_like_flags_are_files(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "-points.txt").write_text("0 0 1\n4 0 1\n0 4 1\n")
            here = os.getcwd()
            os.chdir(folder)
            try:
                with spmesh.tin("-points.txt", output="-mesh.spm") as tin:
                    self.assertEqual(len(tin.read().simplices), 1)
                    self.assertEqual(tin.dem(step=1).array[-1, 0], 1)
                    self.assertEqual(len(tin.heights([[1, 1, 3]])), 1)
                    tin.audit()
                self.assertTrue(Path("-mesh.spm").exists())
            finally:
                os.chdir(here)

    def test_temporary_files_go_with_their_owner(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(tempfile, "tempdir", folder):
            tin = spmesh.tin(hill(50))
            path = tin.path
            self.assertTrue(path.exists())
            del tin
            gc.collect()
            with self.assertRaises(spmesh.ProgramError) as caught:
                spmesh.tin("missing.laz")
            self.assertEqual((caught.exception.program, caught.exception.code), ("spfinalize", 1))
            self.assertIn("missing.laz", str(caught.exception))
            with self.assertRaisesRegex(ValueError, "files has the shape"):
                spmesh.tin(np.zeros((5, 2)))
            with self.assertRaisesRegex(ValueError, "not finite, in row 1"):
                spmesh.tin([[0, 0, 0], [0, np.nan, 0]])
            self.assertEqual(os.listdir(folder), [])

    def test_a_mesh_that_is_not_delaunay_fails_the_audit(self):
        corners = np.array([[0, 0, 0], [10, 0, 0], [10, 1, 0], [0, 1.5, 0]])
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "mesh.spm")
            for triangles, is_wrong in (([[0, 1, 2], [0, 2, 3]], False), ([[0, 1, 3], [1, 2, 3]], True)):
                spmesh.write_triangles(path, corners, triangles)
                try:
                    spmesh.Tin(path).audit()
                    passed = True
                except spmesh.ProgramError as error:
                    passed = False
                    self.assertEqual(error.code, 4)
                self.assertEqual(passed, not is_wrong)

    def test_rasters_are_data_arrays(self):
        try:
            import xarray  # noqa: F401
        except ImportError:
            self.skipTest("xarray is not installed")
        with spmesh.tin(hill(), crs="EPSG:2154") as tin:
            raster = tin.dem(step=4)
        data = raster.to_xarray()
        self.assertEqual(data.dims, ("y", "x"))
        self.assertEqual((float(data.x[0]), float(data.y[0])), (2, 62))
        self.assertIn("Lambert-93", data.attrs["crs"])


class Splines(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        x, y = np.random.default_rng(3).uniform(0, 10, (2, 800))
        cls.surface = spmesh.fit(np.column_stack([x, y, x * x - 2 * x * y + 3 * y + 1]), step=2.0, lambda_=1e-10)

    def test_quadratic_surfaces_are_reproduced(self):
        x, y = np.random.default_rng(4).uniform(1, 9, (2, 100))
        sites = np.column_stack([x, y])
        np.testing.assert_allclose(self.surface.evaluate(sites), x * x - 2 * x * y + 3 * y + 1, atol=1e-6)
        gradient = np.column_stack([2 * x - 2 * y, 3 - 2 * x])
        np.testing.assert_allclose(self.surface.evaluate(sites, derivative=1), gradient, atol=1e-5)
        np.testing.assert_allclose(self.surface.evaluate(sites, derivative=2), [[2, -2, 0]] * 100, atol=1e-4)
        slopes = np.degrees(np.arctan(np.hypot(*gradient.T)))
        np.testing.assert_allclose(self.surface.evaluate(sites, derivative="slope"), slopes, atol=1e-4)
        cells = self.surface.dem(step=0.5, bounds=(4, 4, 6, 6))
        self.assertEqual(cells.array.shape, (4, 4))
        self.assertAlmostEqual(float(cells.array[0, 0]), 4.25**2 - 2 * 4.25 * 5.75 + 3 * 5.75 + 1, 4)

    def test_sites_outside_and_none_at_all(self):
        self.assertTrue(np.isnan(self.surface.evaluate([[1e6, 0]])).all())
        for derivative, shape in ((None, (0,)), (1, (0, 2)), (2, (0, 3))):
            self.assertEqual(self.surface.evaluate(np.empty((0, 2)), derivative).shape, shape)
        with self.assertRaisesRegex(ValueError, "xy has the shape"):
            self.surface.evaluate([1, 2])
        with self.assertRaisesRegex(ValueError, "in row 1"):
            self.surface.evaluate([[1, 2], [np.inf, 0]])
        with self.assertRaisesRegex(ValueError, "derivative is 3"):
            self.surface.evaluate([[1, 2]], 3)

    def test_weights_decide(self):
        x, y = np.random.default_rng(6).uniform(0, 10, (2, 600))
        z = np.where(np.arange(600) < 300, 0.0, 5.0)
        surface = spmesh.fit(np.column_stack([x, y, z]), weights=np.where(z == 0, 1.0, 1e-9), step=5.0)
        np.testing.assert_allclose(surface.evaluate([[5, 5], [3, 6]]), 0, atol=1e-3)

    def test_failures_have_the_message_of_the_program(self):
        with self.assertRaises(spmesh.ProgramError) as caught:
            spmesh.fit(cloud(50), lambda_="strong")
        self.assertEqual(caught.exception.code, 2)
        self.assertIn("strong", caught.exception.message)


if __name__ == "__main__":
    unittest.main()
