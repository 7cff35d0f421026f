"""From a LAZ tile to a TIN, a raster, contour lines and heights above the ground, all as arrays of numpy."""

from pathlib import Path

import numpy as np

import spmesh

tile = Path(__file__).resolve().parents[3] / "tests" / "data" / "lareunion.laz"

with spmesh.tin(tile, keep_class=None, duplicates="lowest") as terrain:
    report = terrain.audit()  # Raises ProgramError if the mesh is wrong.
    mesh = terrain.read()
    print(f"{len(mesh.xyz)} vertices, {len(mesh.simplices)} triangles; audit of {len(report)} parts passed")

    elevations = terrain.dem(step=1)
    slopes = terrain.dem(step=1, kind="slope")
    print(f"{elevations.array.shape[0]} by {elevations.array.shape[1]} cells in {elevations.crs or 'an unknown system'}")
    print(f"elevations up to {np.nanmax(elevations.array):.1f}, slopes of {np.nanmedian(slopes.array):.0f} degrees")

    lines = terrain.contours(5)
    print(f"{len(lines)} contour lines at {len({elevation for elevation, _ in lines})} elevations")

    x, y, z = mesh.xyz[:1000].T
    above = terrain.heights(np.column_stack([x, y, z + 2]))
    print(f"points 2 m above vertices are {above.min():.2f} to {above.max():.2f} above the TIN")
