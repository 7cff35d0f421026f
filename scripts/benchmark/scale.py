"""One long run: the tiles of a large survey to an elevation model, and to an audit. Not compared with anything."""

import struct
import subprocess
import sys

import measure
import target
from inputs import count_of, program
from measure import Contestant
from tables import number, table

SCALE = "scale"
TILES = "8x8"
LIMIT_S = 6 * 3600.0
SEED = 1
# Of LAS headers: the minor version, the count up to version 1.3, and the count from 1.4 on.
MINOR_AT, OLD_COUNT_AT, COUNT_AT = 25, 107, 247


class Scale:
    """Runs each pipe once, without a warm-up, and samples the disk that temporary files take."""

    def __init__(self, inputs, flags):
        self.inputs, self.flags = inputs, flags
        self.temporary = flags.dir / "temporary"

    def run(self, name):
        """The figures of both pipes, for a set such as scale-1G."""
        tiles = self.tiles(name.split("-")[1])
        facts = {"name": name, "tiles": len(tiles), "points": sum(map(points_of, tiles))}
        facts["input_bytes"] = sum(path.stat().st_size for path in tiles)
        self.temporary.mkdir(exist_ok=True)
        return {**facts, "pipes": [self.figures(pipe) for pipe in self.pipes(tiles)]}

    def tiles(self, size):
        """The tiles of --tiles-dir, which are made if there are none."""
        folder = self.flags.tiles_dir or self.inputs.folder / f"tiles-{size}"
        if not any(folder.glob("*.la[sz]")):
            part = folder.with_name(f"part-{folder.name}")
            part.mkdir(parents=True, exist_ok=True)
            command = [target.ROOT / "scripts" / "gen-lidar", "--points", count_of(size), "--seed", SEED]
            subprocess.run([*map(str, command), "--tiles", TILES, "-o", str(part / "tile.laz")], check=True)
            if folder.exists():
                folder.rmdir()
            part.rename(folder)
        return sorted(folder.glob("*.la[sz]"))

    def pipes(self, tiles):
        mesh = [[program("spfinalize"), "--quiet", *tiles], [program("spdelaunay2d"), "--stats=json"]]
        self.dem = self.flags.dir / "dem.tif"
        model = [*mesh, [program("spdem"), "--quiet", "-o", self.dem]]
        audit = [*mesh, [program("spinfo"), "--audit"]]
        pipes = (("DEM", model), ("audit", audit))
        return [Contestant(name, pipe, threads=0, temporary=self.temporary) for name, pipe in pipes]

    def figures(self, pipe):
        print(f"  {pipe.name}", file=sys.stderr, flush=True)
        with measure.alone(self.flags.lock):
            run = measure.run(pipe, self.flags.limit or LIMIT_S, self.flags.pins)
        written = self.dem.stat().st_size if self.dem.exists() else 0
        measure.remove(self.dem)
        names = [command[0].name for command in pipe.commands]
        processes = [dict(zip(("name", "cpu_s", "peak_bytes"), row)) for row in zip(names, run.cpus, run.peaks)]
        said = {key: run.said.get(key) for key in ("triangles", "residual_max", "width")}
        times = {"wall_s": run.wall, "cpu_s": run.cpu, "processes": processes}
        sizes = {"output_bytes": written, "temporary_bytes": run.disk}
        return {"name": pipe.name, "failure": run.failure, **times, **sizes, **said}


def points_of(path):
    """The number of points that a LAS or LAZ header states."""
    with path.open("rb") as file:
        header = file.read(COUNT_AT + 8)
    is_new = header[MINOR_AT] >= 4
    (count,) = struct.unpack_from("<Q" if is_new else "<I", header, COUNT_AT if is_new else OLD_COUNT_AT)
    return count


def markdown(facts):
    """A row per process, and one for each pipe."""
    rows = []
    for pipe in facts["pipes"]:
        memory = sum(process["peak_bytes"] for process in pipe["processes"])
        sizes = [megabytes(size) for size in (memory, pipe["temporary_bytes"], pipe["output_bytes"])]
        times = [number(pipe["wall_s"]), number(pipe["cpu_s"])]
        rows.append([f"{pipe['name']} {pipe['failure']}".strip(), *times, *sizes])
        for process in pipe["processes"]:
            rows.append([process["name"], "", number(process["cpu_s"]), megabytes(process["peak_bytes"]), "", ""])
    head = ["pipe", "wall s", "CPU s", "peak MB", "temporary files, MB", "output MB"]
    size = f"{facts['points']:,} points in {facts['tiles']} tiles of {facts['input_bytes'] / 1e6:,.0f} MB together"
    counts = "".join(f"\n* {pipe['name']}: {told(pipe)}" for pipe in facts["pipes"])
    return f"### {facts['name']}\n\n{size}; one run each, so no intervals.\n\n{table(head, rows)}{counts}\n"


def megabytes(size):
    return number(size / 1e6, 0)


def told(pipe):
    words = {"triangles": "triangles:", "residual_max": "points in the widest residual:", "width": "width:"}
    return ", ".join(f"{word} {pipe[key]:,.0f}" for key, word in words.items() if pipe[key] is not None)
