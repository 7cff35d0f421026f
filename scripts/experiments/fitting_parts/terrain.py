"""A LIDAR tile: part of its ground points is held back and predicted from the others; then again with gross
errors.

Only held points inside the convex hull of the others count. D is the distance of points: the root of the area
per point.
"""

import subprocess

import inputs
import numpy as np
from predictions import HEAD, KRIGING, PEERS, Ours, compare
from tsv import write_tables
from work import progress

SEED = 1
GROUND = "2"
HELD_SHARE, GROSS_SHARE = 0.1, 0.01
GROSS_M = (10.0, 100.0)
QUICK_POINTS = 5_000


def run(work, flags):
    if not flags.terrain:
        progress("terrain: left out, as it needs --terrain FILE")
        return
    for path in flags.terrain:
        points = ground(work, path)
        if flags.quick:
            points = points[:QUICK_POINTS]
        fitted, held = held_back(points)
        progress(f"terrain: {path.name}: {len(points)} points, {len(held)} held back in the hull")
        rows = [["", *row] for row in compare(work, ways(), fitted, held[:, :2], held[:, 2])]
        if not flags.clean:
            spoilt = with_gross_errors(fitted)
            rows += [["1 %", *row] for row in compare(work, robust_ways(), spoilt, held[:, :2], held[:, 2])]
        write_tables(flags.out / f"terrain-{path.stem}", ("gross errors", "way", *HEAD), rows)


def ways():
    return [
        Ours("splinefit"),
        Ours("splinefit --step D", step=1.0),
        Ours("splinefit --step 0.7*D", step=0.7),
        Ours("splinefit --step D --lambda gcv", ("--lambda", "gcv"), step=1.0),
        Ours("splinefit --step D --lambda cv", ("--lambda", "cv"), step=1.0),
        *PEERS,
        *KRIGING,
    ]


def robust_ways():
    robust = [Ours(f"splinefit --robust {loss}", ("--robust", loss)) for loss in ("huber", "tukey")]
    dense = Ours("splinefit --robust huber --step D", ("--robust", "huber"), step=1.0)
    return [Ours("splinefit"), *robust, dense, *PEERS]


def ground(work, path):
    """Ground points in the order of the file, without later duplicates in x and y."""
    stream = work.folder / "ground.spa"
    finalize = [inputs.program("spfinalize"), "--quiet", "--keep-class", GROUND, path]
    convert = [inputs.program("spconvert"), "--quiet", "--to", "spa", "-o", stream]
    with subprocess.Popen(finalize, stdout=subprocess.PIPE) as source:
        subprocess.run(convert, stdin=source.stdout, check=True)
    lines = (line.split() for line in stream.read_text().splitlines() if line.startswith("v "))
    points = np.array([[float(word) for word in words[1:4]] for words in lines])
    _, firsts = np.unique(points[:, :2], axis=0, return_index=True)
    return points[np.sort(firsts)]


def held_back(points):
    """The points to fit, and the held points inside their hull."""
    order = np.random.default_rng(SEED).permutation(len(points))
    count = round(HELD_SHARE * len(points))
    fitted, held = points[order[count:]], points[order[:count]]
    return fitted, held[inside(fitted[:, :2], held[:, :2])]


def inside(places, sites):
    """Which sites are inside the convex hull of places, left of all its edges."""
    hull = convex(places)
    edges = np.roll(hull, -1, axis=0) - hull
    sides = edges[:, 0] * (sites[:, None, 1] - hull[:, 1]) - edges[:, 1] * (sites[:, None, 0] - hull[:, 0])
    return (sides > 0).all(1)


def convex(places):
    """The convex hull, counterclockwise (Andrew 1979); exact, because coordinates have few digits."""
    ordered = sorted(map(tuple, places))
    return np.array(chain(ordered) + chain(ordered[::-1]))


def chain(ordered):
    kept = []
    for place in ordered:
        while len(kept) > 1 and turn(*kept[-2:], place) <= 0:
            kept.pop()
        kept.append(place)
    return kept[:-1]


def turn(p, q, r):
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def with_gross_errors(points):
    """Moves some points far above or below the ground."""
    random = np.random.default_rng(SEED)
    spoilt = points.copy()
    chosen = random.choice(len(points), round(GROSS_SHARE * len(points)), replace=False)
    spoilt[chosen, 2] += random.choice([-1.0, 1.0], len(chosen)) * random.uniform(*GROSS_M, len(chosen))
    return spoilt
