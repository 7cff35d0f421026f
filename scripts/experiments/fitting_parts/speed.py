"""Time and memory of a fit to many points and of its raster, by our program and by peers.

Before the clock starts, the points are in a LAS file for us, in a numpy file for scipy, and in the database
of GRASS. Rasters are written to files.
"""

import sys

import grass
import inputs
import layouts
import measure
import numpy as np
from predictions import HERE, has_scipy
from tsv import write_tables
from work import Failed, progress

COUNT, QUICK_COUNT, MANY = 1_000_000, 20_000, 10_000_000
# Cells of knots along each side of the square, for about 20,000 of our functions, and cells of rasters.
KNOT_CELLS, RASTER_CELLS = 97, 2_000
QUICK_KNOT_CELLS = 15
LIMIT_S = 150.0
SQUARE = 1_000.0
HEAD = ("points", "program", "unknowns", "seconds", "range", "times ours", "CPU s", "peak MB")


def run(work, flags):
    count, cells = (QUICK_COUNT, QUICK_KNOT_CELLS) if flags.quick else (COUNT, KNOT_CELLS)
    files = make(work, count)
    knots = layouts.grid(cells)(work, np.array([[0.0, 0.0], [SQUARE, SQUARE]]))
    unknowns = work.fit(files[0], "--knots", knots)["functions"]
    contestants = [ours(work, files, knots), *peers(work, files, unknowns)]
    measure.compete([c for c in contestants if not c.failure], flags.runs, LIMIT_S)
    rows = [row(count, c, contestants[0], unknowns) for c in contestants]
    if not flags.quick:
        many = ours(work, make(work, MANY), knots)
        measure.compete([many], 1, LIMIT_S)
        rows.append(row(MANY, many, many, unknowns))
    write_tables(flags.out / "speed", HEAD, rows)


def make(work, count):
    """Writes files of points in a separate process: the size of a large process would hide that of the small
    programs it starts."""
    files = [work.folder / f"{count}{ending}" for ending in (".las", ".npy", ".txt")]
    made = measure.run([[sys.executable, HERE / "survey_program.py", str(count), str(SQUARE), *files]], LIMIT_S)
    if made.failure:
        raise Failed(made.failure)
    return files


def ours(work, files, knots):
    splinefit = inputs.program("splinefit")
    fit = [splinefit, "fit", "--quiet", "--knots", knots, files[0]]
    box = f"0,0,{SQUARE:g},{SQUARE:g}"
    out = work.folder / "ours.tif"
    evaluation = [splinefit, "eval", "--quiet", "-", "--columns", str(RASTER_CELLS), "--bounds", box, "-o", out]
    return measure.Contestant("splinefit fit, splinefit eval", [fit, evaluation], str(out))


def peers(work, files, unknowns):
    bicubic = measure.Contestant("bicubic, least squares (scipy)", [])
    if has_scipy():
        out = work.folder / "bicubic.npy"
        words = [HERE / "peer_program.py", "bicubic", files[1], str(RASTER_CELLS), out, str(unknowns)]
        bicubic = measure.Contestant(bicubic.name, [[sys.executable, *words]], str(out))
    else:
        bicubic.failure = "scipy is not installed"
    return [bicubic, *grass.contestants(work, files[2], SQUARE, unknowns, RASTER_CELLS)]


def row(count, contestant, ours, unknowns):
    if not contestant.runs:
        return [count, contestant.name, f"none: {contestant.failure}"]
    walls = [run.wall for run in contestant.runs]
    span = f"{min(walls):.2f}-{max(walls):.2f}"
    peaks = " + ".join(f"{peak / 1e6:.0f}" for peak in contestant.peaks)
    progress(f"speed: {contestant.name}: {contestant.wall:.2f} s")
    cpu = contestant.median(lambda run: run.cpu)
    times = [f"{contestant.wall:.2f}", span, f"{contestant.wall / ours.wall:.2f}", f"{cpu:.2f}", peaks]
    return [count, contestant.name, unknowns, *times]
