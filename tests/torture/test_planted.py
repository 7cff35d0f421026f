"""A program with a planted fault is reported, and one without is not."""

import os
import pathlib
import shutil
import tempfile
import unittest

import cases
import faults_disks  # noqa: F401
import faults_inputs  # noqa: F401
import faults_pipes  # noqa: F401
import faults_places  # noqa: F401
import faults_signals  # noqa: F401
import runs
import verdicts
import worlds
from jobs import Job

JOB = Job("copy", "spcopy in/a.spm", "-o out/b.spm", "")
SEEDS = range(3)
# By the planted fault: the fault of the script that finds it, and what is reported.
PLANTED = {
    "writes in place": ("cut", verdicts.SILENT),
    "ignores errors": ("dev-full", verdicts.CODE),
    "accepts cut inputs": ("cut", verdicts.CODE),
    "leaves files": ("cut", verdicts.LEFTOVER),
    "stays": ("stop", verdicts.LEFTOVER),
    "panics": ("cut", verdicts.PANIC),
    "waits": ("cut", verdicts.HANG),
    "says nothing": ("cut", verdicts.MESSAGE),
    "speaks twice": ("cut", verdicts.MESSAGE),
    "knows no pipes": ("no-reader", verdicts.CODE),
    "replaces inputs": ("same", verdicts.SILENT),
}


class Planted(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="spmesh-torture-test-"))
        self.addCleanup(shutil.rmtree, self.folder)
        (self.folder / "in").mkdir()
        (self.folder / "in" / "a.spm").write_bytes(b"line\n" * 30_000 + b"END\n")
        shutil.copy(pathlib.Path(__file__).parent / "spcopy", self.folder)
        self.plant("")
        self.world = cases.World(str(self.folder), self.folder, "", {}, False, None, {})
        worlds.add_wholes(self.world, [JOB])
        limit = runs.TIME_MAX
        runs.TIME_MAX = 5
        self.addCleanup(lambda: setattr(runs, "TIME_MAX", limit))

    def plant(self, fault):
        (self.folder / "fault").write_text(fault)

    def kinds(self, name, seeds=SEEDS):
        """The kinds of complaints about one fault, with some seeds."""
        found = [cases.Case(self.world, JOB, 0, name, seed).torture() for seed in seeds]
        self.assertTrue(any(result.runs for result in found), f"{name} was not run")
        return {kind for result in found for kind, _ in result.complaints}

    def test_a_sound_program_passes(self):
        for name in sorted({"kill", "term", "slow", "file-size", *(name for name, _ in PLANTED.values())}):
            self.assertEqual(self.kinds(name), set(), name)

    def test_each_planted_fault_is_reported(self):
        for planted, (name, kind) in PLANTED.items():
            self.plant(planted)
            seeds = SEEDS[:1] if kind == verdicts.HANG else SEEDS
            with self.subTest(planted):
                self.assertIn(kind, self.kinds(name, seeds))

    def test_a_changed_input_is_reported(self):
        room = runs.Room(self.folder / "room", self.folder / "in", JOB)
        self.addCleanup(room.close)
        self.assertEqual(room.changed_inputs(), [])
        os.truncate(room.inputs / "a.spm", 3)
        self.assertEqual(room.changed_inputs(), ["a.spm"])
