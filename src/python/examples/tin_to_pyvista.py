"""A TIN as a mesh of pyvista, with an attribute at each vertex, written as VTP."""

import io
import subprocess
import sys

import numpy as np
import spmesh

try:
    import pyvista
except ImportError:
    print("pyvista is not installed", file=sys.stderr)
    raise SystemExit(77)

xyz = np.random.default_rng(5).uniform(0, 100, (2000, 3))
points = io.BytesIO()
spmesh.write_points(points, xyz, {"distance": np.hypot(xyz[:, 0], xyz[:, 1])}, scale=0.001)
finalize = ["spfinalize", "--attributes", "distance", "-"]
finalized = subprocess.run(finalize, input=points.getvalue(), stdout=subprocess.PIPE, check=True).stdout
tin = spmesh.read(io.BytesIO(subprocess.run(["spdelaunay2d"], input=finalized, stdout=subprocess.PIPE, check=True).stdout))

faces = np.column_stack([np.full(len(tin.simplices), 3), tin.simplices.astype(int)])
surface = pyvista.PolyData(tin.xyz, faces.ravel())
surface.point_data["distance"] = tin.attribute("distance").filled(np.nan)
surface.save("tin.vtp")
print("tin.vtp is written")
