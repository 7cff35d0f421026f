"""Inputs of the jobs: seeded points, samples of tests/data, and what the programs make of them."""

import gzip
import math
import os
import pathlib
import random
import shutil
import struct
import shlex
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "tests" / "data"

# Samples under the names that jobs use.
COPIES = {
    "atoms.cif": "1aki.cif",
    "atoms.pdb": "1aki.pdb",
    "peptide.pdb.gz": "1l2y.pdb.gz",
    "lines.geojson": "lines.geojson",
    "lines.gpkg": "lines.gpkg",
    "lines.txt": "lines.txt",
    "volumes.nrrd": "functional_crop.nrrd",
}

# What the programs make of them, in this order; `{}` are all nodes of the plan.
MADE = """
spfinalize in/tile.las -o in/points.spm
spfinalize in/tile.las in/east.las | spdelaunay2d -o in/ground.spm
spheight --ground in/ground.spm in/tile.las -o in/tile.laz
spheight --ground in/ground.spm in/east.las -o in/east.laz
spfinalize --octree in/cloud.xyz -o in/cloud.points.spm
spdelaunay3d in/cloud.points.spm -o in/cloud.spm
spconvert in/ground.spm -o in/twin.txt
splinefit fit --max-knots 40 in/points.txt -o in/spline.spm
spfinalize --leaf-points 1000 --plan in/plan.json in/tile.las in/east.las
spnode run in/plan.json {} -d in/parts
spnode collect in/plan.json -d in/parts -o in/mesh.json
"""


def make(folder, programs, seed, count):
    """Writes all inputs to the folder in/ below `folder`, with some `count` points each."""
    folder, numbers = pathlib.Path(folder), random.Random(f"inputs {seed}")
    into = folder / "in"
    into.mkdir(parents=True)
    for name, sample in COPIES.items():
        shutil.copyfile(SAMPLES / sample, into / name)
    zip_file(into / "atoms.cif", into / "atoms.cif.gz")
    zip_file(SAMPLES / "functional.nii", into / "series.nii.gz")
    write_lines(into / "points.txt", terrain(numbers, count, 0))
    zip_file(into / "points.txt", into / "points.txt.gz")
    write_las(into / "tile.las", terrain(numbers, count, 0))
    write_las(into / "east.las", terrain(numbers, count // 2, 100))
    write_lines(
        into / "cloud.xyz", [[numbers.randrange(200) / 8 for _ in range(3)] for _ in range(count // 2)]
    )
    write_lines(into / "knots.txt", terrain(numbers, min(count // 20, 300), 0))
    sites = min(count // 10, 300)
    write_lines(into / "points4.txt", [[numbers.randrange(8) for _ in range(4)] for _ in range(sites)])
    for line in MADE.split("\n")[1:-1]:
        run(programs, line.replace("{}", nodes(programs, folder) if "{}" in line else ""), folder)


def nodes(programs, folder):
    """The numbers of all nodes of the plan, children first."""
    listed = run(programs, "spnode list in/plan.json", folder)
    return " ".join(line.split("\t")[0] for line in listed.splitlines())


def run(programs, pipe, folder):
    """Runs an undisturbed pipe and returns what it writes to stdout."""
    stages = [f"{shlex.quote(str(programs))}/{stage} --quiet" for stage in pipe.split(" | ")]
    command = ["bash", "-c", "set -o pipefail; " + " | ".join(stages)]
    return subprocess.run(command, cwd=folder, check=True, stdout=subprocess.PIPE, text=True).stdout


def terrain(numbers, count, left):
    """Hills on a square of side 100: scattered points, rows of a grid, and duplicates. In hundredths."""
    points = []
    for i in range(count):
        x, y = (numbers.randrange(10_000) / 100 for _ in range(2))
        if i % 3 == 0:
            x, y = round(x), round(y)
        z = round(10 + 4 * math.sin(x / 9) + 3 * math.cos(y / 13) + numbers.random(), 2)
        points.append((left + x, y, z))
        if i % 50 == 0:
            points.append(points[-1])
    return points


def write_lines(path, rows):
    path.write_text("".join(" ".join(map(str, row)) + "\n" for row in rows), encoding="ascii")


def write_las(path, points):
    """LAS 1.2 of format 0 in hundredths; every third point is of class 5, the others of the ground."""
    axes = list(zip(*points))
    box = [bound for axis in axes for bound in (max(axis), min(axis))]
    header = struct.pack(
        "<4sHHIHH8sBB32s32sHHHIIBHI5I3d3d6d",
        b"LASF",
        0,
        0,
        0,
        0,
        0,
        bytes(8),
        1,
        2,
        b"",
        b"torture",
        1,
        2026,
        227,
        227,
        0,
        0,
        20,
        len(points),
        len(points),
        0,
        0,
        0,
        0,
        0.01,
        0.01,
        0.01,
        0,
        0,
        0,
        *box,
    )
    records = bytearray()
    for i, point in enumerate(points):
        records += struct.pack(
            "<3iHBBbBH", *(round(100 * at) for at in point), i % 500, 0x09, 5 if i % 3 == 1 else 2, 0, 0, 0
        )
    path.write_bytes(header + records)


def zip_file(source, target):
    # Without a time, so that equal inputs are equal bytes.
    target.write_bytes(gzip.compress(source.read_bytes(), mtime=0))


def copy(source, target, names):
    """Copies inputs with their times, which plans remember."""
    target.mkdir()
    for name in names:
        if (source / name).is_dir():
            shutil.copytree(source / name, target / name)
        else:
            shutil.copy2(source / name, target / name)
        os.chmod(target / name, 0o755 if (source / name).is_dir() else 0o644)


def replace(source, target):
    """Gives a copy of one file the name of another, at once."""
    beside = target.with_name("replacement")
    shutil.copy2(source, beside)
    os.replace(beside, target)
