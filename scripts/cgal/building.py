"""Builds the CGAL programs of the comparisons."""

import pathlib
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
FLAGS = ["-O2", "-DNDEBUG", "-frounding-math", "-std=c++17"]
MISSING = "SKIPPED: g++ or libcgal-dev is missing"


def cgal(name, folder):
    """Builds NAME.cpp in `folder` and returns the program, or None if it cannot be built."""
    if not shutil.which("g++") or not pathlib.Path("/usr/include/CGAL").exists():
        return None
    program = folder / f"cgal_{name}"
    subprocess.run(["g++", *FLAGS, HERE / f"{name}.cpp", "-o", program, "-lmpfr", "-lgmp"], check=True)
    return program
