"""Planted faults of programs are reported, and without one there is no complaint."""

import argparse
import contextlib
import importlib.machinery
import importlib.util
import io
import pathlib
import random
import shutil
import subprocess
import tempfile
import time
import unittest
import unittest.mock

from soaking import cases, endless, processes

HERE = pathlib.Path(__file__).resolve().parent
SCRIPT = str(HERE.parents[1] / "scripts" / "soak")
LOADER = importlib.machinery.SourceFileLoader("soak", SCRIPT)
soak = importlib.util.module_from_spec(importlib.util.spec_from_loader("soak", LOADER))
LOADER.exec_module(soak)

# Planted faults, and the complaint about each.
RUNS = {
    "spdelaunay2d loses a point": "exit codes [0, 0, 4]",
    "spdelaunay2d fails": "exit codes [0, 1, 0]",
    "spinfo fails": "exit codes [0, 0, 1]",
    "spfinalize crashes": "exit codes [-11, 0, 0]",
    "spfinalize panics": "panicked",
    "spfinalize leaves a temporary file": "files left: ['spill']",
    "spdelaunay2d leaves a file": "files left: ['left']",
    "spdelaunay2d grows": "memory of spdelaunay2d grew",
    "spfinalize takes much": "spfinalize took",
}
LEAKS = {
    "serve leaks memory": "memory of serve (one process) grew",
    "serve leaks descriptors": "descriptors of serve (one process) grew",
}


class Line(endless.Endless):
    """One pipe instead of one that lives as long as the run."""

    name = "line"

    def work(self):
        points = self.folder.parent / "points.txt"
        points.write_text("0 0\n")
        finalize = ["spfinalize", "--temp-dir", self.scratch, points]
        pipe = self.pipe(finalize, ["spdelaunay2d"], ["spinfo", "-q", "--audit", "--points", points])
        self.finish(self.sampled(pipe), pipe)


class Planted(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="spmesh-soak-test-"))
        self.addCleanup(shutil.rmtree, self.folder)
        for name in ("spfinalize", "spdelaunay2d", "spinfo", "serve"):
            shutil.copy(HERE / "spfake", self.folder / name)
        self.plant()

    def plant(self, *faults):
        (self.folder / "faults").write_text("\n".join(faults))
        (self.folder / "runs").unlink(missing_ok=True)

    def soak(self, *words):
        flags = argparse.Namespace(seed=1, memory="64M", bins=self.folder, seconds=1, only=words)
        return soak.Soak(flags, self.folder / "soak")

    def complaints(self, made):
        """What a soak reports in the end."""
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            made.report()
        return [line for line in printed.getvalue().splitlines() if "FAULT" in line]

    def runs(self, case, numbers=(1,)):
        """The complaints about runs, of which the even ones are yardsticks."""
        made = self.soak(case.__name__)
        with contextlib.redirect_stderr(io.StringIO()):
            for number in numbers:
                made.run(case, number)
        return self.complaints(made)

    def assert_found(self, complaint, found):
        self.assertTrue(any(complaint in line for line in found), f"{complaint}: {found}")

    def test_sound_programs_pass(self):
        self.assertEqual(self.runs(cases.plane, (0, 1, 4)), [])
        self.plant("spfinalize waits once")
        self.assertEqual(self.runs(cases.killed), [])

    def test_each_planted_fault_is_reported(self):
        for fault, complaint in RUNS.items():
            self.plant(fault)
            with self.subTest(fault):
                self.assert_found(complaint, self.runs(cases.plane, (0, 4) if "grew" in complaint else (1,)))

    def test_a_mesh_that_a_killed_pipe_leaves_is_reported(self):
        sleep, ready = time.sleep, self.folder / "ready"

        def wait(_):
            while not ready.exists():
                sleep(0.01)
        self.plant("spfinalize waits once", "spdelaunay2d writes in place")
        with unittest.mock.patch.object(cases.time, "sleep", wait):
            self.assert_found("exit codes [4]", self.runs(cases.killed, [0]))

    def serve(self, fault):
        """The complaints about a process that is sampled after each line that it answers."""
        self.plant(fault)
        made = self.soak("plane")
        server = processes.Process([self.folder / "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        samples = processes.Samples(made.meter, server.pid, "serve")
        with server.stdin, server.stdout:
            for _ in range(30):
                server.stdin.write(b"line\n")
                server.stdin.flush()
                server.stdout.readline()
                samples.take()
        row = made.rows["plane"]
        row.audits = 1
        row.add_samples(samples)
        return self.complaints(made)

    def test_leaks_of_a_long_life_are_reported(self):
        self.assertEqual(self.serve(""), [])
        for fault, complaint in LEAKS.items():
            with self.subTest(fault):
                self.assert_found(complaint, self.serve(fault))

    def test_faults_of_endless_pipes_are_reported(self):
        for number, (fault, complaint) in enumerate({"": "", **RUNS}.items()):
            # Their memory is sampled.
            if "memory" in complaint or "took" in complaint:
                continue
            self.plant(fault)
            line = Line(self.soak(), self.folder / f"line {number}", 30)
            line.join()
            with self.subTest(fault):
                self.assertEqual(line.fault is None, fault == "", line.fault)
                self.assertIn(complaint.split(" [")[0].split(": ")[0], line.fault or "")

    def test_wrong_results_of_a_sweep_are_reported(self):
        made, out = self.soak(), self.folder / "out"
        out.mkdir()
        (out / "summary.tsv").touch()
        trial = cases.Trial(made, random.Random(1), out, out, True)
        for number in range(22):
            (out / f"{number}.spm").write_bytes(b"%d END\n" % (number % 20))
        cases.check_sweep(trial, out, 22)
        for path, content, complaint in (("20.spm", b"1 END\n", "differ"), ("a.tmp", b"", "too many")):
            with self.subTest(path), self.assertRaisesRegex(cases.Fault, complaint):
                (out / path).write_bytes(content)
                cases.check_sweep(trial, out, 22)
