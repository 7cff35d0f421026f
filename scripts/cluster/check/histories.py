"""Histories of tiles: they change, come and go between runs that are killed. What does not depend on a tile must stay.

A history starts with a grid of small tiles and a mesh of them. In each step a tile is touched, gets another point, is
cut off and mended, is added inside or outside of the others, or is removed. Then the tiles are planned again, what is
missing is run, with kills at random times, and collected. After each step:

* The parts and the manifest have the bytes of a run in an empty folder.
* The parts of nodes that stay are the same files as before.
* Few nodes are made: the leaf that has the tile and its neighbour, and those above. This holds for tiles that stay.
* The manifest of the step before can be read until a new one replaces it.
* spnode clean, which some steps run, removes all files of other nodes, and no others.
"""

import math
import os
import pathlib
import random
import shutil
import struct
import subprocess
import time

import compare

SIDE, POINTS, LEAF_POINTS = 5, 240, 700
STEPS = 6
# Shares of runs that are killed, and of steps after which the folder is cleaned.
KILLED, CLEANED = 0.5, 0.4
RUNS_MAX = 50
HEADER = "<4sHHIHH8sBB32s32sHHHIIBHI5I3d3d6d"


# --- Tiles -------------------------------------------------------------------------------------------------------


def points_of(column, row, numbers):
    """Points of a tile of side 100 in hundredths, some of them twice, as integers."""
    points = []
    for i in range(POINTS):
        x, y = column * 10_000 + numbers.randrange(10_000), row * 10_000 + numbers.randrange(10_000)
        points.append((x, y, int(1000 + 400 * math.sin(x / 7000) + 300 * math.cos(y / 5000) + numbers.randrange(20))))
        if i % 60 == 0:
            points.append(points[-1])
    return points


def write_las(path, points):
    """LAS 1.2 of format 0, in hundredths."""
    box = [bound / 100 for axis in zip(*points) for bound in (max(axis), min(axis))]
    header = struct.pack(
        HEADER, b"LASF", 0, 0, 0, 0, 0, bytes(8), 1, 2, b"histories", b"", 1, 2026, 227, 227, 0, 0, 20, len(points),
        len(points), 0, 0, 0, 0, 0.01, 0.01, 0.01, 0, 0, 0, *box,
    )  # fmt: skip
    records = (struct.pack("<iiiHBBbBH", *point, 0, 9, 2, 0, 0, 0) for point in points)
    path.write_bytes(header + b"".join(records))


# --- One history -------------------------------------------------------------------------------------------------


