#!/usr/bin/env python3
"""Tests the parts of scripts/bench that calculate and measure: tests/benchmark/run.py [-v]"""

import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE.parents[1] / "scripts" / part) for part in ("benchmark", "")]

if __name__ == "__main__":
    sys.argv[1:1] = ["discover", "-s", str(HERE)]
    unittest.main(module=None)
