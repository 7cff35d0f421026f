"""Tests of the package: python -m unittest discover -s tests. SPMESH_BIN names the folder of the programs."""

import dataclasses
import io
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

import spmesh
from spmesh.compression import decompress, decompressor
from support import BIN, ROOT, VECTORS, cloud, run

def written(header, *steps):
    """The bytes of a stream that `steps` write."""
    file = io.BytesIO()
    with spmesh.Writer(file, header) as writer:
        for step in steps:
            step(writer)
    return file.getvalue()


def copied(data):
    """The same stream, written again block by block."""
    file = io.BytesIO()
    reader = spmesh.open(io.BytesIO(data))
    writer = spmesh.Writer(file, dataclasses.replace(reader.header, compressed=False))
    for block in reader:
        rows = getattr(block, "rows", None)
        if isinstance(block, spmesh.Points):
            writer.points(block.xyz, rows, stored=True)
        elif isinstance(block, spmesh.Cells):
            writer.cells(block.codes)
        elif isinstance(block, spmesh.Region):
            writer.region(block)
        elif isinstance(block, spmesh.Patch):
            parts = block.new, block.imported, block.simplices, block.finalized
            shared = dict(origins=block.origins, kept=block.kept)
            writer.patch(*parts, rows, stored=True, sides=block.sides, **shared)
        elif isinstance(block, spmesh.Segments):
            writer.segments(block.lines, block.ends, stored=True)
        elif isinstance(block, spmesh.OpenSegments):
            writer.open_segments(block.numbers)
        elif isinstance(block, spmesh.Labels):
            writer.labels(block.labels)
        elif isinstance(block, spmesh.ResidualPoints):
            writer.residual_points(block.ids, block.xyz, rows, stored=True)
        elif isinstance(block, spmesh.Walls):
            writer.walls(block.corners)
        elif isinstance(block, spmesh.Points4):
            writer.points4(block.xyzt, block.values)
        elif isinstance(block, spmesh.Cells4):
            writer.cells4(block.infinite, block.vertices, block.neighbours)
        elif isinstance(block, spmesh.Simplices4):
            writer.simplices4(block.corners)
        elif isinstance(block, spmesh.Configurations):
            writer.configurations(block.degree, block.standing, block.interiors, block.counts, block.boundaries)
        elif isinstance(block, spmesh.Functions):
            writer.functions(block.functions)
        elif isinstance(block, spmesh.Coefficients):
            writer.coefficients(block.values)
        else:
            writer.end(block.totals["merged"], block.totals["points"])
    return file.getvalue()


class Vectors(unittest.TestCase):
    def vectors(self):
        return json.loads((VECTORS / "manifest.json").read_text())["vectors"]

    def test_every_vector_is_read_or_refused(self):
        kinds = {"malformed": spmesh.MalformedError, "too new": spmesh.TooNewError}
        for vector in self.vectors():
            path = VECTORS / vector["file"]
            with self.subTest(vector["name"]):
                if vector["class"] == "well-formed":
                    spmesh.read(path)
                    continue
                with self.assertRaises(kinds[vector["class"]]) as caught:
                    spmesh.read(path)
                if vector["block"] is not None:
                    self.assertIn(f"block {vector['block']} at byte {vector['byte']}", str(caught.exception))

    def test_every_kind_is_written_as_it_was_read(self):
        for vector in self.vectors():
            if vector["class"] == "well-formed":
                with self.subTest(vector["name"]):
                    again = run("spconvert", "--to", "text", data=copied((VECTORS / vector["file"]).read_bytes()))
                    twin = run("spconvert", "--to", "text", data=(VECTORS / vector["file"]).read_bytes())
                    self.assertEqual(again, twin)

    def test_meshes_in_parts_are_joined_or_refused(self):
        for path in sorted((VECTORS / "joined").glob("*.json")):
            with self.subTest(path.stem):
                if path.with_suffix(".txt").exists():
                    mesh, whole = spmesh.read(path), spmesh.read(io.BytesIO(run("spconvert", "--to", "spm", path)))
                    self.assertEqual(mesh.totals, whole.totals)
                    self.assertEqual(mesh.header, whole.header)
                    for ours, theirs in ((mesh.stored, whole.stored), (mesh.simplices, whole.simplices)):
                        np.testing.assert_array_equal(ours, theirs)
                    if mesh.header.attributes:
                        np.testing.assert_array_equal(mesh.rows, whole.rows)
                    continue
                code = int(path.with_suffix(".err").read_text().split()[-1])
                with self.assertRaises(spmesh.TooNewError if code == 6 else spmesh.MalformedError):
                    spmesh.read(path)

    def test_cut_and_changed_streams_are_refused(self):
        for name in ("pass/mesh-two-patches.spm", "pass/attributes-partial.spm", "pass/points-tagged.spm"):
            data = (VECTORS / name).read_bytes()
            for length in range(len(data)):
                with self.assertRaises(spmesh.SpmeshError):
                    spmesh.read(io.BytesIO(data[:length]))
            for at in range(len(data)):
                changed = data[:at] + bytes([data[at] ^ 16]) + data[at + 1 :]
                with self.assertRaises(spmesh.SpmeshError):
                    spmesh.read(io.BytesIO(changed))


