"""Figures 8.2 and 8.6: one function of a basis.

The functions are those of our programs: a spline over the knots, in which one coefficient is 1 and the others are
0, evaluated on a grid.
"""

import pathlib
import tempfile

from panel import Panel, figure
from programs import run, text_twin
from shadows import area, barycentric
from solid import View, divided, ranges, surface
from svg import BLUE, GREEN, ORANGE, TEXT

SIDE = 7
KNOTS = [(0, 0), (4, 1), (8, 0), (1, 4), (5, 5), (9, 4), (3, 8), (8, 8), (2.6, 2.3), (6.2, 2.8), (7.2, 6), (2.6, 6)]
VERTEX, EDGE = 4, (4, 10)
STEPS = 48


class Basis:
    """The functions over knots, as configgen lists them with `flags`."""

    def __init__(self, knots, *flags):
        self.knots = knots
        lines = "".join(f"{x} {y}\n" for x, y in knots)
        self.stream = run("configgen", "--quiet", "--degree", 1, *flags, "-", stdin=lines)
        self.names = [line.split()[1:] for line in text_twin(self.stream) if line.startswith("function ")]

    def triangles(self):
        """The start triangulation, as triples of places; the triangles of copies are flat."""
        places, found, degree = [], [], None
        for line in text_twin(self.stream):
            word, *rest = line.split()
            if word == "v":
                places.append((float(rest[0]), float(rest[1])))
            elif word == "degree":
                degree = rest[0]
            elif word == "on" and degree == "0":
                found.append([places[int(number) - 1] for number in rest])
        return [corners for corners in found if area(corners) > 0]

    def function(self, *name):
        """The spline that is one function, as a stream."""
        with tempfile.TemporaryDirectory() as folder:
            knots, points = pathlib.Path(folder) / "knots.spm", pathlib.Path(folder) / "points.xyz"
            knots.write_bytes(self.stream)
            # The coefficients of this fit are replaced below.
            low, high = ([pick(p[axis] for p in self.knots) for axis in (0, 1)] for pick in (min, max))
            points.write_text("".join(f"{x!r} {y!r} 1\n" for row in window(low, high) for x, y in row))
            any_spline = run("splinefit", "fit", "--quiet", "--knots", knots, points)
        wanted = self.names.index([str(word) for word in name])
        lines, number = [], -1
        for line in text_twin(any_spline):
            if line.startswith("coefficient "):
                number += 1
                line = f"coefficient {int(number == wanted)}"
            lines.append(line)
        return run("spconvert", "--quiet", "--to", "spm", stdin="\n".join(lines) + "\n")


def values(spline, places):
    """Values of a spline; 0 outside of its domain."""
    with tempfile.TemporaryDirectory() as folder:
        stream, sites = pathlib.Path(folder) / "spline.spm", pathlib.Path(folder) / "sites.xy"
        stream.write_bytes(spline)
        sites.write_text("".join(f"{x!r} {y!r}\n" for x, y in places))
        lines = run("splinefit", "eval", "--quiet", stream, "--at", sites).decode().splitlines()
    found = [float(line.split()[2]) for line in lines]
    return [value if value == value else 0.0 for value in found]


def window(low, high, steps=STEPS):
    """A grid of places as rows."""
    steps = [step / steps for step in range(steps + 1)]
    across, up = ([a + (b - a) * share for share in steps] for a, b in zip(low, high, strict=True))
    return [[(x, y) for x in across] for y in up]


def heights(spline, rows):
    found = iter(values(spline, [place for row in rows for place in row]))
    return [[next(found) for _ in row] for row in rows]


def box_basis():
    return Basis([(x, y) for y in range(SIDE) for x in range(SIDE)], "--box", "zp")


def box_name(basis):
    """The box spline amid the grid: its four knots are the corners of a square."""
    middle = SIDE // 2
    corners = {(middle, middle), (middle + 1, middle), (middle, middle + 1), (middle + 1, middle + 1)}
    faces = (name for name in basis.names if name[0] == "face")
    return next(name for name in faces if {basis.knots[int(id_) - 1] for id_ in name[1:]} == corners)


def draw_box(folder):
    """Figure 8.2: the mesh of four directions, and the ZP element."""
    low, high = 1, SIDE - 1
    flat = Panel(0, 0, "The mesh of four directions", (low, high), (low, high))
    for i in range(low, high + 1):
        flat.line([(i, low), (i, high)], TEXT, 1)
        flat.line([(low, i), (high, i)], TEXT, 1)
    for i in range(low, high):
        for j in range(low, high):
            flat.line([(i, j), (i + 1, j + 1)], TEXT, 0.7)
            flat.line([(i, j + 1), (i + 1, j)], TEXT, 0.7)
    middle = SIDE // 2
    corners = [(x, y) for x in (middle, middle + 1) for y in (middle, middle + 1)]
    support = [(-1, 0), (0, -1), (1, -1), (2, 0), (2, 1), (1, 2), (0, 2), (-1, 1)]
    flat.polygon([(middle + x, middle + y) for x, y in support], BLUE, opacity=0.25, stroke=BLUE, width=2)
    flat.dots(corners, ORANGE, 4.5)
    basis = box_basis()
    spline = basis.function(*box_name(basis))
    solid = solid_panel(1, "The ZP element", spline, four_directions(low, high), 5, 3.2, BLUE)
    figure(folder / "figure-8.2.svg", "The ZP element on the mesh of four directions", [flat, solid])


