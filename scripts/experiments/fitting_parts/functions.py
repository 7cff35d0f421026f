"""Functions on the unit square to be fitted."""

import numpy as np


def exponential(x, y):
    """The first function of figure 8.8."""
    return np.sin(x * y) * np.exp(x + y)


def wave(x, y):
    """The second function of figure 8.8, constant along y."""
    return np.sin(np.pi * x) + 0 * y


def franke(x, y):
    """Franke 1979: two hills, a saddle and a dip."""
    u, v = 9 * x, 9 * y
    return (
        0.75 * np.exp(-((u - 2) ** 2 + (v - 2) ** 2) / 4)
        + 0.75 * np.exp(-((u + 1) ** 2) / 49 - (v + 1) / 10)
        + 0.5 * np.exp(-((u - 7) ** 2 + (v - 3) ** 2) / 4)
        - 0.2 * np.exp(-((u - 4) ** 2) - (v - 7) ** 2)
    )


def lattice(count):
    """Sites of a square grid of `count` by `count` points on the unit square with its border, row by row."""
    steps = np.linspace(0, 1, count)
    return np.column_stack([np.tile(steps, count), np.repeat(steps, count)])


def rms(errors):
    return float(np.sqrt(np.mean(np.square(errors))))
