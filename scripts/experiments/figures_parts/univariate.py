"""Figures 6.1 and 8.1: univariate B-splines, their bases, and control polygons.

The recurrence is equation 6.1 of the thesis with its two terms exchanged: as printed, the splines with and without
the first knot have each other's factor.
"""

import math

from panel import Panel, figure
from svg import BLUE, GREEN, ORANGE, PURPLE, RED, TEXT

COLOURS = (BLUE, ORANGE, GREEN, PURPLE, RED)
# Knots of the quadratic basis: the ends are repeated, so that it sums to one up to them.
KNOTS = [0, 0, 0, 1, 2.4, 3, 4.2, 5, 5, 5]
COEFFICIENTS = [0.6, 2.2, 1.1, 2.9, 0.5, 1.6, 1.2]
DEGREE = 2
STEPS = 120


def simplex_spline(x, knots):
    """M(x | knots): the B-spline of integral 1 / (number of knots - 1)."""
    width = knots[-1] - knots[0]
    if width == 0:
        return 0.0
    if len(knots) == 2:
        return 1 / width if knots[0] <= x < knots[1] else 0.0
    without_last, without_first = simplex_spline(x, knots[:-1]), simplex_spline(x, knots[1:])
    return ((x - knots[0]) * without_last + (knots[-1] - x) * without_first) / width


def b_spline(x, knots):
    """The B-spline that sums to one with its neighbours."""
    return (knots[-1] - knots[0]) * simplex_spline(x, knots)


def basis(x, knots, degree):
    count = len(knots) - degree - 1
    return [b_spline(x, knots[i : i + degree + 2]) for i in range(count)]


def sites(low, high):
    """Sites from end to end; the last one is just inside, because splines are those of half-open intervals."""
    return [low + (high - low) * min(step, STEPS - 1e-9) / STEPS for step in range(STEPS + 1)]


def greville(knots, degree):
    return [sum(knots[i + 1 : i + 1 + degree]) / degree for i in range(len(knots) - degree - 1)]


def axis(panel, knots, low, high):
    """The axis with a tick for each knot; repeated knots are stacked dots."""
    panel.line([(low, 0), (high, 0)], TEXT, 1)
    for knot in sorted(set(knots)):
        for copy in range(knots.count(knot)):
            x, y = panel.at((knot, 0))
            panel.parts.append(f'<circle cx="{x:.1f}" cy="{y + 7 + 7 * copy:.1f}" r="2.6" fill="{TEXT}"/>')


def curve(panel, function, low, high, colour, **style):
    panel.line([(x, function(x)) for x in sites(low, high)], colour, **style)


def draw_basis(folder):
    """Counterclockwise from the upper left: B-splines of degree 0, 1 and 2, and a quadratic basis."""
    panels = []
    places = [((0, 0), [0, 1.3]), ((0, 1), [0, 1, 2.3]), ((1, 1), [0, 1, 2.3, 3])]
    for degree, ((column, row), knots) in enumerate(places):
        panel = Panel(column, row, f"B-spline of degree {degree}", (-0.4, 3.4), (-0.25, 1.25), is_free=True)
        axis(panel, knots, -0.4, 3.4)
        if degree == 0:
            panel.line([(0, 1), (1.3, 1)], BLUE, 2.5)
            for end in knots:
                panel.line([(end, 0), (end, 1)], BLUE, 1, dash="3 4")
        else:
            curve(panel, lambda x, knots=knots: b_spline(x, knots), knots[0], knots[-1], BLUE, width=2.5)
        panels.append(panel)
    panel = Panel(1, 0, "Quadratic basis, and its sum", (-0.4, 5.4), (-0.25, 1.25), is_free=True)
    axis(panel, KNOTS, -0.4, 5.4)
    curve(panel, lambda x: sum(basis(x, KNOTS, DEGREE)), 0, 5, TEXT, width=1.2, dash="5 4")
    for i in range(len(KNOTS) - DEGREE - 1):
        knots = KNOTS[i : i + DEGREE + 2]
        curve(panel, lambda x, knots=knots: b_spline(x, knots), knots[0], knots[-1], COLOURS[i % 5], width=2)
    figure(folder / "figure-6.1.svg", "Univariate B-splines of degree 0, 1 and 2, and a quadratic basis", [*panels, panel])


def polygon_panel(column, row):
    """The control polygon of a quadratic spline: coefficients above Greville sites."""
    panel = Panel(column, row, "A control polygon", (-0.4, 5.4), (-0.6, 3.3), is_free=True)
    axis(panel, KNOTS, -0.4, 5.4)
    control = list(zip(greville(KNOTS, DEGREE), COEFFICIENTS, strict=True))
    panel.line(control, ORANGE, 1.5)
    curve(panel, spline, 0, 5, BLUE, width=2.5)
    panel.dots(control, ORANGE, 4)
    return panel


def spline(x):
    return sum(c * b for c, b in zip(COEFFICIENTS, basis(x, KNOTS, DEGREE), strict=True))


def check():
    """The greatest difference from scipy's B-splines, for degrees 0 to 4."""
    from scipy.interpolate import BSpline

    worst = 0.0
    for degree in range(5):
        knots = [0.0] * degree + [0, 1, 2.4, 3, 4.2, 4.2, 5] + [5.0] * degree
        for i in range(len(knots) - degree - 1):
            part = knots[i : i + degree + 2]
            if part[0] == part[-1]:
                continue
            theirs = BSpline.basis_element(part, extrapolate=False)
            for x in sites(part[0], part[-1])[:-1]:
                other = float(theirs(x))
                worst = max(worst, abs(b_spline(x, part) - (0.0 if math.isnan(other) else other)))
    return "figures 6.1 and 8.1: difference from scipy's B-splines", worst, 1e-12
