"""Figure 8.1: the control polygon of a univariate spline, and the control mesh of a bivariate one."""

import pathlib
import random
import tempfile

import univariate
from functions import heights, values, window
from panel import Panel, figure
from programs import run, text_twin
from solid import View, quadrilaterals, ranges, surface
from svg import BLUE, ORANGE, TEXT

SEED, KNOTS = 5, 14
LIFT = 0.55


def spline():
    """A quadratic spline over random knots in a square, clamped at its border, that goes up and down."""
    generator = random.Random(SEED)
    corners = [(0, 0), (6, 0), (6, 6), (0, 6)]
    inner = [(round(generator.uniform(0.8, 5.2), 2), round(generator.uniform(0.8, 5.2), 2)) for _ in range(KNOTS)]
    sites = [(x / 4, y / 4) for x in range(25) for y in range(25)]
    with tempfile.TemporaryDirectory() as folder:
        knots, points = pathlib.Path(folder) / "knots.spm", pathlib.Path(folder) / "points.xyz"
        lines = "".join(f"{x} {y}\n" for x, y in corners + inner)
        knots.write_bytes(run("configgen", "--quiet", "--degree", 2, "--boundary", "clamped", "-", stdin=lines))
        points.write_text("".join(f"{x} {y} {hill(x, y)}\n" for x, y in sites))
        return run("splinefit", "fit", "--quiet", "--knots", knots, "--degree", 2, points)


def hill(x, y):
    return 1.2 + ((x - 1.5) * (y - 4) - (x - 3) ** 2 / 2) / 3.5


def control_mesh(stream):
    """Vertices and triangles of the control mesh."""
    vertices, triangles = [], []
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "spline.spm"
        path.write_bytes(stream)
        lines = text_twin(run("splinefit", "mesh", "--quiet", path))
    for line in lines:
        word, *rest = line.split()
        if word == "v":
            vertices.append(tuple(float(number) for number in rest))
        elif word == "f":
            triangles.append([int(number) - 1 for number in rest])
    return vertices, triangles


def mesh_panel():
    stream = spline()
    vertices, triangles = control_mesh(stream)
    rows = window((0.001, 0.001), (5.999, 5.999), 24)
    found = heights(stream, rows)
    view = View(24, 34, LIFT)
    panel = Panel(1, 0, "A control mesh", *ranges([view(vertex) for vertex in vertices], 0.06))
    surface(panel, view, quadrilaterals(rows, found), BLUE)
    for triangle in triangles:
        corners = [vertices[number] for number in triangle]
        panel.line([view(corner) for corner in [*corners, corners[0]]], ORANGE, 0.9)
    panel.dots([view(vertex) for vertex in vertices], ORANGE, 2.2)
    return panel


def draw(folder):
    alt = "The control polygon of a univariate spline, and the control mesh of a bivariate one"
    figure(folder / "figure-8.1.svg", alt, [univariate.polygon_panel(0, 0), mesh_panel()])


def check():
    """How far the spline leaves the range of its control points, of which it is a convex combination; how far
    control points are from the Greville sites of their pairs of knots; and how far a spline with coefficients that
    are linear in these sites is from that linear function."""
    stream = spline()
    vertices, _ = control_mesh(stream)
    low, high = min(v[2] for v in vertices), max(v[2] for v in vertices)
    places = [place for row in window((0.01, 0.01), (5.99, 5.99)) for place in row]
    found = values(stream, places)
    outside = max(max(found) - high, low - min(found), 0.0)
    sites, lines, knots = [], [], []
    for line in text_twin(stream):
        word, *rest = line.split()
        if word == "v":
            knots.append([float(number) for number in rest[:2]])
        elif word == "function":
            pair = rest[1:] * 2 if len(rest) == 2 else rest[1:]
            sites.append(tuple(sum(knots[int(id_) - 1][axis] for id_ in pair) / 2 for axis in (0, 1)))
    remaining = iter(sites)
    for line in text_twin(stream):
        if line.startswith("coefficient "):
            x, y = next(remaining)
            line = f"coefficient {linear(x, y)!r}"
        lines.append(line)
    apart = max(abs(p - q) for a, b in zip(sorted(sites), sorted(v[:2] for v in vertices), strict=True) for p, q in zip(a, b, strict=True))
    flat = run("spconvert", "--quiet", "--to", "spm", stdin="\n".join(lines) + "\n")
    worst = max(abs(value - linear(*place)) for value, place in zip(values(flat, places), places, strict=True))
    return "figure 8.1: control points, Greville sites, and linear precision", max(outside, apart, worst), 1e-9


def linear(x, y):
    return 2 * x - 3 * y + 1
