"""Figure 4.1: the diagram of a grid with the point at infinity, and with the faraway point.

`dd4` works in four dimensions. The Delaunay diagram of a product of two sets is the product of their diagrams, so
the diagram of the points times the corners of a square holds that of the points: a cell times the square, and
beyond each boundary edge an infinite cell, whose vertices are the edge times the square.
"""

import itertools
import math
from fractions import Fraction

from panel import Panel, figure
from programs import run, text_twin
from svg import BLUE, ORANGE, TEXT

SIDE = 4
SQUARE = [(0, 0), (1, 0), (0, 1), (1, 1)]
REACH = 0.75


def diagram(points):
    """Cells and boundary edges of points (x, y), as sets of points, by dd4."""
    lines = [f"{x} {y} {z} {t}" for x, y in points for z, t in SQUARE]
    places, cells, edges = [], [], []
    for line in text_twin(run("dd4", "--quiet", "-", stdin="\n".join(lines) + "\n")):
        word, *rest = line.split()
        if word == "v4":
            places.append(tuple(int(number) for number in rest[:4]))
        elif word in ("c4", "i4"):
            vertices = {places[int(number) - 1] for number in rest}
            base = frozenset(place[:2] for place in vertices)
            if word == "c4":
                cells.append(base)
            elif len(vertices) == 4 * len(base) and len(base) == 2:
                edges.append(base)
    return cells, edges


def brute(points):
    """The same by definition: maximal sets on circles without points inside, and edges of one cell."""
    cells = set()
    for a, b, c in itertools.combinations(points, 3):
        circle = circumcircle(a, b, c)
        if circle is None:
            continue
        (x, y), square = circle
        distances = [(p[0] - x) ** 2 + (p[1] - y) ** 2 - square for p in points]
        if min(distances) >= 0:
            cells.add(frozenset(p for p, distance in zip(points, distances, strict=True) if distance == 0))
    counts = {}
    for cell in cells:
        ring = hull(sorted(cell))
        for edge in zip(ring, ring[1:] + ring[:1], strict=True):
            counts[frozenset(edge)] = counts.get(frozenset(edge), 0) + 1
    return list(cells), [edge for edge, count in counts.items() if count == 1]


def circumcircle(a, b, c):
    """Centre and squared radius as fractions; None for points on a line."""
    (bx, by), (cx, cy) = ((p[0] - a[0], p[1] - a[1]) for p in (b, c))
    area = 2 * (bx * cy - by * cx)
    if area == 0:
        return None
    b2, c2 = bx * bx + by * by, cx * cx + cy * cy
    x, y = Fraction(cy * b2 - by * c2, area), Fraction(bx * c2 - cx * b2, area)
    return (a[0] + x, a[1] + y), x * x + y * y


def hull(points):
    """The corners of the convex hull, counterclockwise, from sorted points; none of them on a side."""

    def chain(sequence):
        kept = []
        for p in sequence:
            while len(kept) > 1 and turn(kept[-2], kept[-1], p) <= 0:
                kept.pop()
            kept.append(p)
        return kept[:-1]

    return chain(points) + chain(points[::-1])


def turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def sample():
    return [(x, y) for y in range(SIDE) for x in range(SIDE)]


def draw(folder):
    points = sample()
    cells, edges = diagram(points)
    middle = (SIDE - 1) / 2
    panels = []
    for column, (title, ends) in enumerate(
        [("With the point at infinity", hull(sorted(points))), ("With the faraway point", set().union(*edges))]
    ):
        low, high = -REACH, SIDE - 1 + REACH
        panel = Panel(column, 0, title, (low, high), (low, high))
        for cell in cells:
            panel.polygon(hull(sorted(cell)), BLUE, opacity=0.25, stroke=TEXT)
        for p in sorted(ends):
            offset = [p[axis] - middle for axis in (0, 1)]
            share = REACH / math.hypot(*offset)
            panel.line([p, tuple(p[axis] + share * offset[axis] for axis in (0, 1))], ORANGE, dash="5 4")
        panel.dots(points)
        panels.append(panel)
    alt = "Delaunay diagram of a grid of 4 by 4 points with two sentinel points"
    figure(folder / "figure-4.1.svg", alt, panels)


def check():
    """Compares the two ways, on the grid and on a grid with holes; returns the number of differences."""
    grid = [(x, y) for y in range(5) for x in range(6)]
    differences = 0
    for points in (sample(), grid[::2] + grid[1::6], [p for p in grid if (3 * p[0] + 5 * p[1]) % 7]):
        for ours, theirs in zip(diagram(points), brute(points), strict=True):
            differences += len(set(ours) ^ set(theirs))
    return "figure 4.1: cells and boundary edges that differ from brute force", differences, 0
