"""The release build of the project: where it is, and how it is made."""

import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
# All that is built or measured goes here, unless a script is told otherwise.
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target").resolve()
PROGRAMS = TARGET / "release"
EXAMPLES = PROGRAMS / "examples"


def build(*what):
    """Builds programs and examples, given as flags of cargo such as --bins or --example=NAME."""
    command = ["cargo", "build", "--release", "--locked", "--quiet", *what]
    # A relative CARGO_TARGET_DIR starts at the folder of the caller, not at the root.
    subprocess.run(command, cwd=ROOT, env={**os.environ, "CARGO_TARGET_DIR": str(TARGET)}, check=True)
