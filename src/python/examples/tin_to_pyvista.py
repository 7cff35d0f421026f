"""A TIN as a mesh of pyvista, with an attribute at each vertex, written as VTP."""

import sys

import numpy as np

import spmesh

try:
    import pyvista
except ImportError:
    print("pyvista is not installed", file=sys.stderr)
    raise SystemExit(77)

xyz = np.random.default_rng(5).uniform(0, 100, (2000, 3))
tin = spmesh.tin(xyz, attributes={"distance": np.hypot(xyz[:, 0], xyz[:, 1])}).read()

faces = np.column_stack([np.full(len(tin.simplices), 3), tin.simplices])
surface = pyvista.PolyData(tin.xyz, faces.ravel())
surface.point_data["distance"] = tin.attribute("distance").filled(np.nan)
surface.save("tin.vtp")
print("tin.vtp is written")
