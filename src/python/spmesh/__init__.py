"""Triangulates points, interpolates, and reads and writes spmesh streams as numpy arrays.

    import spmesh

    spmesh.Delaunay(points).find_simplex(xi)    # as scipy.spatial.Delaunay, exact; points in numpy arrays

    mesh = spmesh.read("terrain.spm")           # everything: mesh.xyz, mesh.simplices, mesh.attribute("intensity")
    for block in spmesh.open("terrain.spm"):    # block by block, in bounded memory
        ...
    spmesh.write_points("points.spm", xyz, attributes={"intensity": intensity}, scale=0.001)

    spmesh.tin("tile.laz").dem(step=1).array    # a raster of ground points; `tin`, `fit` and `molecule` run the programs

The format is described in formats/spmesh.md of the project.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import programs
    from .arguments import attributes_of
    from .attributes import Attribute
    from .blocks import (
        FARAWAY, NOT_A_VERTEX, Block, Cells, Cells4, Coefficients, Configurations, End, Function, Functions,
        Labels, OpenSegments, Patch, Points, Points4, Region, ResidualPoints, Segments, Simplices4, Walls,
    )
    from .delaunay import Delaunay
    from .errors import MalformedError, SpmeshError, TooNewError, UpstreamError
    from .header import Header, Tree
    from .interpolation import LinearNDInterpolator, NaturalNeighborInterpolator
    from .meshes import write_points, write_tetrahedra, write_triangles
    from .molecules import Molecule, molecule
    from .programs import ProgramError, ProgramNotFoundError
    from .raster import Raster
    from .reader import Reader
    from .reader import Reader as open  # noqa: A004
    from .splines import Fit, fit
    from .terrain import Tin, tin
    from .whole import Stream, read
    from .writer import Writer

__version__ = "0.1.0"

__all__ = [
    "Attribute", "attributes_of", "Block", "Cells", "Cells4", "Coefficients", "Configurations", "Delaunay", "End", "FARAWAY",
    "Fit", "fit", "Function", "Functions", "Header", "Labels", "LinearNDInterpolator", "MalformedError", "Molecule",
    "molecule", "NaturalNeighborInterpolator", "NOT_A_VERTEX", "open", "OpenSegments", "Patch", "Points", "Points4", "ProgramError", "ProgramNotFoundError",
    "programs", "Raster", "read", "Reader", "Region", "ResidualPoints", "Segments", "Simplices4", "SpmeshError",
    "Stream", "Tin", "tin", "TooNewError", "Tree", "UpstreamError", "Walls", "write_points", "write_tetrahedra",
    "write_triangles", "Writer",
]

# What each module has. Modules are loaded when a name of theirs is used: numpy alone takes a tenth of a second.
_MODULES = {
    "arguments": "attributes_of",
    "attributes": "Attribute",
    "blocks": "FARAWAY NOT_A_VERTEX Block Cells Cells4 Coefficients Configurations End Function Functions "
    "Labels OpenSegments Patch Points Points4 Region ResidualPoints Segments Simplices4 Walls",
    "delaunay": "Delaunay",
    "errors": "MalformedError SpmeshError TooNewError UpstreamError",
    "header": "Header Tree",
    "interpolation": "LinearNDInterpolator NaturalNeighborInterpolator",
    "meshes": "write_points write_tetrahedra write_triangles",
    "molecules": "Molecule molecule",
    "programs": "ProgramError ProgramNotFoundError",
    "raster": "Raster",
    "reader": "Reader",
    "splines": "Fit fit",
    "terrain": "Tin tin",
    "whole": "Stream read",
    "writer": "Writer",
}
_PLACES = {name: module for module, names in _MODULES.items() for name in names.split()}


def __getattr__(name: str) -> object:
    if name == "open":
        found: object = __getattr__("Reader")
    elif name == "programs" or name in _MODULES:
        found = import_module(f".{name}", __name__)
    elif name in _PLACES:
        found = getattr(import_module(f".{_PLACES[name]}", __name__), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
