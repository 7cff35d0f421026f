"""Reads and writes spmesh streams as numpy arrays.

    import spmesh

    mesh = spmesh.read("terrain.spm")           # everything: mesh.xyz, mesh.simplices, mesh.attribute("intensity")
    for block in spmesh.open("terrain.spm"):    # block by block, in bounded memory
        ...
    spmesh.write_points("points.spm", xyz, attributes={"intensity": intensity}, scale=0.001)

The format is described in formats/spmesh.md of the project.
"""

from .blocks import (
    FARAWAY,
    NOT_A_VERTEX,
    Cells,
    Cells4,
    Coefficients,
    Configurations,
    End,
    Function,
    Functions,
    Labels,
    OpenSegments,
    Patch,
    Points,
    Points4,
    Region,
    ResidualPoints,
    Segments,
    Simplices4,
    Walls,
)
from .arguments import attributes_of
from .attributes import Attribute
from .errors import MalformedError, SpmeshError, TooNewError, UpstreamError
from .header import Header, Tree
from .meshes import write_points, write_tetrahedra, write_triangles
from .reader import Reader
from .reader import Reader as open  # noqa: A004
from .whole import Stream, read
from .writer import Writer

__version__ = "0.1.0"

__all__ = [
    "Attribute", "attributes_of", "Cells", "Cells4", "Coefficients", "Configurations", "End", "FARAWAY",
    "Function", "Functions", "Header", "Labels", "MalformedError", "NOT_A_VERTEX", "open", "OpenSegments",
    "Patch", "Points", "Points4", "read", "Reader", "Region", "ResidualPoints", "Segments", "Simplices4", "SpmeshError",
    "Stream", "TooNewError", "Tree", "UpstreamError", "Walls", "write_points", "write_tetrahedra", "write_triangles", "Writer",
]
