#!/usr/bin/env python3
"""Draws the growth curves as SVG: picture.py GROWTH.json FOLDER, which gets growth.svg and growth3.svg."""

import json
import pathlib
import sys

from svg import BLUE, GREEN, ORANGE, PURPLE, Curve, Panel, axis_from_zero, axis_of_counts, document

TIME, FINALIZE, DELAUNAY = PURPLE, ORANGE, BLUE
COHERENT, PERMUTED = "flight lines", "permuted"
COLOURS_OF_KINDS = {"random": BLUE, "structure": ORANGE, "gyroid": GREEN}
PIPE, WHOLE = "pipe", "tess3"


def draw(figures, folder):
    """Draws the growth in the plane and in space, as far as they were measured."""
    for key, name, make in (("growth", "growth.svg", plane), ("growth3", "growth3.svg", space)):
        if any("seconds" in row for row in figures.get(key, ())):
            (pathlib.Path(folder) / name).write_text(make(figures[key]))


def plane(rows):
    """The picture of the rows of `growth`."""
    rows = [row for row in rows if "seconds" in row]
    counts = axis_of_counts({row["points"] for row in rows}, "points")

    def curve(name, colour, order, value):
        values = sorted((row["points"], value(row)) for row in rows if row["order"] == order)
        return Curve(name, colour, values, is_dashed=order == PERMUTED)

    times = [curve(order, TIME, order, lambda row: row["us_per_point"]) for order in (COHERENT, PERMUTED)]
    memory = [
        curve(tool + (", permuted" if order == PERMUTED else ""), colour, order, lambda row: row[f"{tool}_bytes"] / 1e6)
        for tool, colour in (("spfinalize", FINALIZE), ("spdelaunay2d", DELAUNAY))
        for order in (COHERENT, PERMUTED)
    ]
    return two_panels("spfinalize and spdelaunay2d", counts, times, memory)


def space(rows):
    """The picture of the rows of `growth3`."""
    rows = [row for row in rows if "seconds" in row]
    counts = axis_of_counts({row["points"] for row in rows}, "points")

    def curves(value):
        for kind, colour in COLOURS_OF_KINDS.items():
            for way in (PIPE, WHOLE):
                chosen = [row for row in rows if (row["kind"], row["way"]) == (kind, way)]
                name = kind + (f", {WHOLE}" if way == WHOLE else "")
                values = sorted((row["points"], value(row)) for row in chosen)
                yield Curve(name, colour, values, is_dashed=way == WHOLE)

    times = list(curves(lambda row: row["us_per_point"]))
    memory = list(curves(lambda row: sum(row["peak_bytes"]) / 1e6))
    return two_panels("spfinalize and spdelaunay3d, and of tess3 (dashed),", counts, times, memory)


def two_panels(programs, counts, times, memory):
    parts = []
    panels = ((56, 292, "Time per point, µs", times), (468, 716, "Peak memory, MB", memory))
    for left, right, title, curves in panels:
        highest = max(value for curve in curves for _, value in curve.values)
        parts += Panel(left, right, 64, 304, title, counts, axis_from_zero(highest)).draw(curves)
    alt = f"Time per point and peak memory of {programs} against the number of points"
    return document(900, 360, alt, parts)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    figures = json.loads(pathlib.Path(sys.argv[1]).read_text())
    draw(figures, sys.argv[2])
