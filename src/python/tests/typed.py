"""A script of a user, which strict checkers of types find clean: see test_types.py. It is not run."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

import spmesh


def terrain(files: list[Path]) -> npt.NDArray[np.float32]:
    with spmesh.tin(files, keep_class=[2, 8], crs="EPSG:2154", duplicates="lowest") as tin:
        raster = tin.dem(step=0.5, kind="slope", bounds=(0, 0, 10, 10))
        array, transform, crs = raster
        print(array.max(), transform[0], crs or "unknown", raster.bounds)
        for elevation, line in tin.contours(5):
            print(elevation + 1, line.shape)
        print(tin.heights(np.zeros((5, 3))).mean(), tin.audit(), tin.path.name, tin.header.bounds)
        mesh = tin.read()
    following = mesh.simplices + np.arange(1)
    print(following.dtype, mesh.xyz[mesh.simplices].shape, mesh.rows.dtype, mesh.attribute("intensity").mean())
    return array


def spline(xyz: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    surface = spmesh.fit(xyz, step=2.0, robust="tukey")
    return surface.evaluate(xyz[:, :2], derivative="slope") + surface.evaluate(xyz[:, :2], derivative=1)[:, 0]


def chains() -> dict[str, np.ndarray]:
    molecule = spmesh.molecule("1aki.cif", classes="polymer")
    table = molecule.sasa(per="residue", volumes=True)
    print(table["area"].sum(), molecule.contacts(as_frame=True).head(), molecule.pockets()["volume"])
    return table


def blocks(name: str) -> int:
    found = 0
    with spmesh.open(name) as reader:
        for block in reader:
            if isinstance(block, spmesh.Patch):
                found += int(block.simplices_by_id.max())
            elif isinstance(block, spmesh.End):
                print(block.totals["points"])
    return found


def write(xyz: npt.NDArray[np.float64], triangles: npt.NDArray[np.int32]) -> None:
    spmesh.write_points("a.spm", xyz, {"a": np.zeros(5)}, scale=0.01, offset=(0, 0, 0))
    spmesh.write_triangles("b.spm", xyz, triangles, orient=True)
    spmesh.write_tetrahedra("c.spm", xyz.tolist(), [[0, 1, 2, 3]])
    with spmesh.Writer("d.spm", spmesh.Header(has_elevation=True)) as writer:
        writer.points(xyz)


def pipe() -> bytes:
    try:
        with spmesh.programs.Pipe(["spfinalize", Path("a.laz")], ["spdelaunay2d"]) as running:
            print(spmesh.read(running.stdout).totals)
        return spmesh.programs.run(["spinfo", Path("-a.spm")], input=b"")
    except spmesh.ProgramError as error:
        raise SystemExit(error.code) from error
