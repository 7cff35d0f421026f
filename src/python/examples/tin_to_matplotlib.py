"""A TIN as a picture, coloured by elevation: spfinalize and spdelaunay2d make it, matplotlib draws it."""

import io
import subprocess
import sys

import numpy as np
import spmesh

try:
    import matplotlib
except ImportError:
    print("matplotlib is not installed", file=sys.stderr)
    raise SystemExit(77)
matplotlib.use("Agg")
import matplotlib.pyplot as plt

x, y = np.random.default_rng(3).uniform(0, 100, (2, 2000))
points = io.BytesIO()
spmesh.write_points(points, np.column_stack([x, y, np.hypot(x - 50, y - 50)]), scale=0.001)
finalized = subprocess.run(["spfinalize", "-"], input=points.getvalue(), stdout=subprocess.PIPE, check=True).stdout
mesh = subprocess.run(["spdelaunay2d"], input=finalized, stdout=subprocess.PIPE, check=True).stdout

tin = spmesh.read(io.BytesIO(mesh))
x, y, z = tin.xyz.T
plt.tripcolor(x, y, tin.simplices.astype(int), z, shading="gouraud")
plt.gca().set_aspect("equal")
plt.colorbar(label="elevation")
plt.savefig("tin.png", dpi=100)
print("tin.png is written")
