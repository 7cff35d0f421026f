"""Generated tiles, and what one pipe makes of them: the reference of all comparisons."""

import dataclasses
import pathlib
import subprocess

import compare

SCRIPTS = pathlib.Path(__file__).resolve().parents[2]


@dataclasses.dataclass
class Survey:
    """Tiles, how a plan divides them, and the results of one pipe."""

    programs: pathlib.Path
    folder: pathlib.Path
    tiles: list
    leaf_points: int
    step: float
    interval: float
    filters: list
    space: bool = False

    @property
    def mesh(self):
        return self.folder / "whole.spm"

    @property
    def raster(self):
        return self.folder / "whole.tif"

    @property
    def lines(self):
        return self.folder / "whole.geojson"

    def make(self):
        """Runs the pipe."""
        kernel = "spdelaunay3d" if self.space else "spdelaunay2d"
        points = subprocess.run(
            [self.programs / "spfinalize", "-q", *self.filters, *self.tiles], stdout=subprocess.PIPE, check=True
        ).stdout
        subprocess.run([self.programs / kernel, "-q", "-o", self.mesh], input=points, check=True)
        if not self.space:
            spdem = [self.programs / "spdem", "-q", self.mesh]
            subprocess.run([*spdem, "--step", str(self.step), "-o", self.raster], check=True)
            subprocess.run([*spdem, "--contours", str(self.interval), "-o", self.lines], check=True)
        self.expected = compare.joined(self.programs, self.mesh)
        return self

    def plan(self, path):
        """Plans the tiles; returns the number of nodes."""
        subprocess.run(
            [self.programs / "spfinalize", "-q", "--plan", path, "--leaf-points", str(self.leaf_points)]
            + [*self.filters, *self.tiles],
            check=True,
        )
        return self.nodes(path)

    def nodes(self, path):
        """Fields of each node: number, stage, kind, children, points, name."""
        listed = compare.output_of(self.programs / "spnode", "list", path)
        return [line.split() for line in listed.splitlines()]

    def check(self, mesh, plan, parts):
        """Compares a mesh in parts with that of the pipe, as our programs and as the independent reader read it."""
        compare.same_mesh(self.expected, compare.joined(self.programs, mesh))
        lost, doubled = compare.accounted(plan, parts)
        if lost or doubled:
            raise compare.Difference(f"points: {lost} lost, {doubled} doubled, as the reports say")

    def check_parts(self, plan, parts):
        """Compares the parts, which the independent reader reads one by one, with the mesh of the pipe."""
        names = [compare.file_of(parts, node[5], ".spm") for node in self.nodes(plan)]
        compare.same_mesh(self.expected, compare.separate(names))


def generate(programs, folder, points, seed, grid, build):
    """Tiles of a synthetic survey."""
    folder.mkdir()
    built = programs / "examples" / "gen_lidar"
    command = [SCRIPTS / "gen-lidar"] if build or not built.exists() else [built]
    command += ["--points", str(points), "--seed", str(seed), "--tiles", f"{grid}x{grid}", "-o", folder / "tile.laz"]
    subprocess.run(list(map(str, command)), check=True, capture_output=True)
    return sorted(folder.glob("*.laz"))
