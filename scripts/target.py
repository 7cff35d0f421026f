"""The release build of the project: its location, and building it."""

import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Folder of everything that is built or measured, unless a script is told otherwise.
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target").resolve()
PROGRAMS = TARGET / "release"
EXAMPLES = PROGRAMS / "examples"


def build(*what):
    """Builds programs and examples, given as flags of cargo such as --bins or --example=NAME."""
    # Without them, cargo takes the package of the programs alone.
    packages = ["--package=spmesh", "--package=spmesh-experiments"]
    command = ["cargo", "build", "--release", "--locked", "--quiet", *packages, *what]
    # A relative CARGO_TARGET_DIR is relative to the caller's folder, not to the root.
    subprocess.run(command, cwd=ROOT, env={**os.environ, "CARGO_TARGET_DIR": str(TARGET)}, check=True)
