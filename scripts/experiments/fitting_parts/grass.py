"""Bicubic splines of GRASS (v.surf.bspline, Debian's grass-core)."""

import shutil

from installer import Missing, apt_install, debian_version
from measure import Contestant, run

NAME = "v.surf.bspline, bicubic (GRASS)"
IMPORT_LIMIT_S = 900.0


def contestants(work, table, side, unknowns, raster_cells):
    """A list of one contestant, which has failed with the reason if GRASS cannot be installed."""
    try:
        return [contestant(work, table, side, unknowns, raster_cells)]
    except Missing as reason:
        return [Contestant(NAME, [], failure=str(reason))]


def contestant(work, table, side, unknowns, raster_cells):
    if not shutil.which("grass"):
        apt_install("--no-install-recommends", "grass-core")
    place = work.folder / "grass"
    mapset = place / "PERMANENT"
    done("grass", "-c", "XY", "-e", place)
    done("grass", mapset, "--exec", "v.in.ascii", "-z", "-t", "-b", f"input={table}", "output=points", "x=1", "y=2", "z=3")
    box = ["n=" + str(side), "s=0", "e=" + str(side), "w=0"]
    done("grass", mapset, "--exec", "g.region", *box, f"rows={raster_cells}", f"cols={raster_cells}")
    step = f"{side / unknowns**0.5:.6f}"
    spline = ["input=points", "raster_output=surface", "method=bicubic", f"ew_step={step}", f"ns_step={step}"]
    command = ["grass", mapset, "--exec", "v.surf.bspline", "--overwrite", "--quiet", *spline]
    return Contestant(f"{NAME} {debian_version('grass-core')}", [command])


def done(*command):
    result = run([command], IMPORT_LIMIT_S)
    if result.failure:
        raise Missing(f"grass: {result.failure}")
