"""Whether splines of LIDAR tiles leave the range of elevations, and whether the program says so.

Ground points are fitted, or all points of a tile that has too few of them, with each choice of knots, smoothing and
robust weights. D is the distance of points: the root of the area per point. Values on a raster are compared with
the elevations of the points that were not rejected.
"""

import subprocess
import time

import inputs
import numpy as np
from tsv import write_tables
from work import progress

GROUND = "2"
GROUND_LEAST = 50
SECONDS_MAX = 600
# One of this number of points is a knot.
POINTS_PER_KNOT = 10
# Rasters have about this number of rows and columns.
CELLS = 400
HEAD = ("tile", "points", "way", "exit code", "seconds", "least", "greatest", "excess", "warns", "said")
SMOOTHING = ([], ["--lambda", "gcv"], ["--lambda", "cv"], ["--lambda", "1e-9"])
ROBUST = (["--robust", "huber"], ["--robust", "tukey"])
PLACEMENTS = ([], ["--step", "2D"], ["--knots", "KNOTS"])
# Without --lambda, other knots than given ones are smoothed in this way, too.
REML = ["--lambda", "reml"]


def run(work, flags):
    if not flags.terrain:
        progress("ranges: left out, as it needs --terrain FILE")
        return
    rows = []
    for path in flags.terrain:
        points = elevations(work, path)
        tile = Tile(work, points)
        for way in ways(flags.quick):
            rows.append([path.name, len(points), " ".join(way) or "(default)", *tile.measure(way)])
            progress(f"ranges: {rows[-1]}")
        write_tables(flags.out / "ranges", HEAD, rows)


def ways(quick):
    for placement in PLACEMENTS[:2] if quick else PLACEMENTS:
        yield from ([*placement, *flags] for flags in (*SMOOTHING, *ROBUST))
    given = ["--knots", "KNOTS"]
    yield from ([*given, *flags] for flags in (REML, *([*robust, *REML] for robust in ROBUST)))
    yield from ([*given, "--lambda", "0"], [*given, "--interpolate"], ["--max-knots", "500"])


def elevations(work, path):
    """The ground points of a tile, or all of its points."""
    for keep in (["--keep-class", GROUND], []):
        finalize = [inputs.program("spfinalize"), "--quiet", *keep, path]
        convert = [inputs.program("spconvert"), "--quiet", "--to", "spa", "-o", work.folder / "points.spa"]
        with subprocess.Popen(finalize, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as source:
            subprocess.run(convert, stdin=source.stdout, stderr=subprocess.DEVNULL)
        lines = (work.folder / "points.spa").read_text().splitlines()
        points = np.array([[float(word) for word in line.split()[1:4]] for line in lines if line.startswith("v ")])
        if len(points) >= GROUND_LEAST:
            break
    return points


class Tile:
    def __init__(self, work, points):
        self.work, self.points = work, points
        self.table = work.table("tile.xyz", points)
        self.low, self.high = points[:, :2].min(0), points[:, :2].max(0)
        self.distance = np.sqrt(np.prod(self.high - self.low) / len(points))
        random = np.random.default_rng(1)
        chosen = random.permutation(len(points))[: max(len(points) // POINTS_PER_KNOT, 10)]
        corners = [[x, y] for x in (self.low[0], self.high[0]) for y in (self.low[1], self.high[1])]
        self.knots = work.table("knots.xy", np.unique(np.vstack([corners, points[chosen, :2]]), axis=0))

    def measure(self, way):
        known = {"KNOTS": str(self.knots), "2D": repr(2 * float(self.distance))}
        rejected = self.work.folder / "rejected.xyz"
        flags = [known.get(word, word) for word in way] + (["--rejected", rejected] if "--robust" in way else [])
        rejected.write_text("")
        start = time.monotonic()
        fit = [inputs.program("splinefit"), "fit", *flags, self.table, "-o", self.work.spline]
        try:
            done = subprocess.run(fit, capture_output=True, text=True, timeout=SECONDS_MAX)
        except subprocess.TimeoutExpired:
            return ["", SECONDS_MAX]
        seconds = round(time.monotonic() - start, 1)
        said = [line.strip() for line in done.stderr.splitlines() if line.strip()]
        warns = any("warning" in line for line in said)
        if done.returncode:
            return [done.returncode, seconds, "", "", "", warns, " / ".join(said)]
        values = self.raster()
        low, high = self.range_without(rejected)
        excess = max(low - values.min(), values.max() - high) / (high - low) if high > low else 0.0
        found = [f"{number:.4g}" for number in (values.min(), values.max(), max(excess, 0.0))]
        return [0, seconds, *found, warns, " / ".join(said)]

    def raster(self):
        side = float((self.high - self.low).max()) / CELLS
        step = ["--step", repr(side), "--format", "text"]
        fields = [inputs.program("splinefit"), "eval", "--quiet", self.work.spline, *step]
        lines = subprocess.run(fields, capture_output=True, text=True, check=True).stdout.splitlines()
        values = np.array([float(line.split()[2]) for line in lines if not line.startswith("#")])
        return values[np.isfinite(values)]

    def range_without(self, rejected):
        # After the head of the list.
        lines = rejected.read_text().splitlines()[1:]
        left_out = {tuple(float(word) for word in line.split()[:3]) for line in lines}
        kept = [z for x, y, z in self.points.tolist() if (x, y, z) not in left_out]
        return min(kept), max(kept)