class Programs(unittest.TestCase):
    """Streams of programs are read, and programs read what is written."""

    def test_points_of_numpy_go_through_the_pipe(self):
        xyz = cloud()
        columns = {"intensity": np.arange(5000, dtype="u2"), "rgb": np.arange(15000, dtype="u2").reshape(-1, 3)}
        file = io.BytesIO()
        spmesh.write_points(file, xyz, columns, scale=0.001, wkt='LOCAL_CS["test"]')
        points = run("spfinalize", "--attributes", "all", "--cell-points", "500", "-", data=file.getvalue())
        mesh = spmesh.read(io.BytesIO(run("spdelaunay2d", "--compress", data=points)))
        self.assertEqual(mesh.header.wkt, 'LOCAL_CS["test"]')
        order = np.asarray(mesh.attribute("intensity"), int)
        np.testing.assert_allclose(mesh.xyz, xyz[order], atol=0.00051)
        np.testing.assert_array_equal(mesh.rows["rgb"], columns["rgb"][order])
        x, y = mesh.xyz[mesh.simplices].transpose(2, 1, 0)[:2]
        doubled = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
        self.assertTrue((doubled > 0).all())
        self.assertGreater(doubled.sum() / 2, 0.97e6)

    def test_meshes_of_numpy_pass_the_audit(self):
        xyz = cloud()
        points = io.BytesIO()
        spmesh.write_points(points, xyz)
        mesh = spmesh.read(io.BytesIO(run("spdelaunay2d", data=run("spfinalize", "-", data=points.getvalue()))))
        file = io.BytesIO()
        spmesh.write_triangles(file, mesh.xyz, mesh.simplices[::-1], {"number": np.arange(5000)})
        self.assertIn(b"audit passed", run("spinfo", "--audit", "-", data=file.getvalue()))
        again = spmesh.read(io.BytesIO(file.getvalue()))
        number = np.asarray(again.rows["number"])
        self.assertEqual(set(map(tuple, number[again.simplices].tolist())), set(map(tuple, mesh.simplices.tolist())))

    def test_tetrahedra_and_tags_are_read(self):
        points = io.BytesIO()
        spmesh.write_points(points, cloud(3000), scale=0.01, dims=3)
        tagged = run("spfinalize", "--octree", "--preserve", "--cell-points", "200", "-", data=points.getvalue())
        self.assertEqual(len(spmesh.read(io.BytesIO(tagged)).stored), 3000)
        mesh = spmesh.read(io.BytesIO(run("spdelaunay3d", "--compress", data=tagged)))
        self.assertEqual(mesh.simplices.shape[1], 4)

    def test_compressed_streams_are_the_plain_ones(self):
        for kind in ([], ["--octree"]):
            points = io.BytesIO()
            spmesh.write_points(points, cloud(4000), {"t": np.arange(4000.0)}, scale=0.001, dims=3 if kind else 2)
            plain = run("spfinalize", "--attributes", "t", *kind, "-", data=points.getvalue())
            packed = run("spfinalize", "--compress", "--attributes", "t", *kind, "-", data=points.getvalue())
            self.assertLess(len(packed), len(plain))
            one, other = spmesh.read(io.BytesIO(plain)), spmesh.read(io.BytesIO(packed))
            np.testing.assert_array_equal(one.stored, other.stored)
            np.testing.assert_array_equal(one.rows, other.rows)

    def test_the_compiled_module_decompresses_as_python_does(self):
        try:
            from spmesh import _native  # noqa: F401
        except ImportError:
            self.skipTest("the compiled module is not there")
        points = io.BytesIO()
        spmesh.write_points(points, cloud(3000), {"t": np.arange(3000.0)}, scale=0.001, dims=2)
        tagged = run("spfinalize", "--compress", "--attributes", "t", "-", data=points.getvalue())
        for packed in (tagged, run("spdelaunay2d", "--compress", data=tagged)):
            compiled = spmesh.read(io.BytesIO(packed))
            with mock.patch("spmesh.reader.decompressor", lambda: decompress):
                plain = spmesh.read(io.BytesIO(packed))
            for name in ("stored", "simplices", "rows"):
                np.testing.assert_array_equal(getattr(compiled, name), getattr(plain, name))
        for damaged in (b"", bytes([9]), bytes(40), b"\x02" + bytes(60), b"\x03" + bytes(60)):
            for decompressing in (decompress, decompressor()):
                self.assertRaises(spmesh.MalformedError, decompressing, damaged)


