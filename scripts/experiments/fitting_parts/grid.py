"""Figure 8.8: interpolation over knots on a grid, with bases of different triangulations."""

import bases
import errormap
import numpy as np
from functions import exponential, lattice, rms, wave
from tsv import write_tables
from work import Failed, progress

CELLS, SITES = 5, 101
FUNCTIONS = {"sin(xy) exp(x+y)": exponential, "sin(pi x)": wave}
SEEDS, QUICK_SEEDS = range(1, 6), range(1, 2)
# The range of errors with colours, as powers of ten.
POWERS = (-6, -2)
HEAD = ("basis", "seed", "functions", "condition", *(f"{word} {name}" for name in FUNCTIONS for word in ("max", "rms")))


def run(work, flags):
    seeds = QUICK_SEEDS if flags.quick else SEEDS
    ways = [
        ("Delaunay", "", bases.delaunay),
        ("ZP links", "", bases.box_links),
        *(("25 random flips", seed, with_seed(25, seed)) for seed in seeds),
        *(("100 random flips", seed, with_seed(100, seed)) for seed in seeds),
        ("aligned with y", "", bases.aligned),
    ]
    rows, maps = [], {}
    for name, seed, make in ways:
        row, errors = measure(work, make)
        rows.append([name, seed, *row])
        maps.setdefault(name, errors)
        progress(f"grid: {name} {seed}: {row}")
    write_tables(flags.out / "figure-8.8", HEAD, rows)
    (flags.out / "figure-8.8.svg").write_text(draw({name: errors for name, errors in maps.items() if errors}))


def with_seed(count, seed):
    return lambda work, knots: bases.flipped(count)(work, knots, seed)


def measure(work, make):
    """Functions, condition and errors as texts, and the errors of each function at all sites."""
    configurations = make(work, bases.grid(work, CELLS))
    said = work.summary(configurations)
    try:
        errors = [interpolated(work, configurations, function) for function in FUNCTIONS.values()]
    except Failed:
        return [said["functions"], "none: functions depend on each other at Greville sites"], None
    row = [said["functions"], f"{said['condition']['value']:.2f}"]
    row += [f"{number:.3g}" for each in errors for number in (np.abs(each).max(), rms(each))]
    return row, errors


def interpolated(work, configurations, function):
    """Errors at grid sites of the spline that has a function's values at Greville sites."""
    work.interpolate(configurations, lambda x, y: function(x / CELLS, y / CELLS))
    sites = lattice(SITES)
    return work.values(CELLS * sites) - function(*sites.T)


def draw(maps):
    rows = []
    for place, name in enumerate(FUNCTIONS):
        of_function = [errors[place].reshape(SITES, SITES) for errors in maps.values()]
        rows.append((name, [(errors, f"max {np.abs(errors).max():.2e}") for errors in of_function]))
    alt = "Errors of quadratic splines that interpolate two functions over 6 by 6 knots, for five bases"
    return errormap.draw(alt, list(maps), rows, POWERS)
