"""The two kinds of measurement: the kernel alone, and whole pipes from file to file."""

from dataclasses import dataclass, field

from inputs import count_of, program
from measure import Contestant, compete

OURS = "spmesh"
DECODER = "decode LAZ once (laz crate, 2 threads)"
ALONE = "spdelaunay2d --threads {}"
FROM_LAZ = "spmesh, LAZ"
FULL_SETS = ["uniform-1M", "grid-1000", "uniform-10M", "flight-10M", "grid-3163", "pipe-10M"]
QUICK_SETS = ["uniform-100k", "grid-300", "flight-100k", "pipe-100k"]


@dataclass
class Contest:
    """All that was measured on one input."""

    name: str
    points: int
    contestants: list
    # Peers that did not run, and why.
    absent: dict = field(default_factory=dict)

    @property
    def is_pipe(self):
        return self.name.startswith("pipe")

    @property
    def seconds(self):
        """What is compared, of a contestant: all of a pipe, of a kernel the triangulation alone."""
        return (lambda c: c.wall) if self.is_pipe else (lambda c: c.said("seconds"))

    def get(self, name):
        return next((c for c in self.contestants if c.name == name and c.runs), None)

    def peers(self):
        """Peers with figures, the fastest first."""
        names = {OURS, DECODER, FROM_LAZ, ALONE.format(1), ALONE.format(2)}
        ran = [c for c in self.contestants if c.name not in names and c.runs and self.seconds(c)]
        return sorted(ran, key=self.seconds)

    def triangles(self):
        """The number that most exact programs agree on, where there are any."""
        counts = [c.said("triangles") for c in self.contestants if c.said("triangles")]
        return max(counts, key=counts.count) if counts else None

    def as_json(self):
        contestants = [c.as_json() for c in self.contestants]
        return {"name": self.name, "points": self.points, "contestants": contestants, "absent": self.absent}


class Contests:
    """Runs contests; remembers who is too slow for bigger ones."""

    def __init__(self, inputs, peers, flags):
        self.inputs, self.peers, self.flags = inputs, peers, flags
        self.triangles = flags.dir / "triangles.bin"
        self.mesh = flags.dir / "mesh.spm"
        self.per_point = {True: {}, False: {}}

    def run(self, name):
        kind, size = name.split("-")
        contest = self.pipe(name, size) if kind == "pipe" else self.kernel(name, kind)
        # Who does not sort its points is slow on those without order only.
        per_point = self.per_point[kind in ("pipe", "flight")]
        self.excuse_slow(contest, per_point)
        chosen = [c for c in contest.contestants if self.is_wanted(c.name)]
        contest.contestants = chosen
        compete(chosen, self.flags.rounds, self.flags.limit)
        for contestant in chosen:
            if contestant.failure.startswith("over"):
                per_point[contestant.name] = self.flags.limit / contest.points
            elif contestant.runs:
                per_point[contestant.name] = contestant.wall / contest.points
        return contest

    def is_wanted(self, name):
        return not self.flags.only or name.split(",")[0].split()[0].lower() in self.flags.only

    def kernel(self, name, kind):
        points = self.inputs.file(f"{name}.las" if kind == "flight" else f"{name}.f64")
        size = count_of(name.split("-")[1])
        ours = [program("examples/kernel_time"), points, self.triangles]
        contestants = [Contestant(OURS, [ours], self.triangles)]
        contestants += [self.contestant(p, points) for p in self.peers if p.program and not p.whole_only]
        return Contest(name, size * size if kind in ("grid", "decimals") else size, contestants, self.absent())

    def pipe(self, name, size):
        las, laz = self.inputs.file(f"flight-{size}.las"), self.inputs.file(f"flight-{size}.laz")
        stream = self.inputs.finalized(las)
        contestants = [Contestant(OURS, self.from_file(las), self.mesh)]
        contestants += [self.contestant(peer, las) for peer in self.peers if peer.program]
        contestants.append(Contestant(FROM_LAZ, self.from_file(laz), self.mesh))
        contestants.append(Contestant(DECODER, [[self.inputs.helpers / "decode", laz, 2]]))
        for threads in (1, 2):
            alone = [[*self.delaunay(), "--threads", threads, stream]]
            contestants.append(Contestant(ALONE.format(threads), alone, self.mesh))
        return Contest(name, count_of(size), contestants, self.absent())

    def contestant(self, peer, points):
        output = f"{self.triangles}.ply" if peer.whole_only else self.triangles
        return Contestant(peer.name, [peer.command(points, self.triangles)], output)

    def from_file(self, path, *flags):
        """Our pipe, as users run it."""
        return [[program("spfinalize"), "--quiet", *flags, path], self.delaunay()]

    def delaunay(self):
        return [program("spdelaunay2d"), "--stats=json", "-o", self.mesh]

    def absent(self):
        return {peer.name: f"not installed: {peer.reason}" for peer in self.peers if not peer.program}

    def excuse_slow(self, contest, per_point):
        """Leaves out whoever would need too long, by what was measured on less."""
        for contestant in list(contest.contestants):
            expected = per_point.get(contestant.name, 0) * contest.points
            if expected >= self.flags.limit:
                contest.contestants.remove(contestant)
                contest.absent[contestant.name] = f"not run: would take over {self.flags.limit:.0f} s"
