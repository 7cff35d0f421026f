"""Runs scipy's tests with the classes of spmesh in place of its own. See scripts/check-scipy."""

import sys
from pathlib import Path

import pytest
import scipy
import scipy.interpolate._interpnd as interpnd
import scipy.spatial._qhull as qhull

import spmesh

# Parts of the names of tests that fail, and why.
REASONS = {
    "test_find_simplex": "expects Qhull's numbering of two triangles",
    "test_2d_square": "expects Qhull's numbering of two triangles",
    "test_convex_hull": "expects Qhull's order of the edges of a square",
    "test_degenerate_barycentric_transforms": "allows 22 triangles too flat for a transform, and there are 31",
    "test_more_barycentric_transforms": "four and five dimensions",
    "test_nd_simplex": "four and more dimensions",
    "test_joggle": "expects that QJ makes vertices of duplicates",
    "test_furthest_site": "furthest sites are not supported",
    **{f"test_incremental[random-{ndim}d": f"{ndim} dimensions" for ndim in range(4, 9)},
}


class Outcomes:
    """Collects the names of tests by outcome."""

    def __init__(self):
        self.passed, self.failed, self.skipped = [], [], []

    def pytest_runtest_logreport(self, report):
        if report.when == "call" or report.outcome == "skipped":
            getattr(self, report.outcome).append(report.nodeid.split("::", 1)[1])


def main():
    qhull.Delaunay = spmesh.Delaunay
    qhull.tsearch = lambda mesh, xi: mesh.find_simplex(xi)
    interpnd.LinearNDInterpolator = spmesh.LinearNDInterpolator
    tests = Path(scipy.__file__).parent
    files = [tests / "spatial/tests/test_qhull.py", tests / "interpolate/tests/test_interpnd.py"]
    wanted = "TestUtilities or TestVertexNeighborVertices or TestDelaunay or TestLinearNDInterpolation"
    outcomes = Outcomes()
    pytest.main(["-q", "--tb=no", "-W", "ignore", "-p", "no:cacheprovider", "-k", wanted, *map(str, files)], [outcomes])
    reasons = {test: [why for part, why in REASONS.items() if part in test] for test in outcomes.failed}
    for test, why in reasons.items():
        print(f"failed: {test}: {why[0] if why else 'UNEXPECTED'}")
    print(f"{len(outcomes.passed)} passed, {len(outcomes.failed)} failed, {len(outcomes.skipped)} skipped")
    if not outcomes.passed or not all(reasons.values()):
        sys.exit(1)


if __name__ == "__main__":
    main()
