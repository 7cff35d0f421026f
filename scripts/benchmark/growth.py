"""Growth in the plane: time per point, memory and width from one million to a hundred million points, in flight
order and permuted."""

from inputs import count_of, program
from measure import Contestant, compete
from tables import number, table

SIZES = ["1M", "3M", "10M", "30M", "100M"]
QUICK_SIZES = ["10k", "100k", "1M"]
COHERENT, PERMUTED = "flight lines", "permuted"
# Memory for a hundred million unordered points, besides a temporary file.
PERMUTED_MEMORY = "256M"


class Growth:
    """The pipe on inputs of several sizes, in one contest."""

    def __init__(self, inputs, flags):
        self.inputs, self.flags = inputs, flags
        self.mesh = flags.dir / "mesh.spm"
        self.sizes = QUICK_SIZES if flags.quick else SIZES
        if flags.sizes:
            self.sizes = flags.sizes

    def run(self):
        """One row per size and order."""
        chosen = [(size, order) for order in (COHERENT, PERMUTED) for size in self.sizes]
        contestants = [self.contestant(size, order) for size, order in chosen]
        compete(contestants, self.flags, self.flags.growth_limit)
        rows = [row(size, order, c) for (size, order), c in zip(chosen, contestants)]
        if not self.flags.keep:
            self.inputs.remove_big()
        return rows

    def contestant(self, size, order):
        # Unordered points are spilled to a temporary file, which must be on the chosen disk.
        folder = ["--temp-dir", self.flags.dir]
        flags = ["--memory", PERMUTED_MEMORY, *folder] if order == PERMUTED else []
        kind = "permuted" if order == PERMUTED else "flight"
        finalize = [program("spfinalize"), "--quiet", *flags, self.inputs.file(f"{kind}-{size}.las")]
        delaunay = [program("spdelaunay2d"), "--stats=json", "-o", self.mesh]
        return Contestant(f"{size} {order}", [finalize, delaunay], self.mesh, threads=0)


def row(size, order, contestant):
    """The figures for one input; without `seconds` if the run failed."""
    facts = {"points": count_of(size), "order": order, "failure": contestant.failure}
    if not contestant.runs:
        return facts
    finalize, delaunay = contestant.peaks
    said = {key: contestant.said(key) for key in ("triangles", "residual_max", "width")}
    walls = [run.wall for run in contestant.runs]
    times = {"seconds": contestant.wall, "walls_s": walls, "us_per_point": contestant.wall / count_of(size) * 1e6}
    return {**facts, **times, "spfinalize_bytes": finalize, "spdelaunay2d_bytes": delaunay, **said}


HEAD = ["points", "order", "wall s", "us/point", "spfinalize MB", "spdelaunay2d MB", "widest residual", "width", "triangles"]


def cells(facts):
    start = [f"{facts['points']:,}", facts["order"]]
    if "seconds" not in facts:
        return [*start, facts["failure"], *[""] * (len(HEAD) - 3)]
    memory = [number(facts[f"{tool}_bytes"] / 1e6, 0) for tool in ("spfinalize", "spdelaunay2d")]
    counts = [f"{facts[key]:,.0f}" for key in ("residual_max", "width", "triangles")]
    return [*start, number(facts["seconds"]), number(facts["us_per_point"], 3), *memory, *counts]


def markdown(rows):
    how = f"LAS to mesh file; permuted points with `spfinalize --memory {PERMUTED_MEMORY}`."
    return f"### Growth in the plane\n\n{how}\n\n" + table(HEAD, [cells(facts) for facts in rows]) + "\n"
