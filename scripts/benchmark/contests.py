"""The kinds of measurement: the kernels alone, in 2D, 3D and 4D, and whole pipes from file to file."""

import sys
from collections import defaultdict
from dataclasses import dataclass, field

import ratios
import rasters
import structures
from inputs import count_of, program
from measure import Contestant, compete

OURS, OURS_TWICE = "spmesh", "spmesh, 2 threads"
HXT_TWICE = "HXT, 2 threads"
# Elevation models, whose peers differ from those of triangulations.
DEM = "dem"
# Reading the clock takes time, so this run is not compared with peers.
IN_PARTS = "spmesh, parts timed"
DECODER = "decode LAZ once (laz crate, 2 threads)"
ALONE = "spdelaunay2d --threads {}"
FROM_LAZ = "spmesh, LAZ"
STRUCTURES, SWEEP = "structures", "sweep"
TESS3 = "tess3 --threads {}"
FULL_SETS = ["uniform-1M", "grid-1000", "uniform-10M", "flight-10M", "grid-3163", "pipe-10M"]
QUICK_SETS = ["uniform-100k", "grid-300", "flight-100k", "pipe-100k"]
FULL_SETS_3D = ["uniform3-1M", "protein3-1M", "surface3-1M", "tenbit3-100k", "grid3-100", "fcc3-63"]
QUICK_SETS_3D = ["uniform3-20k", "protein3-20k", "surface3-20k", "tenbit3-20k", "grid3-25", "fcc3-16"]
GRID_PERCENTS = (10, 20, 40, 80, 100)
FULL_SETS_4D = [*(f"grid4-{percent}" for percent in GRID_PERCENTS), "random4-10k", "random4-30k", "random4-100k"]
QUICK_SETS_4D = ["grid4-2", "random4-1k"]
SETS = {
    "2d": (FULL_SETS, QUICK_SETS),
    "3d": (FULL_SETS_3D, QUICK_SETS_3D),
    "4d": (FULL_SETS_4D, QUICK_SETS_4D),
    "scale": (["scale-1G"], ["scale-1M"]),
}
# Time limits of a run; Qhull needs minutes for a grid in 4D.
LIMIT_S, LIMIT4_S = 120.0, 300.0
COORDINATE_BYTES = 8
# Below, the start of a program is much of its time.
CPU_MIN_S = 0.05


def dims_of(name):
    """Dimension of the points of a set, from its name; 0 for sets without triangulating peers."""
    kind = name.split("-")[0]
    if name == SWEEP or kind in (DEM, "scale"):
        return 0
    return 3 if name == STRUCTURES else int(kind[-1]) if kind[-1] in "34" else 2


@dataclass
class Contest:
    """All measurements on one input."""

    name: str
    points: int
    contestants: list
    # Peers that did not run, with the reason.
    absent: dict = field(default_factory=dict)
    dims: int = 2

    @property
    def is_pipe(self):
        return self.name.startswith(("pipe", DEM))

    @property
    def element(self):
        """The elements of a triangulation or a diagram."""
        return {3: "tetrahedra", 4: "cells"}.get(self.dims, "triangles")

    def seconds_of(self, run):
        """The compared time of a run: the whole pipe, or the triangulation of a kernel alone."""
        return run.wall if self.is_pipe or not self.dims else run.said.get("seconds")

    def seconds(self, contestant):
        return contestant.median(self.seconds_of)

    def get(self, name):
        return next((c for c in self.contestants if c.name == name and c.runs), None)

    def peers(self):
        """Peers with results, the fastest first; in 3D and 4D only those on one thread, as ours is."""
        names = {OURS, IN_PARTS, DECODER, FROM_LAZ, ALONE.format(1), ALONE.format(2)}
        ran = [c for c in self.contestants if c.name not in names and c.runs and self.seconds(c)]
        return sorted((c for c in ran if self.dims == 0 or self.is_pipe or "threads" not in c.name), key=self.seconds)

    def ratio(self, over, under, value=None):
        """The ratio of two contestants in seconds, or in another value of a run; None if there is none."""
        value = value or self.seconds_of
        return ratios.ratio(over.by_round(value), under.by_round(value))

    def elements(self):
        """The element count that most programs report, if any."""
        counts = [c.said(self.element) for c in self.contestants if c.said(self.element)]
        return max(counts, key=counts.count) if counts else None

    def as_json(self):
        contestants = [c.as_json() for c in self.contestants]
        return {"name": self.name, "points": self.points, "contestants": contestants, "absent": self.absent}


def wall(run):
    return run.wall


def cpu(run):
    """Seconds of the processor of all processes together, with reading and writing; None if too few to tell."""
    return run.cpu if run.cpu > CPU_MIN_S else None


def memory(run):
    return run.memory