class History:
    """Tiles, and the folder that is planned and run again and again."""

    def __init__(self, programs, folder, name):
        self.programs, self.folder, self.random = programs, folder, random.Random(name)
        self.tiles, self.parts, self.plan = folder / "tiles", folder / "parts", folder / "plan.json"
        self.mesh = folder / "mesh.json"
        self.tiles.mkdir(parents=True)
        self.points, self.clock, self.seconds = {}, 10**9, 0.2
        self.counts = dict.fromkeys(["steps", "runs", "killed", "made", "most made", "nodes", "removed", "cleaned"], 0)
        for place in [(column, row) for column in range(SIDE) for row in range(SIDE)]:
            # Some places are free, for tiles that come.
            if self.random.random() < 0.85:
                self.add(place)

    def tile(self, place):
        return self.tiles / f"{place[0] + 1}_{place[1] + 1}.las"

    def add(self, place):
        self.points[place] = points_of(*place, self.random)
        self.write(place)

    def write(self, place):
        write_las(self.tile(place), self.points[place])
        self.stamp(place)

    def stamp(self, place):
        """Gives a tile a time of its own, whatever the clock of the machine resolves."""
        self.clock += 1
        os.utime(self.tile(place), (self.clock, self.clock))

    def command(self, tool, *words):
        return [str(self.programs / tool), "-q", *map(str, words)]

    def failing(self, *command):
        return subprocess.run(command, capture_output=True, text=True)

    def must(self, tool, *words):
        return compare.output_of(*self.command(tool, *words))

    def expect(self, holds, message):
        if not holds:
            raise compare.Difference(message)

    # --- What happens to tiles ---

    def touch(self):
        self.stamp(self.some())

    def change(self):
        place = self.some()
        which = self.random.randrange(POINTS)
        x, y, z = self.points[place][which]
        self.points[place][which] = (x, y, z + 7)
        self.write(place)

    def cut_and_mend(self):
        """A tile that is cut off is refused, and the mesh stays. Then it comes again."""
        place = self.some()
        os.truncate(self.tile(place), self.tile(place).stat().st_size // 2)
        refused = self.failing(*self.planning(self.folder / "refused.json"))
        self.expect(refused.returncode == 3, f"planning with a tile that is cut off exits with {refused.returncode}")
        self.expect(self.tile(place).name in refused.stderr, "a tile that is cut off is not named")
        stale = self.failing(*self.command("spnode", "list", self.plan, "-d", self.parts, "--missing"))
        self.expect(stale.returncode == 2, f"spnode list with a changed tile exits with {stale.returncode}")
        self.write(place)

    def add_inside(self):
        self.add_one([(column, row) for column in range(SIDE) for row in range(SIDE)])

    def add_outside(self):
        self.add_one([(side, row) for side in (-1, SIDE) for row in range(SIDE)])

    def add_one(self, places):
        free = [place for place in places if place not in self.points]
        if free:
            self.add(self.random.choice(free))
        else:
            self.touch()

    def remove(self):
        place = self.some()
        self.tile(place).unlink()
        del self.points[place]

    def some(self):
        return self.random.choice(sorted(self.points))

    # --- Runs ---

    def planning(self, path):
        names = [str(tile) for tile in sorted(self.tiles.iterdir())]
        return self.command("spfinalize", "--plan", path, "--leaf-points", LEAF_POINTS, *names)

    def nodes(self):
        """Names of all nodes of the plan by their numbers, and the number of stages."""
        lines = [line.split() for line in self.must("spnode", "list", self.plan).splitlines()]
        return {line[0]: line[5] for line in lines}, 1 + max(int(line[1]) for line in lines)

    def missing(self):
        listed = self.must("spnode", "list", self.plan, "-d", self.parts, "--missing")
        return [line.split()[0] for line in listed.splitlines()]

    def killed(self, command):
        """Runs a command, perhaps not to its end."""
        started = time.monotonic()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        if self.random.random() < KILLED:
            try:
                process.wait(self.random.random() * self.seconds)
            except subprocess.TimeoutExpired:
                process.kill()
        code = process.wait()
        self.counts["killed"] += code < 0
        if code == 0:
            self.seconds = max(0.02, time.monotonic() - started)
        self.expect(code <= 0, f"{' '.join(command)} exits with {code}")
        return code == 0

    def run(self):
        """Plans, runs and collects, until that succeeds."""
        while not self.killed(self.planning(self.plan)):
            pass
        first = self.missing()
        for _ in range(RUNS_MAX):
            numbers = self.missing()
            self.counts["runs"] += 1
            if not numbers:
                break
            self.killed(self.command("spnode", "run", self.plan, *numbers, "-d", self.parts, "--threads", 1))
        self.expect(not numbers, f"nodes are still missing after {RUNS_MAX} runs")
        while not self.killed(self.command("spnode", "collect", self.plan, "-d", self.parts, "-o", self.mesh)):
            pass
        return first

    def files(self):
        """Bytes and inode of all files in the folder of the parts."""
        found = {}
        for path in self.parts.rglob("*") if self.parts.exists() else []:
            if path.is_file() and not path.name.startswith(".spmesh-"):
                found[path.name] = (path.stat().st_ino, path.read_bytes())
        return found

    def step(self, name):
        """One thing that happens, and what has to hold then."""
        before = self.files()
        mesh = compare.joined(self.programs, self.mesh) if self.mesh.exists() else None
        getattr(self, name)()
        self.parts.mkdir(exist_ok=True)
        made = self.run_beside(mesh)
        names, stages = self.nodes()
        after = self.files()
        for file, (inode, data) in before.items():
            stays = file.split(".")[0] not in {names[number] for number in made}
            self.expect(not stays or after.get(file) == (inode, data), f"{name}: {file} was not to change")
        if name in ("touch", "change", "cut_and_mend") and mesh is not None:
            self.expect(len(made) <= 2 + stages, f"{name}: {len(made)} of {len(names)} nodes are made again")
            self.counts["most made"] = max(self.counts["most made"], len(made))
        self.compare_with_fresh(set(names.values()))
        if self.random.random() < CLEANED:
            self.clean(set(names.values()))
        self.counts["steps"] += 1
        self.counts["made"] += len(made)
        self.counts["nodes"] += len(names)

    def run_beside(self, mesh):
        """Runs; before the new manifest is there, the old one must hold the old mesh."""
        if mesh is None:
            return self.run()
        old = self.mesh.read_bytes()
        while not self.killed(self.planning(self.plan)):
            pass
        made = self.missing()
        if made:
            self.must("spnode", "run", self.plan, made[0], "-d", self.parts, "--threads", 1)
        self.expect(self.mesh.read_bytes() == old, "the manifest changed before the mesh was collected")
        compare.same_mesh(mesh, compare.joined(self.programs, self.mesh))
        self.run()
        return made

    def compare_with_fresh(self, names):
        """Parts, residuals and the manifest must have the bytes of a run in an empty folder."""
        fresh = self.folder / "fresh"
        fresh.mkdir()
        subprocess.run(self.planning(fresh / "plan.json"), check=True)
        self.expect((fresh / "plan.json").read_bytes() == self.plan.read_bytes(), "the plan is another one")
        self.must("spnode", "collect", fresh / "plan.json", "-d", fresh / "parts", "-o", fresh / "mesh.json")
        self.expect((fresh / "mesh.json").read_bytes() == self.mesh.read_bytes(), "the manifest is another one")
        for name in names:
            for ending in (".spm", ".rest.spm"):
                ours, theirs = (compare.file_of(parts, name, ending) for parts in (self.parts, fresh / "parts"))
                self.expect(ours.exists() == theirs.exists(), f"{ours.name}: there in one folder alone")
                same = not ours.exists() or ours.read_bytes() == theirs.read_bytes()
                self.expect(same, f"{ours.name}: other bytes than in an empty folder")
        compare.same_mesh(compare.joined(self.programs, fresh / "mesh.json"), compare.joined(self.programs, self.mesh))
        shutil.rmtree(fresh)

    def clean(self, names):
        """Cleans, perhaps with a kill in between, beside files that are no nodes."""
        (self.parts / "jobs").mkdir(exist_ok=True)
        strangers = [self.parts / "jobs" / "notes.json", self.parts / "0123456789abcdef.spm", self.parts / "readme"]
        for path in strangers:
            path.write_text("a stranger")
        before = self.files()
        command = self.command("spnode", "clean", self.plan, "-d", self.parts)
        self.must("spnode", "clean", self.plan, "-d", self.parts, "--dry-run")
        self.expect(self.files() == before, "spnode clean --dry-run changes files")
        while not self.killed(command):
            pass
        after = self.files()
        is_kept = lambda file: file.split(".")[0] in names or (self.parts / file) in strangers or file == "notes.json"
        self.expect(set(after) == set(filter(is_kept, before)), "spnode clean leaves other files than it should")
        self.expect(all(before[file] == data for file, data in after.items()), "spnode clean changes files")
        self.counts["removed"] += len(before) - len(after)
        self.counts["cleaned"] += 1
        for path in strangers:
            path.unlink()


EVENTS = ["touch", "change", "cut_and_mend", "add_inside", "add_outside", "remove"]


def run(programs, folder, count, seed, say):
    """Runs histories; raises at the first that is wrong, whose folder stays."""
    total = {}
    for number in range(count):
        history = History(pathlib.Path(programs), folder / str(number), f"{seed} {number}")
        try:
            history.step("touch")
            events = history.random.sample(EVENTS, len(EVENTS))[:STEPS]
            for event in events:
                history.step(event)
        except compare.Difference as difference:
            raise compare.Difference(f"history {number} of seed {seed}: {difference}; see {history.folder}")
        for name, found in history.counts.items():
            total[name] = max(total.get(name, 0), found) if name == "most made" else total.get(name, 0) + found
        shutil.rmtree(history.folder)
        if (number + 1) % 10 == 0 or number + 1 == count:
            say(f"{number + 1} histories: " + ", ".join(f"{found} {name}" for name, found in total.items()))
