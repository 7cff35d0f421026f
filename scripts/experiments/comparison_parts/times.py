"""Figures 3.6, 3.7 and 3.8: processor time per point, by number of points."""

import pathlib
import random
import statistics
import struct

import measure
import structures as files
from installer import Missing
from peers3 import Peers3
from programs import progress, write_tsv
from svg import BLUE, GREEN, ORANGE, PURPLE, RED, TEXT, Curve, Panel, axis_from_zero, axis_of_counts, document
from target import EXAMPLES

KERNEL = EXAMPLES / "kernel3_time"
BITS, SEED = 10, 1
SIZES, QUICK_SIZES = (10_000, 30_000, 100_000), (1_000, 3_000)
# Copies of the largest structure along each axis.
COPIES = ((2, 1, 1),)
# Least ratio of the sizes of two structures.
RATIO = 1.5
GAP = 3.0
LIMIT_S = 300
# The greatest sets of atoms for slow programs.
POINTS_MAX = {"Qhull": 50_000}
# Names, colours, and how to call the program: the recipe of the installer, or a way of our kernel.
PROGRAMS = {
    "spmesh": (PURPLE, "rounds"),
    "thesis, floating point": (TEXT, "float"),
    "HXT": (GREEN, "hxt"),
    "Geogram": (BLUE, "geogram"),
    "CGAL": (ORANGE, "cgal"),
    "TetGen": (RED, "tetgen"),
    "Qhull": ("#a08a2c", "qhull"),
}
CGAL_ORDERS = {"random": RED, "brio": ORANGE, "hilbert": BLUE}
OUR_ORDERS = {"random": RED, "pass": ORANGE, "rounds": BLUE}
HEAD = ("program", "input", "points", "microseconds", "rounds")


def random_points(flags):
    """Sets as in the thesis: coordinates of 10 bits, for which floating point is exact."""
    place = folder(flags, "random")
    sets = [(f"random {count}", count, made(place, count)) for count in sizes(flags)]
    figure(flags, "3.6", "Random points of 10 bits", sets, programs(flags))


