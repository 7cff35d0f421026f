"""A TIN as a picture, coloured by elevation, drawn by matplotlib."""

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
tin = spmesh.tin(np.column_stack([x, y, np.hypot(x - 50, y - 50)])).read()

x, y, z = tin.xyz.T
plt.tripcolor(x, y, tin.simplices, z, shading="gouraud")
plt.gca().set_aspect("equal")
plt.colorbar(label="elevation")
plt.savefig("tin.png", dpi=100)
print("tin.png is written")
