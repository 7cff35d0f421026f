"""Growth of time and memory on shapes of points that a grid or a curve through the box of the points resolves badly:
strips, combs, lines, planes, spirals, clusters within clusters, spheres after rounding."""

import array
import math
import multiprocessing
import random
import subprocess

import inputs
import measure

SHAPES = "shapes"
SIZES = (10_000, 100_000, 1_000_000)
QUICK_SIZES = (3_000, 10_000)
# Diagrams in four dimensions have some 200 cells a point. Configurations are for knots, which are few.
SIZES_4D = (1_000, 3_000, 10_000)
LIMIT_S = 120.0
SEED = 20_261_122
CENTRES = [[random.Random(4 * i + axis).random() for axis in range(4)] for i in range(10)]


def uniform(count, dims, draw):
    return [[draw.random() for _ in range(dims)] for _ in range(count)]


# Each of the plane: a list of [x, y].


def strip(count, draw, gap=1.0, jitter=0.0):
    """Two rows; the points of a row are one unit apart."""
    rows = [[i // 2 + jitter * draw.random(), gap * (i % 2)] for i in range(count)]
    draw.shuffle(rows)
    return rows


def slanted(count, draw):
    """A strip that lies aslant."""
    return [[0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y] for x, y in strip(count, draw)]


def zigzag(count, draw):
    """One row in which neighbours lie on two sides of a line."""
    return [[i, 1e-3 * (i % 2)] for i in range(count)]


def comb(count, draw):
    """Teeth far apart, each a strip."""
    per_tooth = max(2, math.isqrt(count))
    return [[1e4 * (i // per_tooth) + 1e-3 * (i % 2), (i % per_tooth) // 2] for i in range(count)]


def segments(count, draw, dims=2):
    """Points on a hundred lines at all angles."""
    lines = [uniform(2, dims, draw) for _ in range(100)]
    points = []
    for i in range(count):
        a, b = lines[i % 100]
        at = draw.random()
        points.append([p + at * (q - p) for p, q in zip(a, b)])
    return points


def spiral(count, draw):
    turns = 20 * math.tau
    angles = [turns * math.sqrt((i + 1) / count) for i in range(count)]
    return [[angle * math.cos(angle), angle * math.sin(angle)] for angle in angles]


def clusters(count, draw, dims=2):
    """Ten clusters of ten clusters, and so on, each a thousandth as wide."""
    points = []
    for _ in range(count):
        point, width = [0.0] * dims, 1.0
        for _ in range(4):
            place = CENTRES[draw.randrange(len(CENTRES))]
            point = [p + width * x for p, x in zip(point, place)]
            width *= 1e-3
        points.append([p + width * draw.random() for p in point])
    return points


def pairs(count, draw, dims=2):
    """Pairs of points 1e-12 apart."""
    half = uniform((count + 1) // 2, dims, draw)
    return (half + [[x + 1e-12 * draw.random() for x in point] for point in half])[:count]


def far(count, draw):
    """All points within 1e-6, but for two a billion away."""
    points = [[1e-6 * x for x in point] for point in uniform(count - 2, 2, draw)]
    return [*points, [1e9, 1e9], [-1e9, 1e9 - 7]]


def circle(count, draw):
    angles = [math.tau * draw.random() for _ in range(count)]
    return [[math.cos(angle), math.sin(angle)] for angle in angles]


def exponential(count, draw, dims=2):
    """Coordinates over two hundred binary orders of magnitude."""
    return [[2.0 ** draw.uniform(-100, 100) for _ in range(dims)] for _ in range(count)]


# Of space. There is no helix: its triangulation has a number of tetrahedra that grows with the square.


def lines(count, draw):
    """Four parallel lines, a thousandth of a unit apart."""
    return [[i // 4, 1e-3 * (i % 2), 1e-3 * (i // 2 % 2)] for i in range(count)]


def planes(count, draw):
    """Two parallel planes, each a square grid."""
    side = max(1, math.isqrt(count // 2))
    return [[i // 2 % side, i // 2 // side, 1e-3 * (i % 2)] for i in range(count)]


def rods(count, draw):
    """Points of a long thin box."""
    return [[count * x, y, z] for x, y, z in uniform(count, 3, draw)]


def sphere(count, draw):
    """Points rounded from a sphere."""
    points = []
    for _ in range(count):
        point = [draw.gauss(0, 1) for _ in range(3)]
        length = math.sqrt(sum(x * x for x in point))
        points.append([x / length for x in point])
    return points


PLANE = {
    "uniform": lambda n, draw: uniform(n, 2, draw),
    "strip": strip,
    "strip, gap 0.001": lambda n, draw: strip(n, draw, gap=1e-3),
    "strip, uneven": lambda n, draw: strip(n, draw, jitter=0.9),
    "strip, upright": lambda n, draw: [[y, x] for x, y in strip(n, draw)],
    "strip, aslant": slanted,
    "zigzag": zigzag,
    "comb": comb,
    "lines": segments,
    "spiral": spiral,
    "circle": circle,
    "clusters": clusters,
    "pairs": pairs,
    "two far": far,
    "exponential": exponential,
}
SPACE = {
    "uniform": lambda n, draw: uniform(n, 3, draw),
    "4 lines": lines,
    "2 planes": planes,
    "rod": rods,
    "sphere": sphere,
    "clusters": lambda n, draw: clusters(n, draw, 3),
    "pairs": lambda n, draw: pairs(n, draw, 3),
    "exponential": lambda n, draw: exponential(n, draw, 3),
}
SPACE_TIME = {
    "uniform": lambda n, draw: uniform(n, 4, draw),
    "clusters": lambda n, draw: clusters(n, draw, 4),
    "pairs": lambda n, draw: pairs(n, draw, 4),
    "exponential": lambda n, draw: exponential(n, draw, 4),
}


def heap(count, draw):
    """Most knots at one place."""
    few = max(3, count // 100)
    return [[0.5, 0.5]] * (count - few) + uniform(few, 2, draw)


KNOTS = {
    "uniform": lambda n, draw: uniform(n, 2, draw),
    "one place": heap,
    "strip": strip,
    "circle": circle,
    "clusters": clusters,
    "exponential": exponential,
}
ENGINES = {
    "spdelaunay2d": (PLANE, SIZES),
    "tess3": (SPACE, SIZES),
    "spdelaunay3d": (SPACE, SIZES),
    "dd4": (SPACE_TIME, SIZES_4D),
    "configgen": (KNOTS, SIZES_4D),
}


class Shapes:
    """Runs every engine on its shapes. The stream is made beforehand and is not timed."""

    def __init__(self, flags, files):
        self.flags = flags
        self.folder = files.folder

    def run(self, only=()):
        rows = []
        for engine, (shapes, sizes) in ENGINES.items():
            if only and engine not in only:
                continue
            for shape in shapes:
                row = self.row(engine, shape, shapes[shape], QUICK_SIZES if self.flags.quick else sizes)
                # The first row of an engine is the uniform one.
                first = next((other for other in rows if other["engine"] == engine), row)
                row["ratio"] = max((s / u for (_, s), (_, u) in zip(row["times"], first["times"])), default=None)
                rows.append(row)
                print(markdown_row(rows[-1]), flush=True)
        return rows

    def row(self, engine, shape, make, sizes):
        """Median seconds and peak megabytes for each size, up to the first that takes too long. Seconds are those
        of the processor: programs run on one thread, and other work on the machine changes them little."""
        times, peaks = [], []
        for count in sizes:
            stream = self.stream(engine, shape, make, count)
            command = [inputs.program(engine), "-q", stream, "-o", "/dev/null"]
            if engine == "configgen":
                command[1:1] = ["--degree", "2"]
            if engine.startswith(("spdelaunay", "tess3")):
                command[1:1] = ["--threads", "1"]
            contestant = measure.Contestant(engine, [command])
            for _ in range(self.flags.rounds):
                run = measure.run(contestant, LIMIT_S, self.flags.pins)
                if run.failure:
                    return {"engine": engine, "shape": shape, "times": times, "peaks": peaks, "failure": run.failure}
                contestant.runs.append(run)
            times.append((count, contestant.cpu))
            peaks.append(contestant.peaks[0] / 1e6)
        return {"engine": engine, "shape": shape, "times": times, "peaks": peaks, "failure": ""}

    def stream(self, engine, shape, make, count):
        """The points of a shape, as the engine reads them."""
        octree = engine in ("tess3", "spdelaunay3d")
        dims = 4 if engine == "dd4" else 3 if octree else 2
        as_text = engine in ("dd4", "configgen")
        stem = f"shape{dims}-{shape.replace(' ', '_').replace(',', '')}-{count}"
        raw = self.folder / f"{stem}.{'txt' if as_text else 'f64'}"
        if not raw.exists():
            # In a process of its own, whose memory no program inherits: see measure.floor_bytes.
            maker = multiprocessing.Process(target=write, args=(raw, make, count, as_text))
            maker.start()
            maker.join()
            if maker.exitcode:
                raise SystemExit(f"{stem} could not be made")
        if as_text:
            return raw
        stream = raw.with_suffix(".spm")
        if not stream.exists():
            finalize = [inputs.program("spfinalize"), "-q", "--raw", "f64le", raw, "-o", stream]
            finalize[1:1] = ["--octree"] if octree else []
            subprocess.run(finalize, check=True)
        return stream


def write(path, make, count, as_text):
    points = make(count, random.Random(SEED))
    if as_text:
        path.write_text("".join(" ".join(map(repr, map(float, point))) + "\n" for point in points))
        return
    numbers = array.array("d", (float(x) for point in points for x in (*point, 0.0)[:3]))
    path.write_bytes(numbers.tobytes())


def exponent(times):
    """The slope of the line through the logarithms of sizes and seconds, by least squares."""
    if len(times) < 2:
        return None
    logs = [(math.log(count), math.log(max(seconds, 1e-3))) for count, seconds in times]
    mean_x, mean_y = (sum(column) / len(logs) for column in zip(*logs))
    return sum((x - mean_x) * (y - mean_y) for x, y in logs) / sum((x - mean_x) ** 2 for x, _ in logs)


def markdown_row(row):
    slope = exponent(row["times"])
    seconds = ", ".join(f"{time:.2f}" for _, time in row["times"])
    peak = f"{max(row['peaks']):.0f}" if row["peaks"] else "-"
    slope = "-" if slope is None else f"{slope:.2f}"
    ratio = "-" if row["ratio"] is None else f"{row['ratio']:.1f}"
    return f"| {row['engine']} | {row['shape']} | {seconds} {row['failure']} | {slope} | {ratio} | {peak} |"


def markdown(rows):
    head = ["| engine | shape | s | exponent | times uniform | MB |", "|---|---|---|---|---|---|"]
    return "\n".join([*head, *map(markdown_row, rows)])
