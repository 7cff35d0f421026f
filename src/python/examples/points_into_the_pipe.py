"""Points of numpy through spfinalize, spdelaunay2d and spdem to a GeoTIFF, with a check that every stage ended well."""

import subprocess

import numpy as np
import spmesh

x, y = np.random.default_rng(7).uniform(0, 1000, (2, 20000))
hills = np.column_stack([x, y, 40 * np.sin(x / 90) * np.cos(y / 120)])

commands = (["spfinalize", "-"], ["spdelaunay2d"], ["spdem", "--step", "5", "-o", "hills.tif"])
stages, source = [], subprocess.PIPE
for command in commands:
    last = command is commands[-1]
    stage = subprocess.Popen(command, stdin=source, stdout=None if last else subprocess.PIPE)
    if stages:
        source.close()  # Only the next stage reads from it now.
    stages.append(stage)
    source = stage.stdout

with stages[0].stdin as pipe:
    spmesh.write_points(pipe, hills, scale=0.01)
for command, stage in zip(commands, stages):
    if stage.wait() != 0:
        raise SystemExit(f"{command[0]} failed with exit code {stage.returncode}")
print("hills.tif is written")
