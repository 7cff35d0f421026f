"""Growth in space: time per point, memory and width of the pipe, beside `tess3`, which holds everything."""

import conclusions
import copies
import machine
import ratios
from contests import memory, wall
from inputs import count_of, program
from measure import Contestant, compete
from tables import number, table

SIZES = ["1M", "3M", "10M"]
QUICK_SIZES = ["10k", "30k", "100k"]
# Random points fill space, a gyroid is a surface, and a structure is molecules side by side.
KINDS = ["random", "structure", "gyroid"]
PIPE, WHOLE = "pipe", "tess3"
# What tess3 may take; larger inputs than memory has room for are left to the pipe.
WHOLE_BYTES_PER_POINT = 600


class Growth3:
    """Both ways on inputs of several kinds and sizes, in one contest."""

    def __init__(self, inputs, flags):
        self.inputs, self.flags = inputs, flags
        self.mesh = flags.dir / "mesh.spm"
        self.sizes = flags.sizes or (QUICK_SIZES if flags.quick else SIZES)
        self.source = copies.source(flags.structures)
        self.points_max = machine.memory_bytes() // WHOLE_BYTES_PER_POINT

    def run(self):
        """One row per kind, way and size."""
        chosen = [(kind, way, size) for kind in KINDS for way in (PIPE, WHOLE) for size in self.sizes]
        chosen = [which for which in chosen if which[1] == PIPE or count_of(which[2]) <= self.points_max]
        contestants = {which: self.contestant(*which) for which in chosen}
        compete(list(contestants.values()), self.flags, self.flags.growth_limit)
        rows = [row(*which, contestant) for which, contestant in contestants.items()]
        for facts in rows:
            facts.update(against(contestants, *(facts[key] for key in ("kind", "way", "size"))))
            facts["source"] = self.source.name if facts["kind"] == "structure" else ""
        if not self.flags.keep:
            self.inputs.remove_big()
        return rows

    def contestant(self, kind, way, size):
        is_real = kind == "structure"
        points = self.inputs.copied(self.source, size) if is_real else self.inputs.file(f"{kind}-{size}.spm")
        written = ["--quiet", "--stats=json", "-o", self.mesh]
        finalize = [program("spfinalize"), "--quiet", "--octree", "--temp-dir", self.flags.dir, points]
        ways = {PIPE: [finalize, [program("spdelaunay3d"), *written]], WHOLE: [[program("tess3"), *written, points]]}
        return Contestant(f"{kind} {size}, {way}", ways[way], self.mesh, threads=0)


def row(kind, way, size, contestant):
    """The figures of one input; without `seconds` if the run failed."""
    facts = {"kind": kind, "way": way, "size": size, "points": count_of(size), "failure": contestant.failure}
    if not contestant.runs:
        return facts
    said = {key: contestant.said(key) for key in ("tetrahedra", "residual_max", "width")}
    times = {"seconds": contestant.wall, "us_per_point": contestant.wall / facts["points"] * 1e6}
    runs = [run.as_json() for run in contestant.runs]
    return {**facts, **times, "peak_bytes": contestant.peaks, **said, "runs": runs}


def against(contestants, kind, way, size):
    """Ratios of the pipe's time and memory to those of tess3."""
    whole = contestants.get((kind, WHOLE, size))
    if way != PIPE or not whole:
        return {}
    pipe = contestants[kind, PIPE, size]
    pairs = {of: ratios.ratio(pipe.by_round(value), whole.by_round(value)) for of, value in VALUES.items()}
    return {of: ratio for of, ratio in pairs.items() if ratio}


VALUES = {"time_ratio": wall, "memory_ratio": memory}
HEAD = ["points", "program", "wall s", "us/point", "peak MB", "widest residual", "width", "tetrahedra"]
HEAD += ["time to tess3's", "memory to tess3's"]


def cells(facts):
    start = [f"{facts['kind']} {facts['source']}".strip() + f", {facts['points']:,}", facts["way"]]
    if "seconds" not in facts:
        return [*start, facts["failure"], *[""] * (len(HEAD) - 3)]
    peaks = " + ".join(number(peak / 1e6, 0) for peak in facts["peak_bytes"])
    counts = ["" if facts[key] is None else f"{facts[key]:,.0f}" for key in ("residual_max", "width", "tetrahedra")]
    compared = [str(facts.get(of, "")) for of in VALUES]
    return [*start, number(facts["seconds"]), number(facts["us_per_point"], 3), peaks, *counts, *compared]


def markdown(rows):
    note = conclusions.note([len(facts.get("runs", ())) for facts in rows])
    title = "### Growth in space\n\nThe pipe is `spfinalize --octree | spdelaunay3d`; both from stream to mesh file.\n\n"
    return f"{title}{table(HEAD, [cells(facts) for facts in rows])}\n{note}"


def as_json(rows):
    return [{key: value.as_json() if key in VALUES else value for key, value in facts.items()} for facts in rows]
