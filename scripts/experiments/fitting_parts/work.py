"""Our programs as functions, and the files that they exchange."""

import json
import pathlib
import subprocess
import sys
import tempfile

import inputs
import numpy as np

SAID_LENGTH = 300


class Failed(Exception):
    """A program failed with this message."""


class Workplace:
    """A temporary folder for the files of one fit at a time."""

    def __enter__(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.spline = self.folder / "spline.spm"
        return self

    def __exit__(self, *_):
        self.temporary.cleanup()

    def table(self, name, rows):
        """Writes a file of lines of numbers, with all digits."""
        path = self.folder / name
        path.write_text("".join(" ".join(map(repr, row)) + "\n" for row in np.asarray(rows, float).tolist()))
        return path

    def fit(self, points, *flags):
        """Fits the spline, and returns the program's counts."""
        said = ours("splinefit", "fit", "--quiet", "--stats=json", *flags, points, "-o", self.spline).stderr
        return json.loads(next(line for line in said.splitlines() if line.startswith("{")))

    def interpolate(self, knots, function):
        """Makes the spline over knots that has the values of a function at Greville sites.

        `--interpolate` takes the values at Greville sites from the triangulated points. So if the points are
        these sites, which the control mesh of any spline over the knots lists, their own values count and no
        others.
        """
        x0, y0, x1, y1 = self.summary(knots)["domain"]
        corners = [[x, y, 0.0] for x in (x0, x1) for y in (y0, y1)]
        self.fit(self.table("corners.xyz", corners), "--knots", knots, "--interpolate")
        sites = self.control_sites()
        values = function(*sites.T)
        self.fit(self.table("sites.xyz", np.column_stack([sites, values])), "--knots", knots, "--interpolate")

    def control_sites(self):
        mesh = self.folder / "control.spm"
        ours("splinefit", "mesh", self.spline, "-o", mesh)
        lines = ours("spconvert", "--quiet", "--to", "text", mesh).stdout.splitlines()
        return np.array([[float(word) for word in line.split()[1:3]] for line in lines if line.startswith("v ")])

    def summary(self, stream):
        """The summary of a spline or of configurations by splinefit info."""
        return json.loads(ours("splinefit", "info", "--json", stream).stdout)

    def values(self, sites):
        """The values of the spline at sites; NaN outside its domain."""
        lines = ours("splinefit", "eval", "--quiet", self.spline, "--at", self.table("at.xy", sites)).stdout
        return np.array([float(line.split()[2]) for line in lines.splitlines() if not line.startswith("#")])


def ours(name, *words):
    """Runs one of our programs to the end."""
    command = [str(word) for word in (inputs.program(name), *words)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise Failed(f"{name} {words[0]}: {done.stderr.strip()[-SAID_LENGTH:]}")
    return done


def progress(text):
    print(text, file=sys.stderr, flush=True)
