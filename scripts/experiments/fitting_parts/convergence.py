"""The order of convergence of interpolation on grids of knots: 3 for quadratic splines."""

import bases
import numpy as np
from functions import exponential, lattice, rms, wave
from tsv import write_tables
from work import progress

CELLS, QUICK_CELLS = (5, 10, 20, 40), (5, 10)
FUNCTIONS = {"sin(xy) exp(x+y)": exponential, "sin(pi x)": wave}
SITES = 401
HEAD = ("cells", "functions", *(f"{word} {name}" for name in FUNCTIONS for word in ("max", "order", "rms", "order of rms")))


def run(work, flags):
    rows, before = [], None
    for cells in QUICK_CELLS if flags.quick else CELLS:
        count, errors = measure(work, cells)
        orders = np.log2(np.divide(before, errors)) if before else None
        cells_of = [f"{error:.3g}" for error in errors]
        orders = ["" if orders is None else f"{order:.2f}" for order in (orders if orders is not None else errors)]
        rows.append([cells, count, *(cell for pair in zip(cells_of, orders) for cell in pair)])
        before = errors
        progress(f"convergence: {rows[-1]}")
    write_tables(flags.out / "convergence", HEAD, rows)


def measure(work, cells):
    """The number of functions, and the greatest and the mean error for each interpolated function."""
    knots, sites, errors = bases.delaunay(work, bases.grid(work, cells)), lattice(SITES), []
    for function in FUNCTIONS.values():
        work.interpolate(knots, lambda x, y: function(x / cells, y / cells))
        found = work.values(cells * sites) - function(*sites.T)
        errors += [float(np.abs(found).max()), rms(found)]
    return work.summary(knots)["functions"], errors
