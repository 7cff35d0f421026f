"""Rounds, warm-ups, cores, temporary files and inputs, with programs that are lines of Python."""

import contextlib
import io
import json
import os
import pathlib
import sys
import tempfile
import types
import unittest
from unittest import mock

import copies
import disk
import measure
import pinning
import scale
import structures

FLAGS = types.SimpleNamespace(rounds=3, seed=1, lock=None, pins=pinning.Pins(False))
LIMIT_S = 60.0


def python(name, *lines, **facts):
    """A contestant of one process per line."""
    return measure.Contestant(name, [[sys.executable, "-c", line] for line in lines], **facts)


def compete(*contestants, once=1e9):
    with mock.patch.object(measure, "ONCE_SECONDS", once), contextlib.redirect_stderr(io.StringIO()) as told:
        measure.compete(list(contestants), FLAGS, LIMIT_S)
    return told.getvalue()


class Rounds(unittest.TestCase):
    def test_the_warm_up_is_not_counted(self):
        both = [python(name, "print('{\"seconds\": 2.0}')") for name in "ab"]
        told = compete(*both)
        for contestant in both:
            self.assertEqual([run.round for run in contestant.runs], [1, 2, 3])
            self.assertEqual(contestant.by_round(lambda run: run.said["seconds"]), {1: 2.0, 2: 2.0, 3: 2.0})
        self.assertEqual(told.count("warm-up"), 2)

    def test_the_warm_up_of_a_slow_program_is_its_only_run(self):
        both = [python(name, "pass") for name in "ab"]
        compete(*both, once=0.0)
        self.assertEqual([[run.round for run in each.runs] for each in both], [[0], [0]])
        alone = python("alone", "pass")
        compete(alone, once=0.0)
        self.assertEqual([run.round for run in alone.runs], [1, 2, 3])

    def test_a_program_that_fails_is_not_run_again(self):
        bad, good = python("bad", "raise SystemExit('no such thing')"), python("good", "pass")
        told = compete(bad, good)
        self.assertIn("no such thing", bad.failure)
        self.assertEqual((len(bad.runs), len(good.runs), told.count("bad:")), (0, 3, 1))

    def test_each_process_of_a_pipe_has_its_figures(self):
        pipe = python("pipe", "print('x' * 9)", "import json; print(json.dumps({'length': len(input())}))")
        run = measure.run(pipe, LIMIT_S)
        self.assertEqual((run.said, len(run.cpus), len(run.peaks)), ({"length": 9}, 2, 2))
        self.assertEqual(run.cpu, sum(run.cpus))
        json.dumps(run.as_json())


    def test_peaks_are_those_of_programs(self):
        """What this process held before does not count, what it holds does: see floor_bytes."""
        waste = bytearray(64 << 20)
        held = measure.floor_bytes()
        del waste
        run = measure.run(measure.Contestant("nothing", [["true"]]), LIMIT_S)
        self.assertGreater(held, 64 << 20)
        self.assertLess(max(run.peaks), 64 << 20)
        self.assertIsNone(run.memory)


class Cores(unittest.TestCase):
    def test_one_thread_of_each_physical_core_comes_first(self):
        two_by_two = {0: {0, 2}, 2: {0, 2}, 1: {1, 3}, 3: {1, 3}}
        self.assertEqual(pinning.preferred({0, 1, 2, 3}, two_by_two), [1, 0, 3, 2])
        self.assertEqual(pinning.preferred({2, 3}, two_by_two), [3, 2])
        self.assertEqual(list(pinning.numbers("0,4-6\n")), [0, 4, 5, 6])

    def test_programs_run_on_their_cores_only(self):
        pins = pinning.Pins()
        if not pins.cores:
            self.skipTest(str(pins))
        before = os.sched_getaffinity(0)
        line = "import json, os; print(json.dumps({'cores': sorted(os.sched_getaffinity(0))}))"
        for threads in (1, 2, 0):
            run = measure.run(python("cores", line, threads=threads), LIMIT_S, pins)
            self.assertEqual(set(run.said["cores"]), pins.of(threads))
        self.assertEqual(len(pins.of(1)), 1)
        self.assertEqual(os.sched_getaffinity(0), before)


class Disk(unittest.TestCase):
    def test_files_with_and_without_a_name_count(self):
        with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as other:
            folder, here = pathlib.Path(name).resolve(), [os.getpid()]
            (folder / "named").write_bytes(bytes(100_000))
            named = disk.used(folder, here)
            self.assertGreaterEqual(named, 100_000)
            with tempfile.TemporaryFile(dir=folder) as unnamed, tempfile.TemporaryFile(dir=other) as elsewhere:
                for file in (unnamed, elsewhere):
                    file.write(bytes(200_000))
                    file.flush()
                self.assertGreaterEqual(disk.used(folder, here), named + 200_000)
                self.assertLess(disk.used(folder, here), named + 400_000)
                self.assertEqual(disk.used(folder, []), named)

    def test_programs_have_the_sampled_folder_as_theirs(self):
        line = "import os, sys; print(os.environ['TMPDIR'], file=sys.stderr); sys.exit(1)"
        with tempfile.TemporaryDirectory() as folder:
            run = measure.run(python("temporary", line, temporary=folder), LIMIT_S)
        self.assertIn(folder, run.failure)


class Files(unittest.TestCase):
    def test_copies_of_a_structure_are_apart(self):
        atoms = structures.atoms(copies.SOURCE)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "points"
            copies.write(copies.source(None), 3 * len(atoms) - 7, path)
            points = list(zip(*[iter(memoryview(path.read_bytes()).cast("d"))] * 3))
        self.assertEqual(len(points), 3 * len(atoms) - 7)
        self.assertEqual(len(set(points)), len(points))
        self.assertEqual(points[: len(atoms)], [tuple(round(x, 3) for x in atom) for atom in atoms])
        end = max(x for x, *_ in points[: len(atoms)])
        start = min(x for x, *_ in points[len(atoms) : 2 * len(atoms)])
        self.assertAlmostEqual(start - end, copies.GAP * copies.UNIT)

    def test_the_largest_structure_of_a_folder_is_copied(self):
        self.assertEqual(copies.source(copies.SOURCE.parent).name, "1aki.cif")

    def test_points_of_las_headers(self):
        data = copies.SOURCE.parent
        for name, count in (("point10.las", 1065), ("1_4_w_evlr.las", 1000), ("1_4_w_evlr.laz", 1000)):
            self.assertEqual(scale.points_of(data / name), count, name)


if __name__ == "__main__":
    unittest.main()
