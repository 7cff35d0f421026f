"""What the tests share: where the programs and the data are, and points."""

import os
import subprocess
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[3]
VECTORS = ROOT / "formats" / "vectors"
DATA = ROOT / "tests" / "data"
BIN = Path(os.environ.setdefault("SPMESH_BIN", str(ROOT / "target" / "debug")))


def run(name, *arguments, data=b""):
    """The output of a program."""
    done = subprocess.run([BIN / name, *map(str, arguments)], input=data, capture_output=True)
    assert done.returncode == 0, (name, done.stderr.decode())
    return done.stdout


def cloud(count=5000, seed=1):
    return np.random.default_rng(seed).uniform(-500, 500, (count, 3))
