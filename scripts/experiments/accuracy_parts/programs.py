"""Points, tess3 and spinfo as functions."""

import json
import pathlib
import random
import subprocess
import sys
import tempfile

from target import PROGRAMS as BIN


class Workplace:
    """A temporary folder with the points and the mesh of one run at a time."""

    def __enter__(self):
        self.temporary = tempfile.TemporaryDirectory()
        folder = pathlib.Path(self.temporary.name)
        self.points, self.mesh = folder / "points.xyz", folder / "mesh.spm"
        return self

    def __exit__(self, *_):
        self.temporary.cleanup()

    def make(self, count, bits, seed):
        """Random points with non-negative integer coordinates of `bits` bits."""
        rng = random.Random(f"{count} {bits} {seed}")
        end = 1 << bits
        numbers = (f"{rng.randrange(end)} {rng.randrange(end)} {rng.randrange(end)}\n" for _ in range(count))
        self.points.write_text("".join(numbers))

    def triangulate(self, *flags):
        """The counts that tess3 reports for the points with these flags; writes the mesh to `mesh`."""
        command = [BIN / "tess3", "--quiet", "--from=points", "--stats=json", *flags, "-o", self.mesh, self.points]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{' '.join(map(str, command))}: {done.stderr}")
        return said(done.stderr)

    def audit(self):
        """The violations in the mesh that spinfo counts; they do not fail the run."""
        command = [BIN / "spinfo", "--audit=delaunay", "--count-violations", "--json", self.mesh]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if done.returncode not in (0, 4):
            sys.exit(f"{' '.join(map(str, command))}: {done.stderr}")
        return json.loads(done.stdout)["census"]

    def tetrahedra(self, number=int):
        """The points with coordinates made by `number`, and the tetrahedra of the mesh as quadruples of indices."""
        medit = self.mesh.with_suffix(".mesh")
        subprocess.run([BIN / "spconvert", "--quiet", self.mesh, "-o", medit], check=True)
        lines = iter(medit.read_text().splitlines())
        section = {}
        for line in lines:
            if line in ("Vertices", "Tetrahedra"):
                read = number if line == "Vertices" else int
                section[line] = [[read(word) for word in next(lines).split()[:-1]] for _ in range(int(next(lines)))]
        return section["Vertices"], [[vertex - 1 for vertex in corners] for corners in section["Tetrahedra"]]


def measured(place, flags, name, sets, ways, row):
    """A row for each way to triangulate each run of each set; sets are numbers of points and bits."""
    rows = []
    for count, bits in sets:
        for number in range(1, flags.runs + 1):
            place.make(count, bits, number)
            rows += [row(place, way, count, bits, number) for way in ways]
        progress(f"{name}: {count} points of {bits} bits")
    return rows


def said(text):
    """The line of JSON in `text`."""
    return next(json.loads(line) for line in text.splitlines() if line.startswith("{"))


def progress(text):
    print(text, file=sys.stderr, flush=True)


def write_tsv(path, head, rows):
    lines = ["\t".join(map(str, row)) + "\n" for row in [head, *rows]]
    path.write_text("".join(lines))
    progress(f"written: {path}")