class Contests:
    """Runs contests; remembers the programs that are too slow for larger ones."""

    def __init__(self, inputs, peers, flags):
        self.inputs, self.peers, self.flags = inputs, peers, flags
        self.triangles = flags.dir / "triangles.bin"
        self.mesh = flags.dir / "mesh.spm"
        # Seconds per point of each program, by dimension and by whether the points are ordered.
        self.per_point = defaultdict(dict)

    def run(self, name):
        kind, size = name.split("-")
        if kind == DEM:
            contest = self.dem(name)
        elif dims_of(name) == 3:
            contest = self.kernel3(name, self.inputs.file(f"{name}.f64"))
        elif dims_of(name) == 4:
            contest = self.kernel4(name, self.inputs.file(f"{name}.f64"))
        else:
            contest = self.pipe(name, size) if kind == "pipe" else self.kernel(name, kind)
        # Programs that do not sort their points are slow on unordered points only, so these times are kept
        # apart.
        per_point = self.per_point[contest.dims, kind in ("pipe", "flight", "grid4")]
        # The time per point of a 4D grid depends on the share of the grid, so smaller shares do not predict
        # it.
        if kind != "grid4":
            self.excuse_slow(contest, per_point)
        self.compete(contest)
        for contestant in contest.contestants:
            if contestant.failure.startswith("over"):
                per_point[contestant.name] = self.limit(contest) / contest.points
            elif contestant.runs:
                per_point[contestant.name] = contestant.wall / contest.points
        return contest

    def structures(self):
        """One contest per real structure, and the structures that cannot be read."""
        files, unread = structures.prepare(self.flags.structures, self.inputs.folder / "structures")
        contests = [self.kernel3(name, points) for name, points in files]
        for contest in contests:
            print(f"{contest.name}:", file=sys.stderr)
            contest.contestants = [c for c in contest.contestants if "threads" not in c.name]
            self.compete(contest)
        return contests, unread

    def sweep(self):
        """All real structures in one run, on one thread and on two. Bad files do not fail the run."""
        files = structures.find(self.flags.structures)
        folder = self.flags.dir / "sweep"
        command = [program("tess3"), "--quiet", "--out-dir", folder, *files, "--threads"]
        both = [Contestant(TESS3.format(n), [[*command, n]], folder, threads=n, accepts=(0, 1)) for n in (1, 2)]
        contest = Contest(SWEEP, len(files), both, dims=0)
        compete(both, self.flags, self.limit(contest))
        return contest

    def limit(self, contest):
        """Time limit of a run, in seconds."""
        return self.flags.limit or (LIMIT4_S if contest.dims == 4 else LIMIT_S)

    def compete(self, contest):
        chosen = [c for c in contest.contestants if self.is_wanted(c.name)]
        contest.contestants = chosen
        compete(chosen, self.flags, self.limit(contest))

    def is_wanted(self, name):
        return not self.flags.only or name.split(",")[0].split()[0].lower() in self.flags.only

    def kernel(self, name, kind):
        points = self.inputs.file(f"{name}.las" if kind == "flight" else f"{name}.f64")
        size = count_of(name.split("-")[1])
        ours = [program("examples/kernel_time"), points, self.triangles]
        contestants = [Contestant(OURS, [ours], self.triangles)]
        contestants += [self.contestant(p, points) for p in self.peers[2] if p.program and not p.whole_only]
        return Contest(name, size * size if kind in ("grid", "decimals") else size, contestants, self.absent(2))

    def kernel3(self, name, points):
        kernel = [program("examples/kernel3_time"), points]
        contestants = [Contestant(OURS, [kernel]), Contestant(IN_PARTS, [[*kernel, "--parts"]])]
        contestants.append(Contestant(OURS_TWICE, [[*kernel, "--threads", 2]], threads=2))
        for peer in self.peers[3]:
            if peer.program:
                command = [peer.program, points, peer.threads]
                contestants.append(Contestant(peer.name, [command], threads=peer.threads))
        return Contest(name, points.stat().st_size // (3 * COORDINATE_BYTES), contestants, self.absent(3), dims=3)

    def kernel4(self, name, points):
        engine = [program("examples/diagram4_time"), points]
        contestants = [Contestant(OURS, [engine]), Contestant(OURS_TWICE, [[*engine, "--threads", 2]], threads=2)]
        contestants += [Contestant(p.name, [[p.program, points, *p.flags]]) for p in self.peers[4] if p.program]
        return Contest(name, points.stat().st_size // (4 * COORDINATE_BYTES), contestants, self.absent(4), dims=4)

    def pipe(self, name, size):
        las, laz = self.inputs.file(f"flight-{size}.las"), self.inputs.file(f"flight-{size}.laz")
        stream = self.inputs.finalized(las)
        contestants = [Contestant(OURS, self.from_file(las), self.mesh, threads=0)]
        contestants += [self.contestant(peer, las) for peer in self.peers[2] if peer.program]
        contestants.append(Contestant(FROM_LAZ, self.from_file(laz), self.mesh, threads=0))
        contestants.append(Contestant(DECODER, [[self.inputs.helpers / "decode", laz, 2]], threads=2))
        for threads in (1, 2):
            alone = [[*self.delaunay(), "--threads", threads, stream]]
            contestants.append(Contestant(ALONE.format(threads), alone, self.mesh, threads=threads))
        return Contest(name, count_of(size), contestants, self.absent(2))

    def dem(self, name):
        points, contestants, absent = rasters.contestants(self.inputs, name, self.flags.dir)
        return Contest(name, points, contestants, absent, dims=0)

    def contestant(self, peer, points):
        output = f"{self.triangles}.ply" if peer.whole_only else self.triangles
        return Contestant(peer.name, [peer.command(points, self.triangles)], output, threads=peer.threads)

    def from_file(self, path, *flags):
        """Our pipe, as users run it."""
        return [[program("spfinalize"), "--quiet", *flags, path], self.delaunay()]

    def delaunay(self):
        return [program("spdelaunay2d"), "--stats=json", "-o", self.mesh]

    def absent(self, dims):
        return {peer.name: f"not installed: {peer.reason}" for peer in self.peers[dims] if not peer.program}

    def excuse_slow(self, contest, per_point):
        """Leaves out contestants that would take too long, judging by their times on smaller inputs."""
        for contestant in list(contest.contestants):
            expected = per_point.get(contestant.name, 0) * contest.points
            if expected >= self.limit(contest):
                contest.contestants.remove(contestant)
                contest.absent[contestant.name] = f"not run: would take over {self.limit(contest):.0f} s"
