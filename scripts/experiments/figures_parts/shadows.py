"""Figure 6.2: simplex splines as shadows of simplices.

The value at a place is the length, area or volume of the part of the simplex above it, over the volume of the
simplex.
"""

import itertools
import math

from panel import Panel, figure
from solid import View, ranges
from svg import BLUE, ORANGE, TEXT
from univariate import simplex_spline

TRIANGLE = [(0.0, 0.4), (1.1, 1.9), (3.0, 0.9)]
# Four places in space, whose first coordinates are the knots of a quadratic B-spline.
OVER_LINE = [(0.0, 0.5, 0.3), (0.9, 1.4, 1.6), (1.9, -0.3, 1.1), (3.0, 0.8, 0.2)]
OVER_PLANE = [(0.0, 0.0, 1.1), (2.6, -0.2, 1.4), (1.5, 2.2, 1.2), (1.3, 0.7, 2.6)]
AT_LINE, AT_PLANE = 1.45, (1.45, 0.95)
STEPS = 60


def cut(points, x):
    """The crossings of the edges of a simplex with the first coordinate x."""
    crossings = []
    for a, b in itertools.combinations(sorted(points), 2):
        if a[0] <= x <= b[0] and a[0] < b[0]:
            share = (x - a[0]) / (b[0] - a[0])
            crossings.append(tuple(p + share * (q - p) for p, q in zip(a, b, strict=True)))
    return crossings


def area(polygon):
    return abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True))) / 2


def ring(places):
    """Places of a convex polygon in order around their middle."""
    x, y = (sum(place[axis] for place in places) / len(places) for axis in (0, 1))
    return sorted(places, key=lambda place: math.atan2(place[1] - y, place[0] - x))


def over_line(points, x):
    """The value at x of the simplex spline of a triangle, or of a tetrahedron, over a line."""
    section = [crossing[1:] for crossing in cut(points, x)]
    if not section:
        return 0.0
    if len(points) == 3:
        heights = [place[0] for place in section]
        return (max(heights) - min(heights)) / area(points)
    return area(ring(section)) / volume(points)


def over_plane(points, place):
    """The value at a place of the simplex spline of a tetrahedron over the plane: the length above it."""
    heights = lengths(points, place)
    return (max(heights) - min(heights)) / volume(points) if heights else 0.0


def lengths(points, place):
    """Heights at which the vertical line through a place crosses the faces of a tetrahedron."""
    heights = []
    for face in itertools.combinations(points, 3):
        shares = barycentric([corner[:2] for corner in face], place)
        if shares and min(shares) >= 0:
            heights.append(sum(share * corner[2] for share, corner in zip(shares, face, strict=True)))
    return heights


def barycentric(triangle, place):
    (ax, ay), (bx, by), (cx, cy) = triangle
    whole = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if whole == 0:
        return None
    b = ((place[0] - ax) * (cy - ay) - (place[1] - ay) * (cx - ax)) / whole
    c = ((bx - ax) * (place[1] - ay) - (by - ay) * (place[0] - ax)) / whole
    return 1 - b - c, b, c


def volume(points):
    (a, *others) = points
    u, v, w = ([p[axis] - a[axis] for axis in range(3)] for p in others)
    minors = (v[1] * w[2] - v[2] * w[1], v[0] * w[2] - v[2] * w[0], v[0] * w[1] - v[1] * w[0])
    return abs(u[0] * minors[0] - u[1] * minors[1] + u[2] * minors[2]) / 6


def shadow(panel, function, knots, to_panel):
    """The plot of a function of the line, downwards, with the knots on the line."""
    low, high = knots[0], knots[-1]
    xs = [low + (high - low) * step / STEPS for step in range(STEPS + 1)]
    panel.polygon([to_panel(low, 0), *(to_panel(x, function(x)) for x in xs), to_panel(high, 0)], BLUE, opacity=0.2)
    panel.line([to_panel(x, function(x)) for x in xs], BLUE, 2)
    panel.line([to_panel(low - 0.3, 0), to_panel(high + 0.3, 0)], TEXT, 1)
    panel.dots([to_panel(knot, 0) for knot in knots], TEXT, 4)


def triangle_panel():
    panel = Panel(0, 0, "A triangle over a line", (-0.3, 3.3), (-1.7, 2.1), is_free=True)
    panel.polygon(TRIANGLE, TEXT, opacity=0.15, stroke=TEXT)
    knots = sorted(point[0] for point in TRIANGLE)
    for point in TRIANGLE:
        panel.line([point, (point[0], -1.4)], TEXT, 0.7, dash="2 4")
    panel.line([place for place in cut(TRIANGLE, AT_LINE)], ORANGE, 3)
    shadow(panel, lambda x: over_line(TRIANGLE, x), knots, lambda x, value: (x, -1.4 + 1.3 * value))
    panel.line([(AT_LINE, -1.4), (AT_LINE, -1.4 + 1.3 * over_line(TRIANGLE, AT_LINE))], ORANGE, 3)
    panel.label((AT_LINE, -1.4), "x", dy=18)
    return panel


