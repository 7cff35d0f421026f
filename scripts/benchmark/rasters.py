"""Elevation models from files of points, and peers that make them."""

import json
import math
import shutil
import subprocess

from inputs import count_of, program
from measure import Contestant

STEP = 1.0
GDAL, PDAL = "gdal_grid -a linear", "PDAL filters.delaunay, filters.faceraster"


def contestants(inputs, name, folder):
    """All programs that make an elevation model of flight lines with the same cells, and the absent ones with
    the reason."""
    size = name.split("-")[1]
    las = inputs.file(f"flight-{size}.las")
    points = inputs.finalized(las)
    grid = cells(points)
    ours = [[program("spfinalize"), "--quiet", las], [program("spdelaunay2d"), "--quiet"]]
    output = folder / "terrain.tif"
    raster = [program("spdem"), "--step", STEP, "--stats=json", "--quiet", "-o", output]
    found, absent = [Contestant("spmesh", [*ours, raster], output, threads=0)], {}
    if shutil.which("gdal_grid"):
        layer = vector_layer(points, las.with_suffix(".fgb"))
        found.append(Contestant(GDAL, [gdal(layer, grid, folder / "gdal.tif")], folder / "gdal.tif"))
    else:
        absent[GDAL] = "not installed: apt-get install gdal-bin"
    if shutil.which("pdal"):
        found.append(Contestant(PDAL, [pdal(las, grid, folder)], folder / "pdal.tif"))
    else:
        absent[PDAL] = "not installed: apt-get install pdal, where Debian has it"
    return count_of(size), found, absent


def cells(points):
    """Left, bottom, right and top of the cells that spdem makes by default, and the numbers of columns and
    rows."""
    bounds = json.loads(subprocess.run([program("spinfo"), "--json", points], capture_output=True, check=True).stdout)["bounds"]
    low = [math.floor(x / STEP) * STEP for x in bounds["min"][:2]]
    high = [math.ceil(x / STEP) * STEP for x in bounds["max"][:2]]
    return [*low, *high, *[round((b - a) / STEP) for a, b in zip(low, high)]]


def vector_layer(points, path):
    """The points as FlatGeobuf, a binary format, in the order of the stream, because GDAL cannot read LAS."""
    if not path.exists():
        part = path.with_name("part-" + path.name)
        table = part.with_suffix(".csv")
        text = subprocess.Popen([program("spconvert"), points, "--to", "text"], stdout=subprocess.PIPE, text=True)
        with table.open("w") as file:
            file.write("x,y,z\n")
            file.writelines(line[2:].replace(" ", ",") for line in text.stdout if line.startswith("v "))
        names = [word for axis in "xyz" for word in ("-oo", f"{axis.upper()}_POSSIBLE_NAMES={axis}")]
        form = ["-f", "FlatGeobuf", "-lco", "SPATIAL_INDEX=NO", "-nlt", "PointZ", "-nln", "points", "-select", ""]
        subprocess.run(["ogr2ogr", *form, *names, part, table], check=True)
        table.unlink()
        part.rename(path)
    return path


def gdal(layer, grid, output):
    left, bottom, right, top, columns, rows = grid
    place = ["-txe", left, right, "-tye", top, bottom, "-outsize", columns, rows]
    form = ["-of", "GTiff", "-ot", "Float32", "-co", "TILED=YES", "-co", "COMPRESS=DEFLATE", "-co", "PREDICTOR=3"]
    return ["gdal_grid", "-q", "-a", "linear:radius=0:nodata=-9999", *place, *form, layer, output]


def pdal(las, grid, folder):
    left, bottom, _, _, columns, rows = grid
    place = {"resolution": STEP, "origin_x": left, "origin_y": bottom, "width": columns, "height": rows}
    form = "TILED=YES,COMPRESS=DEFLATE,PREDICTOR=3"
    steps = [
        {"type": "readers.las", "filename": str(las)},
        {"type": "filters.delaunay"},
        {"type": "filters.faceraster", "nodata": -9999, **place},
        {"type": "writers.raster", "filename": str(folder / "pdal.tif"), "gdalopts": form, "nodata": -9999, "data_type": "float32"},
    ]
    pipeline = folder / "pdal.json"
    pipeline.write_text(json.dumps(steps, indent=1))
    return ["pdal", "pipeline", pipeline]
