"""Rasters that are drawn leaf by leaf: together they must be the raster of one pipe, cell by cell."""

import subprocess
import sys

import compare

CLUSTER = compare.READER.parent / "cluster"
# Products, and flags of spdem that make them. All but the first need cells, or triangles, of neighbours.
PRODUCTS = {
    "elevation": [],
    "slope": ["--kind", "slope"],
    "hillshade": ["--kind", "hillshade", "--multidirectional"],
    "filled": ["--kill", "2", "--fill", "9"],
}


def check(survey, work, products, say):
    """Compares products of the collected mesh, and the windows of its leaves."""
    step = survey.step
    command = [sys.executable, CLUSTER / "rasters", work.plan, work.mesh, "--step", step]
    windows = [list(map(int, line.split())) for line in compare.output_of(*command, "--windows").splitlines()]
    divides(windows)
    for product in products:
        folder, flags = work.folder / product, PRODUCTS[product]
        (folder / "rasters").mkdir(parents=True)
        leaves = [window[0] for window in windows]
        names = compare.output_of(
            *command, "-o", "rasters", f"--flags={' '.join(flags)}", *leaves, cwd=folder, env=work.environment
        )
        (folder / "whole.txt").write_text(names)
        compare.output_of(CLUSTER / "mosaic", folder, "whole")
        spdem = [survey.programs / "spdem", "-q", "--step", str(step), *flags, survey.mesh, "-o", folder / "one.tif"]
        subprocess.run(spdem, check=True)
        cells = compare.same_raster(folder / "one.tif", folder / "whole.vrt", folder)
        say(f"{product}, drawn in {len(names.splitlines())} windows: the same {cells} cells")


def divides(windows):
    """Raises unless windows divide a rectangle: none overlap, and none is missing."""
    filled = [window[1:] for window in windows if window[1] <= window[2] and window[3] <= window[4]]
    for i, (left, right, bottom, top) in enumerate(filled):
        for a, b, c, d in filled[:i]:
            if a <= right and left <= b and c <= top and bottom <= d:
                raise compare.Difference(f"windows overlap: {filled[i]} and {[a, b, c, d]}")
    cells = sum((right - left + 1) * (top - bottom + 1) for left, right, bottom, top in filled)
    lefts, rights, bottoms, tops = zip(*filled)
    whole = (max(rights) - min(lefts) + 1) * (max(tops) - min(bottoms) + 1)
    if cells != whole:
        raise compare.Difference(f"windows have {cells} of {whole} cells")
