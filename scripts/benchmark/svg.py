"""Diagrams as SVG.

Colours have a medium lightness, and there is no background, so that diagrams are legible on white and on
black.
"""

import math
from dataclasses import dataclass

TEXT = "#7d8590"
PURPLE, ORANGE, BLUE, GREEN, RED = "#9a6fe0", "#c9742b", "#3583d6", "#3f9a5f", "#d0546a"
STYLE = f"""
  text {{ font: 13px -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; fill: {TEXT}; }}
  .title {{ font-size: 15px; font-weight: 600; }}
  .axis {{ stroke: {TEXT}; stroke-width: 1; }}
  .grid {{ stroke: {TEXT}; stroke-width: 1; opacity: 0.22; }}
  .line {{ fill: none; stroke-width: 2.25; stroke-linejoin: round; stroke-linecap: round; }}
"""


@dataclass
class Axis:
    """A linear or logarithmic axis from the least to the greatest of its ticks, which are pairs of a value
    and a label."""

    ticks: list
    name: str = ""
    is_log: bool = False

    def share(self, value):
        """The position of a value on the axis, from 0 to 1; values below a logarithmic axis are at its
        start."""
        low, high = self.ticks[0][0], self.ticks[-1][0]
        if self.is_log:
            value, low, high = math.log(max(value, low)), math.log(low), math.log(high)
        return (value - low) / (high - low) if high > low else 0.5


def axis_from_zero(value_max, name=""):
    """An axis from zero in round steps to just above the greatest value."""
    step = nice_step(value_max / 4)
    steps = math.ceil(value_max * 1.05 / step)
    return Axis([(i * step, f"{i * step:g}") for i in range(steps + 1)], name)


def axis_of_counts(counts, name):
    """A logarithmic axis with a tick for each count."""
    return Axis([(count, short(count)) for count in sorted(counts)], name, is_log=True)


@dataclass
class Curve:
    """Pairs of x and y; `dots` are the single values behind the curve."""

    name: str
    colour: str
    values: list
    is_dashed: bool = False
    dots: tuple = ()


@dataclass
class Panel:
    """One diagram: its position, and its axes to the right and upwards."""

    left: float
    right: float
    top: float
    bottom: float
    title: str
    across: Axis
    up: Axis

    def x(self, value):
        return self.left + self.across.share(value) * (self.right - self.left)

    def y(self, value):
        return self.bottom - self.up.share(value) * (self.bottom - self.top)

    def frame(self):
        """Title, grid, and numbers along the axes."""
        yield text(self.left - 40, self.top - 36, self.title, css="title")
        for i, (value, label) in enumerate(self.up.ticks):
            yield line(self.left, self.y(value), self.right, self.y(value), "axis" if i == 0 else "grid")
            yield text(self.left - 8, self.y(value) + 4.5, label, anchor="end")
        for value, label in self.across.ticks:
            yield line(self.x(value), self.bottom, self.x(value), self.bottom + 5, "axis")
            yield text(self.x(value), self.bottom + 22, label, anchor="middle")
        yield text((self.left + self.right) / 2, self.bottom + 44, self.across.name, anchor="middle")

    def draw(self, curves):
        """Curves with a mark at each value, and their names at their ends."""
        yield from self.frame()
        ends = []
        for curve in curves:
            if not curve.values:
                continue
            for x, y in curve.dots:
                yield f'<circle cx="{self.x(x):.1f}" cy="{self.y(y):.1f}" r="1.5" fill="{curve.colour}" opacity="0.6"/>'
            places = [(self.x(x), self.y(y)) for x, y in curve.values]
            path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
            dash = ' stroke-dasharray="2 6"' if curve.is_dashed else ""
            yield f'<polyline class="line" stroke="{curve.colour}"{dash} points="{path}"/>'
            for x, y in places:
                fill = "none" if curve.is_dashed else curve.colour
                ring = f'fill="{fill}" stroke="{curve.colour}" stroke-width="1.5"'
                yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" {ring}/>'
            if curve.name:
                ends.append((places[-1][1], curve.name, curve.colour))
        for y, name, colour in spread(ends, self.bottom):
            yield text(self.right + 12, y + 4.5, name, fill=colour)


def document(width, height, alt, parts):
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img">'
    return "\n".join([head, f"<title>{alt}</title>", f"<style>{STYLE}</style>", *parts, "</svg>", ""])


def spread(ends, bottom, room=17):
    """Moves labels down until no two overlap, and then up again if they are below the diagram."""
    lowest, downwards = -math.inf, []
    for y, name, colour in sorted(ends):
        lowest = max(y, lowest + room)
        downwards.append((lowest, name, colour))
    limit, upwards = bottom - 6, []
    for y, name, colour in reversed(downwards):
        upwards.append((min(y, limit), name, colour))
        limit = upwards[-1][0] - room
    return upwards[::-1]


def nice_step(value):
    """The least of 1, 2, 2.5 and 5 times a power of ten that is at least `value`."""
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