def structures(flags):
    """Structures of many sizes, and copies of the largest side by side."""
    place = folder(flags, "structures")
    found, _ = files.prepare(flags.structures, place)
    counted = sorted((path.stat().st_size // 24, name, path) for name, path in found)
    if not counted:
        raise SystemExit(f"{flags.structures} has no structure of {files.ATOMS_MIN} atoms: name a folder with --structures")
    chosen = []
    for count, name, path in reversed(counted):
        if not chosen or count * RATIO <= chosen[-1][1]:
            chosen.append((name, count, path))
    name, count, path = chosen[0]
    for copies in COPIES:
        times = copies[0] * copies[1] * copies[2]
        chosen.append((f"{name} x {times}", count * times, replicated(path, copies)))
    chosen.sort(key=lambda of_set: of_set[1])
    figure(flags, "3.7", "Atoms of structures", chosen, programs(flags), POINTS_MAX)


def orders(flags):
    """CGAL's hierarchy, which needs no hint, and our kernel, which starts at the last point."""
    place = folder(flags, "random")
    sets = [(f"random {count}", count, made(place, count)) for count in sizes(flags)]
    contestants = {f"spmesh, {name}": (colour, ours(name)) for name, colour in OUR_ORDERS.items()}
    if peer := installed(flags, "cgal_orders"):
        of_cgal = {f"CGAL, {name}": (colour, order(peer, name)) for name, colour in CGAL_ORDERS.items()}
        contestants = of_cgal | contestants
    rows = measured(flags, sets, contestants)
    write_tsv(flags.out / "figure-3.8.tsv", HEAD, rows)
    panels = []
    for left, program, title in ((56, "CGAL", "CGAL's Delaunay hierarchy"), (496, "spmesh", "The kernel of spmesh")):
        own = {name: colour for name, (colour, _) in contestants.items() if name.startswith(program)}
        panels += panel(left, f"{title}: µs per point", [row for row in rows if row[0] in own], own)
    alt = "Time per point of CGAL's Delaunay hierarchy and of spmesh under three orders of insertion"
    (flags.out / "figure-3.8.svg").write_text(document(930, 380, alt, panels))


def figure(flags, number, title, sets, contestants, points_max=None):
    rows = measured(flags, sets, contestants, points_max or {})
    write_tsv(flags.out / f"figure-{number}.tsv", HEAD, rows)
    colours = {name: colour for name, (colour, _) in contestants.items()}
    fast = {name: colour for name, colour in colours.items() if name != "Qhull"}
    parts = [
        *panel(56, f"{title}: µs per point", rows, colours),
        *panel(546, "The same without Qhull", [row for row in rows if row[0] in fast], fast),
    ]
    alt = f"Processor time per point of {len(colours)} programs. {title}"
    (flags.out / f"figure-{number}.svg").write_text(document(1040, 380, alt, parts))


def panel(left, title, rows, colours):
    counts = [count for _, _, count, _, _ in rows]
    round_counts = [factor * 10**power for power in range(9) for factor in (1, 3)]
    low = max(count for count in round_counts if count <= min(counts))
    high = min(count for count in round_counts if count >= max(counts))
    across = axis_of_counts([count for count in round_counts if low <= count <= high], "points")
    up = axis_from_zero(max(time for *_, time, _ in rows))
    curves = [Curve(name, colour, sorted((count, time) for program, _, count, time, _ in rows if program == name))
              for name, colour in colours.items()]  # fmt: skip
    return Panel(left, left + 290, 64, 320, title, across, up).draw(curves)


def measured(flags, sets, contestants, points_max=()):
    """A row for each program and set; programs take turns."""
    few = folder(flags, "random") / "four.f64"
    few.write_bytes(b"".join(struct.pack("<3d", *point) for point in ((0, 0, 0), (9, 0, 0), (0, 9, 0), (0, 0, 9))))
    start = cpu_times(flags, few, contestants)
    rows = []
    for name, count, path in sets:
        small = {key: of_key for key, of_key in contestants.items() if key not in points_max or count <= points_max[key]}
        for program, times in cpu_times(flags, path, small).items():
            if times:
                time = statistics.median(times) - statistics.median(start[program])
                rows.append((program, name, count, f"{time / count * 1e6:.3f}", len(times)))
        progress(f"{name}: {count} points")
    return [(program, name, count, float(time), rounds) for program, name, count, time, rounds in rows]


def cpu_times(flags, path, contestants):
    """Processor times of each program for a file of points; none if it fails."""
    runs = [measure.Contestant(name, [command(path)]) for name, (_, command) in contestants.items()]
    measure.compete(runs, flags.rounds, LIMIT_S)
    return {contestant.name: [run.cpu for run in contestant.runs] for contestant in runs}


def programs(flags):
    found = {}
    for name, (colour, recipe) in PROGRAMS.items():
        if recipe in ("rounds", "float"):
            found[name] = colour, ours(recipe)
        elif peer := installed(flags, recipe):
            found[name] = colour, order(peer, 1)
    return found


def ours(way):
    return lambda path: [KERNEL, path, "--way", way]


def order(program, word):
    return lambda path: [program, path, word]


def installed(flags, recipe):
    try:
        program, version = getattr(Peers3(flags.dir), recipe)()
    except Missing as reason:
        progress(f"{recipe}: left out, {reason}")
        return None
    progress(f"{recipe}: {version}")
    return program


def sizes(flags):
    return QUICK_SIZES if flags.quick else SIZES


def made(place, count):
    """Random points, all different."""
    path = place / f"{count}.f64"
    generator = random.Random(f"{count} {BITS} {SEED}")
    numbers = generator.sample(range(1 << 3 * BITS), count)
    points = ([number >> shift & (1 << BITS) - 1 for shift in (0, BITS, 2 * BITS)] for number in numbers)
    path.write_bytes(b"".join(struct.pack("<3d", *point) for point in points))
    return path


def replicated(path, copies):
    points = [struct.unpack_from("<3d", path.read_bytes(), start) for start in range(0, path.stat().st_size, 24)]
    sides = [max(p[axis] for p in points) - min(p[axis] for p in points) + GAP for axis in range(3)]
    places = [(x, y, z) for x in range(copies[0]) for y in range(copies[1]) for z in range(copies[2])]
    target = path.with_suffix(f".{len(places)}.f64")
    moved = (tuple(c + n * side for c, n, side in zip(p, place, sides)) for place in places for p in points)
    target.write_bytes(b"".join(struct.pack("<3d", *point) for point in moved))
    return target


def folder(flags, name):
    place = pathlib.Path(flags.dir) / "comparison" / name
    place.mkdir(parents=True, exist_ok=True)
    return place