def four_directions(low, high):
    """The triangles of the mesh: quarters of squares."""
    triangles = []
    for i in range(low, high):
        for j in range(low, high):
            ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            triangles += [[a, b, (i + 0.5, j + 0.5)] for a, b in zip(ring, ring[1:] + ring[:1], strict=True)]
    return triangles


def solid_panel(column, title, spline, triangles, parts, lift, colour):
    """A function as a surface over triangles, on which it is a polynomial."""
    view = View(24, 30, lift)
    faces = [face for triangle in triangles for face in divided(triangle, parts)]
    found = iter(values(spline, [place for face in faces for place in face]))
    faces = [[(*place, next(found)) for place in face] for face in faces]
    places = [view(place) for face in faces for place in face]
    panel = Panel(column, 0, title, *ranges(places))
    for triangle in triangles:
        panel.line([view((*place, 0)) for place in [*triangle, triangle[0]]], TEXT, 0.6)
    surface(panel, view, faces, colour)
    return panel


def draw_tents(folder):
    """Figure 8.6: a triangulation, the tent of a vertex, and the tent of an edge."""
    basis = Basis(KNOTS, "--pull-apart", "all")
    triangles = basis.triangles()
    lines = [[*corners, corners[0]] for corners in triangles]
    flat = Panel(0, 0, "A triangulation", *ranges(KNOTS))
    for line in lines:
        flat.line(line, TEXT, 1)
    flat.dots(KNOTS)
    flat.dots([KNOTS[VERTEX]], BLUE, 6)
    flat.line([KNOTS[knot] for knot in EDGE], GREEN, 4)
    vertex, edge = basis.function("vertex", VERTEX + 1), basis.function("tent", *(knot + 1 for knot in EDGE))
    panels = [
        flat,
        solid_panel(1, "The tent of the vertex", vertex, triangles, 10, 5, BLUE),
        solid_panel(2, "The tent of the edge", edge, triangles, 10, 5, GREEN),
    ]
    figure(folder / "figure-8.6.svg", "Tents of a vertex and of an edge of a triangulation", panels)


def zp(x, y):
    """The ZP element with its middle at (1/2, 1/2): the area of the (s, t) in the unit square for which
    (x, y) - s (1, 1) - t (1, -1), moved to the middle, lies in the unit square, by clipping."""
    x, y = x + 1, y
    ring = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    # 0 <= x - s - t <= 1 and 0 <= y - s + t <= 1.
    for a, b, c in ((-1, -1, x), (1, 1, 1 - x), (-1, 1, y), (1, -1, 1 - y)):
        ring = clipped(ring, lambda p, a=a, b=b, c=c: a * p[0] + b * p[1] + c)
    return area(ring) if len(ring) > 2 else 0.0


def clipped(ring, side):
    """The part of a convex polygon where `side` is not negative."""
    kept = []
    for p, q in zip(ring, ring[1:] + ring[:1], strict=True):
        a, b = side(p), side(q)
        if a >= 0:
            kept.append(p)
        if (a < 0) != (b < 0):
            share = a / (a - b)
            kept.append((p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])))
    return kept


def tent(triangles, corners, place):
    """The square of a barycentric coordinate, or twice the product of two, in the triangle with the place."""
    for triangle in triangles:
        shares = barycentric(triangle, place)
        if min(shares) >= 0 and all(corner in triangle for corner in corners):
            found = [shares[triangle.index(corner)] for corner in corners]
            return found[0] ** 2 if len(found) == 1 else 2 * found[0] * found[1]
    return 0.0


def check():
    """The greatest difference from the area that defines the box spline, and from Bezier's polynomials."""
    basis = box_basis()
    middle = SIDE // 2
    places = [p for row in window((1.013, 1.007), (SIDE - 1.01, SIDE - 1.02)) for p in row]
    found = values(basis.function(*box_name(basis)), places)
    box = max(abs(value - zp(x - middle, y - middle)) for value, (x, y) in zip(found, places, strict=True))
    basis = Basis(KNOTS, "--pull-apart", "all")
    triangles = basis.triangles()
    places = [p for row in window((0.513, 0.507), (8.49, 7.51)) for p in row]
    worst = 0.0
    for name in (["vertex", VERTEX + 1], ["tent", *(knot + 1 for knot in EDGE)]):
        corners = [KNOTS[number - 1] for number in name[1:]]
        for value, place in zip(values(basis.function(*name), places), places, strict=True):
            worst = max(worst, abs(value - tent(triangles, corners, place)))
    return "figures 8.2 and 8.6: difference from areas and from Bezier polynomials", max(box, worst), 1e-10
