"""Programs in pipes: how they are found, what they get, and what a failure becomes. Programs of the test's own stand in."""

import io
import os
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

import spmesh
from spmesh import programs

STAND_INS = {
    "pass": "cat",
    "count": "wc -c",
    "words": 'for word; do echo "$word"; done',
    "broken": "echo 'broken: the disk is full' >&2; exit 1",
    # As the programs do: the mark of a failure, and its code for those behind.
    "marked": "echo 'marked: no such file' >&2; printf '\\nspmesh: failed 003\\n'; exit 3",
    "follow": "cat >/dev/null; exit 3",
    "greedy": "head -c 10 >/dev/null; echo 'greedy: wrong usage' >&2; exit 2",
    "cut": "cat; echo 'cut: 5 points are lost' >&2; exit 7",
    "killed": "kill -9 $$",
    "endless": 'while :; do echo data || exit 141; done',
    "note": "echo 'note: 3 points are noise' >&2; cat",
    # Has a temporary file until it is asked to end.
    "wait": 'touch "$1"; trap \'rm "$1"; exit 143\' TERM; echo $$; while :; do sleep 0.01; done',
}


class Pipes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        for name, text in STAND_INS.items():
            path = Path(cls.folder.name, name)
            path.write_text(f"#!/bin/sh\n{text}\n")
            path.chmod(0o755)
        cls.patch = mock.patch.dict(os.environ, SPMESH_BIN=cls.folder.name)
        cls.patch.start()

    @classmethod
    def tearDownClass(cls):
        cls.patch.stop()
        cls.folder.cleanup()

    def failure(self, *commands, **more):
        with self.assertRaises(spmesh.ProgramError) as caught:
            programs.run(*commands, **more)
        return caught.exception.program, caught.exception.code, caught.exception.message

    def test_programs_are_found_in_the_stated_folder_beside_python_or_on_the_path(self):
        self.assertEqual(programs.find("pass"), Path(self.folder.name, "pass"))
        with self.assertRaisesRegex(spmesh.ProgramNotFoundError, "cargo install"):
            programs.find("sh")
        with mock.patch.dict(os.environ):
            del os.environ["SPMESH_BIN"]
            self.assertEqual(programs.find("sh").name, "sh")
            with mock.patch("sysconfig.get_path", return_value=self.folder.name):
                self.assertEqual(programs.find("pass"), Path(self.folder.name, "pass"))

    def test_data_go_through_a_pipe(self):
        data = os.urandom(3_000_000)
        self.assertEqual(programs.run(["pass"], ["pass"], ["pass"], input=data), data)
        self.assertEqual(programs.run(["pass"], ["count"], input=lambda file: file.write(data)).split(), [b"3000000"])
        points = programs.run(["pass"], input=np.ones((5, 3)))
        self.assertEqual(spmesh.read(io.BytesIO(points)).xyz.tolist(), [[1, 1, 1]] * 5)
        self.assertEqual(programs.run(["words", "a b", Path("-x"), "--flag", 3]), b"a b\n./-x\n--flag\n3\n")

    def test_the_first_failure_is_the_cause(self):
        self.assertEqual(self.failure(["broken"]), ("broken", 1, "the disk is full"))
        self.assertEqual(self.failure(["marked"], ["follow"], ["follow"]), ("marked", 3, "no such file"))
        self.assertEqual(self.failure(["endless"], ["greedy"], ["follow"]), ("greedy", 2, "wrong usage"))
        self.assertEqual(self.failure(["greedy"], input=bytes(10**6)), ("greedy", 2, "wrong usage"))
        self.assertEqual(self.failure(["pass"], ["killed"], ["follow"], input=b"x"), ("killed", -9, ""))
        self.assertRegex(str(spmesh.ProgramError("a", 2, "why")), "a failed with exit code 2: why")

    def test_a_reader_gets_the_cause_and_not_its_symptom(self):
        for commands in ([["marked"]], [["marked"], ["follow"]], [["killed"]]):
            with self.assertRaises(spmesh.ProgramError) as caught, programs.Pipe(*commands) as pipe:
                spmesh.read(pipe.stdout)
            self.assertEqual(caught.exception.program, commands[0][0])
            self.assertIsInstance(caught.exception.__cause__, spmesh.SpmeshError)

    def test_a_reader_may_stop_early(self):
        with programs.Pipe(["endless"], ["pass"]) as pipe:
            self.assertEqual(pipe.stdout.read(5), b"data\n")

    def test_failures_of_the_caller_are_its_own(self):
        def fail(file):
            file.write(b"some")
            raise KeyError("mine")

        with self.assertRaises(KeyError):
            programs.run(["pass"], input=fail)
        with self.assertRaises(KeyError), programs.Pipe(["endless"]) as pipe:
            raise KeyError(pipe.stdout.read(1))
        with self.assertRaises(ValueError):
            programs.run()

    def test_outputs_get_their_names_when_they_are_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "output")
            programs.run(["pass"], input=b"first", output=path)
            self.failure(["pass"], ["broken"], input=b"second", output=path)
            self.assertEqual((path.read_bytes(), os.listdir(folder)), (b"first", ["output"]))

    def test_points_that_are_lost_are_a_warning_and_notices_go_to_the_log(self):
        with self.assertWarnsRegex(UserWarning, "cut: 5 points are lost"):
            self.assertEqual(programs.run(["cut"], input=b"rest"), b"rest")
        with self.assertLogs("spmesh", "INFO") as log:
            programs.run(["note"])
        self.assertIn("3 points are noise", log.output[0])

    def test_an_interrupt_ends_all_programs_and_leaves_no_file(self):
        with tempfile.TemporaryDirectory() as folder:
            script = (
                "import signal, sys; from spmesh import programs\n"
                # Where a test runs in the background, the shell makes it ignore the signal.
                "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
                "with programs.Pipe(['wait', sys.argv[1]], ['pass']) as pipe:\n"
                "    print(pipe.stdout.readline().decode(), end='', flush=True)\n"
                "    pipe.stdout.read()\n"
            )
            command = [sys.executable, "-c", script, str(Path(folder, "temporary"))]
            with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
                number = int(process.stdout.readline())
                self.assertEqual(os.listdir(folder), ["temporary"])
                process.send_signal(signal.SIGINT)
            self.assertNotEqual(process.returncode, 0)
            self.assertEqual(os.listdir(folder), [])
            with self.assertRaises(ProcessLookupError):
                os.kill(number, 0)

    def test_values_that_are_flags_are_written_as_programs_read_them(self):
        from spmesh.options import flags_of

        options = dict(min_area=2, bounds=(-1.5, np.float64(0.1), 3, 4), first_only=True, crs=None, lambda_="gcv", z=False)
        expected = ["--min-area=2", "--bounds=-1.5,0.1,3,4", "--first-only", "--lambda=gcv"]
        self.assertEqual(flags_of(options), expected)


if __name__ == "__main__":
    unittest.main()