def tetrahedron(panel, view, points):
    for a, b in itertools.combinations(points, 2):
        panel.line([view(a), view(b)], TEXT, 1)
    panel.dots([view(point) for point in points], TEXT, 2.5)


def line_panel():
    """The line lies below the tetrahedron, and so does the plot, which is upright."""
    view = View(24, 20)
    base = -1.9
    knots = sorted(point[0] for point in OVER_LINE)

    def foot(x, value):
        return view((x, 0.5, base + 1.9 * value))

    places = [view(p) for p in OVER_LINE] + [foot(x, 0) for x in (-0.3, 3.3)]
    panel = Panel(1, 0, "A tetrahedron over a line", *ranges(places, 0.08))
    for point in OVER_LINE:
        panel.line([view(point), foot(point[0], 0)], TEXT, 0.7, dash="2 4")
    section = cut(OVER_LINE, AT_LINE)
    order = ring([crossing[1:] for crossing in section])
    panel.polygon([view((AT_LINE, *place)) for place in order], ORANGE, opacity=0.6, stroke=ORANGE)
    tetrahedron(panel, view, OVER_LINE)
    shadow(panel, lambda x: over_line(OVER_LINE, x), knots, foot)
    panel.line([foot(AT_LINE, 0), foot(AT_LINE, over_line(OVER_LINE, AT_LINE))], ORANGE, 3)
    x, y = foot(AT_LINE, 0)
    panel.label((x, y), "x", dy=18)
    return panel


def plane_panel():
    view = View(28, 24)
    base = -0.9
    ground = [(x, y, base) for x, y, _ in OVER_PLANE]
    panel = Panel(2, 0, "A tetrahedron over the plane", *ranges([view(p) for p in OVER_PLANE + ground], 0.08))
    for point, foot in zip(OVER_PLANE, ground, strict=True):
        panel.line([view(point), view(foot)], TEXT, 0.7, dash="2 4")
    top = over_plane(OVER_PLANE, OVER_PLANE[3][:2])
    peak = (*OVER_PLANE[3][:2], base + 1.1)
    # The function is linear on the triangles between the projected edges: here, around the inner knot.
    for a, b in itertools.combinations(ground[:3], 2):
        panel.polygon([view(a), view(b), view(peak)], BLUE, opacity=0.18, stroke=BLUE)
    panel.polygon([view(p) for p in ground[:3]], "none", stroke=TEXT)
    tetrahedron(panel, view, OVER_PLANE)
    heights = lengths(OVER_PLANE, AT_PLANE)
    panel.line([view((*AT_PLANE, min(heights))), view((*AT_PLANE, max(heights)))], ORANGE, 3)
    value = over_plane(OVER_PLANE, AT_PLANE) / top * 1.1
    panel.line([view((*AT_PLANE, base)), view((*AT_PLANE, base + value))], ORANGE, 3)
    panel.dots([view(p) for p in ground], TEXT, 4)
    panel.label(view((*AT_PLANE, base)), "x", dy=16)
    return panel


def draw(folder):
    alt = "Simplex splines as shadows: a triangle and a tetrahedron over a line, a tetrahedron over the plane"
    figure(folder / "figure-6.2.svg", alt, [triangle_panel(), line_panel(), plane_panel()])


def check():
    """The greatest difference of sections from the recurrence of B-splines on the line, and on the plane from
    the sum over the faces that the Micchelli recurrence gives for four knots."""
    worst = 0.0
    for step in range(1, STEPS):
        x = 3.0 * step / STEPS + 1e-4
        if x < 3:
            for points in (TRIANGLE, OVER_LINE):
                knots = sorted(point[0] for point in points)
                # The spline of the recurrence has the integral 1 / degree + 1.
                scale = len(knots) - 1
                worst = max(worst, abs(over_line(points, x) - scale * simplex_spline(x, knots)))
    for i, j in itertools.product(range(1, STEPS), repeat=2):
        place = (2.6 * i / STEPS + 1e-4, 2.4 * j / STEPS - 0.2 + 1e-4)
        worst = max(worst, abs(over_plane(OVER_PLANE, place) - linear(place)))
    return "figure 6.2: difference of sections from recurrences", worst, 1e-12


def linear(place):
    """3 M(place | knots) of degree 1 by the recurrence, from the barycentric coordinates in the outer knots."""
    outer, inner = [p[:2] for p in OVER_PLANE[:3]], OVER_PLANE[3][:2]
    shares = barycentric(outer, place)
    value = 0.0
    for knot, share in enumerate(shares):
        face = [p for number, p in enumerate(outer) if number != knot] + [inner]
        if min(barycentric(face, place)) >= 0:
            value += share / area(face)
    return 3 * value
