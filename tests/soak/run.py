#!/usr/bin/env python3
"""Tests that scripts/soak reports planted faults: tests/soak/run.py [-v]"""

import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

if __name__ == "__main__":
    sys.argv[1:1] = ["discover", "-s", str(HERE)]
    unittest.main(module=None)
