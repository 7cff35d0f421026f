"""The order of convergence of least squares at scattered points, for degrees 1 to 4: one more than the degree.

Knots are on a grid that is moved at random, over the unit square with clamped corners, or over a larger square
without. In the larger one, functions next to its border have few points or none, and least squares are worst there.
So errors are also measured a tenth inside of the border.
"""

import numpy as np
from functions import exponential, lattice, rms
from tsv import write_tables
from work import ours, progress

DEGREES = (1, 2, 3, 4)
CELLS, QUICK_CELLS = (4, 8, 16, 32), (4, 8)
# Grid cells around the unit square, if corners are not clamped; and distance that knots are moved, in cells.
AROUND, MOVED = 3, 0.25
POINTS_PER_CELL = 60
SITES = 201
SEED = 1
MARGIN = 0.1
MEASURED = ("max", "rms", "order of rms", "max inside", "order inside", "rms inside", "order of rms inside")
HEAD = ("knots", "degree", "cells", "functions", "undetermined", *MEASURED)


def run(work, flags):
    rows = []
    for border in ("clamped", "free"):
        for degree in DEGREES:
            before = None
            for cells in QUICK_CELLS if flags.quick else CELLS:
                counts, errors = measure(work, border, degree, cells)
                orders = [""] * len(errors)
                if before:
                    orders = [f"{order:.2f}" for order in np.log2(np.divide(before, errors))]
                found = [f"{error:.2e}" for error in errors]
                pairs = [cell for pair in zip(found, orders) for cell in pair]
                # The greatest error of all has no order: it depends on the points next to the border.
                rows.append([border, degree, cells, *counts, pairs[0], *pairs[2:]])
                progress(f"rates: {rows[-1]}")
                before = errors
    write_tables(flags.out / "rates", HEAD, rows)


def measure(work, border, degree, cells):
    """The numbers of functions and of those that points leave undetermined; the greatest and the mean error,
    everywhere and inside."""
    random = np.random.default_rng(SEED)
    places = grid(cells, 0 if border == "clamped" else AROUND)
    knots = work.table("knots.xy", moved(places, random, border, cells))
    layout = work.folder / "configurations.spm"
    flags = ["--boundary", "clamped"] if border == "clamped" else []
    ours("configgen", "--quiet", "--degree", degree - 1, *flags, knots, "-o", layout)
    places = random.random((POINTS_PER_CELL * cells**2, 2))
    points = work.table("points.xyz", np.column_stack([places, exponential(*places.T)]))
    counts = work.fit(points, "--knots", layout, "--degree", degree)
    sites = lattice(SITES)
    errors = np.abs(work.values(sites) - exponential(*sites.T))
    is_inside = ((sites > MARGIN) & (sites < 1 - MARGIN)).all(1)
    found = [float(errors.max()), rms(errors), float(errors[is_inside].max()), rms(errors[is_inside])]
    return [counts["functions"], counts["undetermined"]], found


def grid(cells, around):
    """Knots of a grid on the unit square, with further cells around it."""
    steps = np.arange(-around, cells + around + 1) / cells
    return np.array([[x, y] for y in steps for x in steps])


def moved(knots, random, border, cells):
    """Knots moved at random: all of them, or those inside the unit square."""
    moves = MOVED / cells * random.uniform(-1, 1, knots.shape)
    if border == "clamped":
        moves[((knots == 0) | (knots == 1)).any(1)] = 0
    return knots + moves
