"""Makes input files in the folder of the benchmark, each once."""

import os
import subprocess

import copies
import target

UNITS = {"k": 10**3, "M": 10**6, "G": 10**9}
# Larger inputs are removed, unless --keep is given.
KEPT_POINTS_MAX = 10**7
# Examples that 4D sets need, and examples that other sets need.
EXAMPLES4 = ["diagram4_time"]
EXAMPLES = ["kernel_time", "kernel3_time", "gen_lidar", "gen_volume"]
# Families of scripts/gen-volume.
VOLUMES = ["random", "gyroid"]


def count_of(text):
    """The number that a text such as 300, 100k or 10M stands for."""
    return int(text[:-1]) * UNITS[text[-1]] if text[-1] in UNITS else int(text)


class Inputs:
    """Files by name: uniform-10M.f64, grid-1000.f64, decimals-1000.f64, flight-10M.las or .laz,
    permuted-10M.las; in 3D uniform3-1M.f64 and others, in 4D grid4-10.f64 and random4-10k.f64 (see inputs3.rs
    and inputs4.rs in rust/src/bin); streams of points in space, random-1M.spm and gyroid-1M.spm.
    """

    def __init__(self, folder, helpers):
        self.folder = folder / "inputs"
        self.folder.mkdir(parents=True, exist_ok=True)
        self.helpers = helpers

    def file(self, name):
        path = self.folder / name
        if path.exists():
            return path
        kind, size = path.stem.split("-")
        # The file has another name until it is complete.
        part = path.with_name("part-" + name)
        if kind == "flight":
            self.make(target.ROOT / "scripts" / "gen-lidar", "--points", count_of(size), "--seed", 1, "-o", part)
        elif kind in VOLUMES:
            self.make(target.ROOT / "scripts" / "gen-volume", "--family", kind, "--points", count_of(size), "-o", part)
        elif kind == "permuted":
            self.make(self.helpers / "inputs", "permute", self.file(f"flight-{size}.las"), part)
        else:
            maker = f"inputs{kind[-1]}" if kind[-1] in "34" else "inputs"
            self.make(self.helpers / maker, kind, count_of(size), part)
        os.replace(part, path)
        return path

    def copied(self, source, size):
        """A stream of copies of a structure, side by side."""
        path = self.folder / f"{source.name.split('.')[0].replace('-', '_')}_copies-{size}.spm"
        if not path.exists():
            raw, part = path.with_suffix(".f64"), path.with_name("part-" + path.name)
            copies.write(source, count_of(size), raw)
            grid = ["--scale", ",".join([str(copies.UNIT)] * 3)]
            self.make(program("spfinalize"), "--octree", "--preserve", *grid, "--raw", "f64le", raw, "-o", part)
            raw.unlink()
            os.replace(part, path)
        return path

    def finalized(self, las):
        """The stream that the current spfinalize makes of a file."""
        path = las.with_suffix(".spm")
        self.make(program("spfinalize"), las, "-o", path)
        return path

    def make(self, *command):
        subprocess.run([str(word) for word in command], check=True, stderr=subprocess.DEVNULL)

    def remove_big(self):
        for path in self.folder.iterdir():
            if path.is_file() and count_of(path.stem.split("-")[-1]) > KEPT_POINTS_MAX:
                path.unlink()


def program(name):
    """A program or an example of the release build."""
    return target.PROGRAMS / name


def build(dims):
    """Builds the programs of this project for sets of these dimensions."""
    names = (EXAMPLES4 if 4 in dims else []) + (EXAMPLES if dims != {4} else [])
    examples = [word for name in names for word in ("--example", name)]
    bins = ["--bins"] if dims != {4} else []
    target.build(*bins, *examples)
