#!/usr/bin/env python3
"""Draws the growth curve as SVG: picture.py GROWTH.json PICTURE.svg"""

import json
import pathlib
import sys

from svg import BLUE, ORANGE, PURPLE, Curve, Panel, axis_from_zero, axis_of_counts, document

TIME, FINALIZE, DELAUNAY = PURPLE, ORANGE, BLUE
COHERENT, PERMUTED = "flight lines", "permuted"


def draw(rows):
    """The picture of the rows that `growth` returns."""
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
    parts = []
    panels = ((56, 292, "Time per point, µs", times), (468, 716, "Peak memory, MB", memory))
    for left, right, title, curves in panels:
        highest = max(value for curve in curves for _, value in curve.values)
        parts += Panel(left, right, 64, 304, title, counts, axis_from_zero(highest)).draw(curves)
    alt = "Time per point and peak memory of spfinalize and spdelaunay2d against the number of points"
    return document(900, 360, alt, parts)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    figures = json.loads(pathlib.Path(sys.argv[1]).read_text())
    pathlib.Path(sys.argv[2]).write_text(draw(figures["growth"]))
