"""Points of numpy through spfinalize, spdelaunay2d and spdem to a GeoTIFF; a failure of any program raises ProgramError."""

import numpy as np

import spmesh

x, y = np.random.default_rng(7).uniform(0, 1000, (2, 20000))
hills = np.column_stack([x, y, 40 * np.sin(x / 90) * np.cos(y / 120)])

spmesh.programs.run(
    ["spfinalize", "-"], ["spdelaunay2d"], ["spdem", "--step", 5],
    input=lambda pipe: spmesh.write_points(pipe, hills, scale=0.01),
    output="hills.tif",
)
print("hills.tif is written")
