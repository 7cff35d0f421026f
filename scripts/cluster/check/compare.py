"""What two results have to share: simplices by coordinates, cells of rasters, contour lines."""

import array
import collections
import json
import pathlib
import struct
import subprocess
import sys

READER = pathlib.Path(__file__).resolve().parents[2] / "spmesh_reader.py"
SHOWN = 3


class Difference(Exception):
    """Results that should be equal are not."""


def output_of(*command, **more):
    """What a program prints; a failure is a difference, since the results are there to be read."""
    done = subprocess.run(list(map(str, command)), capture_output=True, **more)
    if done.returncode != 0:
        said = done.stderr.decode(errors="replace").strip().splitlines()
        raise Difference(f"{pathlib.Path(command[0]).name} exits with {done.returncode}: {' / '.join(said[-3:])}")
    return done.stdout.decode()


def file_of(parts, name, ending):
    """A file of a node: .spm, .rest.spm or .json."""
    return parts / name[:2] / (name + ending)


# --- Meshes ---------------------------------------------------------------------------------------------------


class Mesh:
    """Vertices and simplices of a text twin, by coordinates."""

    def __init__(self):
        self.vertices = collections.Counter()
        self.simplices = collections.Counter()

    def add(self, twin):
        places = []
        for line in twin.splitlines():
            kind, _, rest = line.partition(" ")
            if kind == "v":
                places.append(rest)
            elif kind in ("f", "c"):
                corners = [places[int(word) - 1] for word in rest.split()]
                self.simplices[oriented(corners)] += 1
        self.vertices.update(places)


def oriented(corners):
    """The corners in an order that only depends on which they are and on the orientation."""
    order = sorted(range(len(corners)), key=corners.__getitem__)
    swaps = sum(a > b for i, a in enumerate(order) for b in order[i + 1 :])
    return (swaps % 2, *sorted(corners))


def joined(programs, mesh):
    """A mesh as our own programs read it: one stream, or a manifest."""
    found = Mesh()
    found.add(output_of(programs / "spconvert", "-q", mesh, "--to", "text"))
    return found


def separate(parts):
    """Parts as the independent reader reads each of them. Vertices that several parts share are counted once."""
    found, shared = Mesh(), set()
    for part in parts:
        one = Mesh()
        one.add(output_of(sys.executable, READER, part))
        found.simplices.update(one.simplices)
        shared.update(one.vertices)
    found.vertices.update(dict.fromkeys(shared, 1))
    return found


def same_counts(what, expected, found):
    """Raises unless two counters are equal; says how many are lost and how many are doubled or new."""
    lost, more = expected - found, found - expected
    if lost or more:
        shown = [f"lost {item}" for item in list(lost)[:SHOWN]] + [f"too many {item}" for item in list(more)[:SHOWN]]
        raise Difference(f"{what}: {lost.total()} lost, {more.total()} doubled or new: {'; '.join(shown)}")


def same_mesh(expected, found):
    same_counts("vertices", expected.vertices, found.vertices)
    same_counts("simplices", expected.simplices, found.simplices)


# --- Points ---------------------------------------------------------------------------------------------------


def accounted(plan_path, parts):
    """Points that the headers state and that reports of leaves do not account for, as (lost, doubled)."""
    plan = json.loads(pathlib.Path(plan_path).read_text())
    found = collections.Counter()
    for node in plan["nodes"]:
        report = json.loads(file_of(parts, node["name"], ".json").read_text())
        counted = sum(count["points"] for count in report["files"])
        if counted + report.get("added", 0) != report["points"] + report["dropped"]:
            raise Difference(f"node {node['number']}: {counted} points are not those triangulated and dropped")
        for count in report["files"]:
            found[count["file"]] += count["points"]
    pairs = [(file["points"], found[file["path"]]) for file in plan["files"]]
    return sum(max(0, a - b) for a, b in pairs), sum(max(0, b - a) for a, b in pairs)


# --- Rasters --------------------------------------------------------------------------------------------------


class Raster:
    """Cells as GDAL reads them, and where they are."""

    def __init__(self, path, folder):
        facts = json.loads(output_of("gdalinfo", "-json", path))
        raw = folder / "raster.raw"
        output_of("gdal_translate", "-q", "-ot", "Float32", "-of", "ENVI", path, raw)
        self.width, self.height = facts["size"]
        self.left, self.step, _, self.top, _, _ = facts["geoTransform"]
        self.no_data = facts["bands"][0]["noDataValue"]
        self.bits = array.array("I", raw.read_bytes())

    def row(self, row, column, count):
        start = row * self.width + column
        return self.bits[start : start + count]

    def known(self):
        """Number of cells with data."""
        return len(self.bits) - self.bits.count(struct.unpack("I", struct.pack("f", self.no_data))[0])


def same_raster(expected_path, found_path, folder):
    """Raises unless both have the same bits in all cells; the second may have a margin without data."""
    expected, found = Raster(expected_path, folder), Raster(found_path, folder)
    if (expected.step, expected.no_data) != (found.step, found.no_data):
        raise Difference(f"rasters: steps {expected.step}, {found.step}, no data {expected.no_data}, {found.no_data}")
    column = round((expected.left - found.left) / expected.step)
    row = round((found.top - expected.top) / expected.step)
    if min(row, column) < 0 or row + expected.height > found.height or column + expected.width > found.width:
        raise Difference(f"rasters: {found.width} by {found.height} cells do not cover the expected ones")
    differ = 0
    for i in range(expected.height):
        ours, theirs = expected.row(i, 0, expected.width), found.row(row + i, column, expected.width)
        if ours != theirs:
            differ += sum(a != b for a, b in zip(ours, theirs))
    if differ or expected.known() != found.known():
        cells = len(expected.bits)
        raise Difference(
            f"rasters: {differ} of {cells} cells differ; {expected.known()} and {found.known()} have data"
        )
    return len(expected.bits)


# --- Lines ----------------------------------------------------------------------------------------------------


def lines(path):
    """Contour lines, whatever their order, direction, and start if they are closed."""
    found = collections.Counter()
    for feature in json.loads(path.read_text())["features"]:
        geometry = feature["geometry"]
        several = geometry["coordinates"] if geometry["type"].startswith("Multi") else [geometry["coordinates"]]
        for corners in several:
            found[json.dumps(feature["properties"], sort_keys=True), directed(list(map(tuple, corners)))] += 1
    return found


def directed(corners):
    """The corners of a line from the start and in the direction that make the least list."""
    if len(corners) > 2 and corners[0] == corners[-1]:
        ring = corners[:-1]
        start = ring.index(min(ring))
        ring = ring[start:] + ring[:start]
        back = ring[:1] + ring[:0:-1]
        return tuple(min(ring, back))
    return tuple(min(corners, corners[::-1]))


def same_lines(expected_path, found_path):
    expected = lines(expected_path)
    same_counts("contour lines", expected, lines(found_path))
    return expected.total()
