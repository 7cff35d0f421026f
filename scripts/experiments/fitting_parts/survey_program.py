"""Writes seeded points of a smooth surface with noise, as LAS, array and text.

    survey_program.py COUNT SIDE LAS NPY TEXT
"""

import struct
import sys

import numpy as np
from functions import franke

SEED = 1
HEIGHT, NOISE = 100.0, 0.1
STEP = 0.0001
RECORD = np.dtype([("place", "<i4", 3), ("rest", "V8")])
HEAD_BYTES = 227


def points(count, side):
    random = np.random.default_rng(SEED)
    places = np.vstack([[[0, 0], [1, 1], [0, 1], [1, 0]], random.random((count - 4, 2))])
    heights = HEIGHT * franke(*places.T) + NOISE * random.standard_normal(count)
    return np.round(np.column_stack([side * places, heights]) / STEP)


def las(steps):
    """LAS 1.2 with point format 0."""
    low, high = STEP * steps.min(0), STEP * steps.max(0)
    head = b"LASF" + struct.pack("<HHI2H8s", 0, 0, 0, 0, 0, b"") + struct.pack("<2B", 1, 2) + bytes(64)
    head += struct.pack("<3HII", 1, 2026, HEAD_BYTES, HEAD_BYTES, 0)
    head += struct.pack("<BHI5I", 0, RECORD.itemsize, len(steps), len(steps), 0, 0, 0, 0)
    head += struct.pack("<6d", STEP, STEP, STEP, 0, 0, 0)
    head += struct.pack("<6d", *(end[axis] for axis in range(3) for end in (high, low)))
    records = np.zeros(len(steps), RECORD)
    records["place"] = steps
    return head + records.tobytes()


def main():
    count, side, las_path, array_path, text_path = sys.argv[1:]
    steps = points(int(count), float(side))
    with open(las_path, "wb") as file:
        file.write(las(steps))
    np.save(array_path, STEP * steps)
    np.savetxt(text_path, STEP * steps, fmt="%.4f", delimiter="|")


if __name__ == "__main__":
    main()
