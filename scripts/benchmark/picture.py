#!/usr/bin/env python3
"""Draws the growth curve as SVG: picture.py GROWTH.json PICTURE.svg

Colours are of middle lightness, and there is no background, so that it reads on white and on black.
"""

import json
import math
import pathlib
import sys

WIDTH, HEIGHT = 900, 360
TOP, BOTTOM = 64, 304
TEXT = "#7d8590"
TIME, FINALIZE, DELAUNAY = "#9a6fe0", "#c9742b", "#3583d6"
COHERENT, PERMUTED = "flight lines", "permuted"
STYLE = f"""
  text {{ font: 13px -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; fill: {TEXT}; }}
  .title {{ font-size: 15px; font-weight: 600; }}
  .axis {{ stroke: {TEXT}; stroke-width: 1; }}
  .grid {{ stroke: {TEXT}; stroke-width: 1; opacity: 0.22; }}
  .line {{ fill: none; stroke-width: 2.25; stroke-linejoin: round; stroke-linecap: round; }}
"""


class Panel:
    """One diagram: points on a logarithmic axis to the right, a value from zero on upwards."""

    def __init__(self, left, right, title, counts, value_max):
        self.left, self.right, self.title = left, right, title
        self.counts = sorted(counts)
        self.step = nice_step(value_max / 4)
        self.top = self.step * math.ceil(value_max * 1.05 / self.step)

    def x(self, count):
        low, high = math.log(self.counts[0]), math.log(self.counts[-1])
        share = (math.log(count) - low) / (high - low) if high > low else 0.5
        return self.left + share * (self.right - self.left)

    def y(self, value):
        return BOTTOM - value / self.top * (BOTTOM - TOP)

    def frame(self):
        """Title, grid and numbers at the axes."""
        yield text(self.left - 40, 28, self.title, css="title")
        for i in range(round(self.top / self.step) + 1):
            value = i * self.step
            yield line(self.left, self.y(value), self.right, self.y(value), "axis" if i == 0 else "grid")
            yield text(self.left - 8, self.y(value) + 4.5, f"{value:g}", anchor="end")
        for count in self.counts:
            yield line(self.x(count), BOTTOM, self.x(count), BOTTOM + 5, "axis")
            yield text(self.x(count), BOTTOM + 22, short(count), anchor="middle")
        yield text((self.left + self.right) / 2, BOTTOM + 44, "points", anchor="middle")

    def curves(self, series):
        """Lines with a mark at each value, and their names at their ends."""
        ends = []
        for name, colour, dashed, values in series:
            if not values:
                continue
            places = [(self.x(count), self.y(value)) for count, value in values]
            path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
            dash = ' stroke-dasharray="2 6"' if dashed else ""
            yield f'<polyline class="line" stroke="{colour}"{dash} points="{path}"/>'
            for x, y in places:
                fill = "none" if dashed else colour
                yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{fill}" stroke="{colour}" stroke-width="1.5"/>'
            ends.append((places[-1][1], name, colour))
        for y, name, colour in spread(ends):
            yield text(self.right + 12, y + 4.5, name, fill=colour)


def spread(ends, room=17):
    """Moves labels down until none covers the one above, and all up by what is too much."""
    placed, lowest = [], -math.inf
    for y, name, colour in sorted(ends):
        lowest = max(y, lowest + room)
        placed.append((lowest, name, colour))
    excess = max(0, lowest - BOTTOM + 6)
    return [(y - excess, name, colour) for y, name, colour in placed]


def nice_step(value):
    """The least of 1, 2, 2.5, 5 times a power of ten that is not below `value`."""
    power = 10 ** math.floor(math.log10(value))
    return next(factor * power for factor in (1, 2, 2.5, 5, 10) if factor * power >= value * 0.999)


def short(count):
    for unit, size in (("M", 10**6), ("k", 10**3)):
        if count >= size:
            return f"{count / size:g}{unit}"
    return str(count)


def text(x, y, words, anchor="start", css="", fill=""):
    style = (f' class="{css}"' if css else "") + (f' style="fill: {fill}"' if fill else "")
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{style}>{words}</text>'


def line(x1, y1, x2, y2, css):
    return f'<line class="{css}" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"/>'


def draw(rows):
    """The picture of the rows that `growth` makes."""
    rows = [row for row in rows if "seconds" in row]
    counts = {row["points"] for row in rows}

    def series(name, colour, order, value):
        values = sorted((row["points"], value(row)) for row in rows if row["order"] == order)
        return name, colour, order == PERMUTED, values

    times = [series(order, TIME, order, lambda row: row["us_per_point"]) for order in (COHERENT, PERMUTED)]
    memory = [
        series(tool + (", permuted" if order == PERMUTED else ""), colour, order, lambda row: row[f"{tool}_bytes"] / 1e6)
        for tool, colour in (("spfinalize", FINALIZE), ("spdelaunay2d", DELAUNAY))
        for order in (COHERENT, PERMUTED)
    ]
    parts = []
    panels = ((56, 292, "Time per point, µs", times), (468, 716, "Peak memory, MB", memory))
    for left, right, title, curves in panels:
        highest = max(value for _, _, _, values in curves for _, value in values)
        panel = Panel(left, right, title, counts, highest)
        parts += [*panel.frame(), *panel.curves(curves)]
    alt = "Time per point and peak memory of spfinalize and spdelaunay2d against the number of points"
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img">'
    return "\n".join([head, f"<title>{alt}</title>", f"<style>{STYLE}</style>", *parts, "</svg>", ""])


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    figures = json.loads(pathlib.Path(sys.argv[1]).read_text())
    pathlib.Path(sys.argv[2]).write_text(draw(figures["growth"]))