class Writers(unittest.TestCase):
    def test_meshes_say_where_they_are(self):
        with tempfile.TemporaryDirectory() as folder:
            path, raster = Path(folder, "a.spm"), Path(folder, "a.asc")
            for scale in (None, 0.001):
                spmesh.write_triangles(path, [[0, 0, 1], [9, 0, 2], [0, 9, 3]], [[0, 1, 2]], scale=scale)
                run("spdem", "--step", 1, path, "-o", raster)
                self.assertIn("ncols 9", " ".join(raster.read_text().split()))
            self.assertEqual((spmesh.read(path).simplices + np.arange(3)).dtype, np.int64)

    def test_a_program_that_failed_is_named(self):
        command = f"{BIN / 'spfinalize'} -q missing.laz | {BIN / 'spdelaunay2d'} -q"
        with subprocess.Popen(command, shell=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as pipe:
            with self.assertRaisesRegex(spmesh.UpstreamError, "exit code 1"):
                spmesh.read(pipe.stdout)

    def test_an_exception_leaves_no_end(self):
        file = io.BytesIO()
        with self.assertRaises(RuntimeError):
            with spmesh.Writer(file, spmesh.Header()) as writer:
                writer.points([[0.0, 1.0]])
                raise RuntimeError("the producer failed")
        with self.assertRaises(spmesh.MalformedError):
            spmesh.read(io.BytesIO(file.getvalue()))

    def test_files_get_their_names_when_they_are_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            path, link = Path(folder, "a.spm"), Path(folder, "link")
            link.symlink_to("a.spm")
            spmesh.write_points(link, cloud(100))
            path.chmod(0o640)
            whole = path.read_bytes()

            def fail():
                with spmesh.Writer(path, spmesh.Header()) as writer:
                    writer.points([[0.0, 1.0]])
                    raise RuntimeError("the producer failed")

            def forget():
                spmesh.Writer(path, spmesh.Header()).points([[0.0, 1.0]])

            self.assertRaises(RuntimeError, fail)
            forget()
            self.assertEqual((sorted(os.listdir(folder)), path.read_bytes()), (["a.spm", "link"], whole))
            spmesh.write_points(link, cloud(5))
            self.assertEqual((len(spmesh.read(path).xyz), path.stat().st_mode & 0o777), (5, 0o640))
            self.assertTrue(link.is_symlink())

    def test_what_breaks_a_rule_is_refused(self):
        grid = dict(scale=(1.0,) * 3, offset=(0.0,) * 3)
        for header, step in (
            (spmesh.Header(), lambda w: w.points([[0.0, np.nan]])),
            (spmesh.Header(), lambda w: w.points([[0.0, 1.0, 2.0]])),
            (spmesh.Header(**grid), lambda w: w.points([[0.0, 3e9]])),
            (spmesh.Header(), lambda w: w.points([[0.0, 1.0]], {"a": [1]})),
            (spmesh.Header("triangle mesh"), lambda w: w.patch([[0, 0]], [], [[0, 1, 2]], [0])),
            (spmesh.Header("triangle mesh"), lambda w: w.patch([[0, 0]], [], [], [])),
            (spmesh.Header("triangle mesh"), lambda w: w.points([[0.0, 1.0]])),
        ):
            with self.assertRaises(ValueError):
                written(header, step)

    def test_unknown_values_are_masked(self):
        attribute = spmesh.Attribute("angle", "i2", scale=(0.5, 1.0), unknown=(-1).to_bytes(2, "little", signed=True))
        header = spmesh.Header(attributes=[attribute])
        data = written(header, lambda w: w.points(np.zeros((3, 2)), {"angle": [4, -1, 0]}))
        values = spmesh.read(io.BytesIO(data)).attribute("angle")
        self.assertEqual(values.tolist(), [3.0, None, 1.0])

    def test_masked_values_and_integers_survive(self):
        columns = {
            "class": np.ma.masked_equal(np.array([2, 255, 0, 6], np.uint8), 6),
            "time": np.ma.masked_array([1.5, 2.5, 3.5, 4.5], [0, 1, 0, 0]),
            "id": np.array([2**64 - 1, 2**53 + 1, 0, 1], np.uint64),
            "angles": np.ma.masked_array(np.arange(8, dtype=np.int16).reshape(4, 2), [[1, 0]] + [[0, 0]] * 3),
        }
        file = io.BytesIO()
        spmesh.write_points(file, cloud(4), columns)
        read = spmesh.read(io.BytesIO(file.getvalue()))
        for name, column in columns.items():
            found = read.attribute(name)
            self.assertEqual(found.dtype, column.dtype)
            np.testing.assert_array_equal(np.ma.getmaskarray(found), np.ma.getmaskarray(column))
            np.testing.assert_array_equal(found.compressed(), np.ma.compressed(column))
        again = io.BytesIO()
        spmesh.write_points(again, read.xyz, {name: read.attribute(name) for name in columns})
        self.assertEqual(spmesh.read(io.BytesIO(again.getvalue())).rows.tobytes(), read.rows.tobytes())
        full = np.ma.masked_array(np.arange(256, dtype=np.uint8), [1] + [0] * 255)
        spmesh.write_points(io.BytesIO(), cloud(256), {"a": full})
        full = np.ma.masked_array(np.arange(257) % 256, [0] * 256 + [1]).astype(np.uint8)
        with self.assertRaisesRegex(ValueError, "no number of its type is free"):
            spmesh.write_points(io.BytesIO(), cloud(257), {"a": full})
        spmesh.write_points(io.BytesIO(), read.xyz, read.rows)

    def test_arrays_that_do_not_fit_are_refused(self):
        corners = np.eye(3)
        for triangles, words in (([[0, 1, 1]], "twice"), ([[0, 1, 2.5]], "whole number"), ([[0, 1, 3]], "beyond")):
            with self.assertRaisesRegex(ValueError, words):
                spmesh.write_triangles(io.BytesIO(), corners, triangles)
        for column, words in ((np.zeros(3, np.float16), "float16"), (np.array(list("abc")), "type"), (np.zeros((3, 1, 1)), "shape")):
            with self.assertRaisesRegex(ValueError, words):
                spmesh.write_points(io.BytesIO(), corners, {"a": column})

    def test_empty_streams_are_whole(self):
        for header in (spmesh.Header(), spmesh.Header("triangle mesh"), spmesh.Header("tetrahedral mesh", 3)):
            stream = spmesh.read(io.BytesIO(written(header)))
            self.assertEqual(len(stream.stored), 0)
        for points in ([], [[1.0, 2.0, 3.0]]):
            file = io.BytesIO()
            spmesh.write_points(file, np.reshape(points, (-1, 3)), {"a": np.zeros(len(points), "f4")})
            self.assertEqual(len(spmesh.read(io.BytesIO(file.getvalue())).rows), len(points))


class Examples(unittest.TestCase):
    def test_examples_run(self):
        for example in sorted((ROOT / "src" / "python" / "examples").glob("*.py")):
            with self.subTest(example.name), tempfile.TemporaryDirectory() as folder:
                path = f"{BIN}{os.pathsep}{os.environ['PATH']}"
                done = subprocess.run(
                    [sys.executable, example], cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True
                )
                if done.returncode == 77:
                    self.skipTest(done.stderr.strip())
                self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_module_reports_files(self):
        ok = VECTORS / "pass" / "mesh-one-triangle.spm"
        done = subprocess.run([sys.executable, "-m", "spmesh", ok], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("triangle mesh: 3 points, 3 vertices, 1 simplices", done.stdout)
        bad = VECTORS / "fail" / "rows-few.spm"
        done = subprocess.run([sys.executable, "-m", "spmesh", bad], capture_output=True, text=True)
        self.assertEqual(done.returncode, 3)


if __name__ == "__main__":
    unittest.main()
