"""Franke's function at scattered points, with and without noise."""

import layouts
import numpy as np
from functions import franke, lattice
from predictions import HEAD, PEERS, Ours, compare
from tsv import write_tables
from work import progress

SEED = 1
COUNTS, QUICK_COUNTS = (1_000, 10_000), (500,)
NOISES = (0.0, 0.05)
SITES = 101
# Distance of sites from the border, where the triangles of points are long.
MARGIN = 0.05


def run(work, flags):
    rows = []
    for count in QUICK_COUNTS if flags.quick else COUNTS:
        for noise in NOISES:
            progress(f"franke: {count} points, noise {noise}")
            points, sites = scattered(count, noise)
            found = compare(work, ways(count), points, sites, franke(*sites.T))
            rows += [[count, noise, *row] for row in found]
    write_tables(flags.out / "franke", ("points", "noise", "way", *HEAD), rows)


def ways(count):
    cells = round((count / 6) ** 0.5)
    return [
        Ours("splinefit"),
        Ours("splinefit --lambda gcv", ("--lambda", "gcv")),
        Ours("splinefit --knots GRID --lambda gcv", ("--lambda", "gcv"), layouts.grid(cells)),
        *PEERS,
    ]


def scattered(count, noise):
    """Points with values, including the corners, and sites on an inner grid."""
    random = np.random.default_rng(SEED)
    corners = [[0, 0], [0, 1], [1, 0], [1, 1]]
    places = np.vstack([corners, random.random((count - len(corners), 2))])
    values = franke(*places.T) + noise * random.standard_normal(count)
    return np.column_stack([places, values]), MARGIN + (1 - 2 * MARGIN) * lattice(SITES)
