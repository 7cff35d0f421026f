"""Figure 3.4: the tetrahedra that rounding makes wrong.

The thesis shows those of 1H1K, whose atoms are shells of a virus. Points on concentric spheres have the same cause:
many of them are nearly on one sphere.
"""

import math
from fractions import Fraction

from panel import Panel, figure
from programs import Workplace, progress, write_tsv
from svg import RED, TEXT

SHELLS, QUICK_SHELLS = ((250, 600), (40.0, 120.0)), ((60,), (40.0,))
MARGIN = 3.0
FACETS = ((1, 3, 2), (0, 2, 3), (0, 3, 1), (0, 1, 2))


def run(flags):
    counts, radii = QUICK_SHELLS if flags.quick else SHELLS
    with Workplace() as place:
        lines = [f"{x!r} {y!r} {z!r}\n" for count, radius in zip(counts, radii) for x, y, z in shell(count, radius)]
        place.points.write_text("".join(lines))
        said = place.triangulate("--arithmetic", "float")
        points, tetrahedra = place.tetrahedra(lambda word: Fraction(float(word)))
    wrong = [corners for corners, is_wrong in zip(tetrahedra, violations(points, tetrahedra)) if is_wrong]
    if len(wrong) != said["violations"]:
        raise SystemExit(f"{len(wrong)} wrong tetrahedra, but tess3 counts {said['violations']}")
    progress(f"wrong: {len(wrong)} of {len(tetrahedra)} tetrahedra")
    rows = [(len(points), len(tetrahedra), len(wrong))]
    write_tsv(flags.out / "figure-3.4.tsv", ("points", "tetrahedra", "wrong"), rows)
    draw(flags.out / "figure-3.4.svg", points, wrong)


def shell(count, radius):
    """A spiral from pole to pole, which spreads points evenly."""
    for number in range(count):
        z = 1 - (2 * number + 1) / count
        angle = number * math.pi * (3 - math.sqrt(5))
        side = math.sqrt(1 - z * z)
        yield radius * side * math.cos(angle), radius * side * math.sin(angle), radius * z


def violations(points, tetrahedra):
    """For each tetrahedron, whether it is not positive or has a vertex of a neighbour inside, in fractions."""
    beyond = {}
    for number, corners in enumerate(tetrahedra):
        for side, facet in enumerate(FACETS):
            beyond.setdefault(frozenset(corners[i] for i in facet), []).append((number, corners[side]))
    for number, corners in enumerate(tetrahedra):
        at = [points[corner] for corner in corners]
        wrong = orientation(*at) <= 0
        for facet in FACETS:
            pairs = beyond[frozenset(corners[i] for i in facet)]
            wrong = wrong or any(other != number and in_sphere(*at, points[apex]) > 0 for other, apex in pairs)
        yield wrong


def minus(p, q):
    return [a - b for a, b in zip(p, q)]


def det3(a, b, c):
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]))  # fmt: skip


def orientation(a, b, c, d):
    return det3(minus(b, a), minus(c, a), minus(d, a))


def in_sphere(a, b, c, d, e):
    """Positive if e is inside of the sphere of a positive tetrahedron."""
    rows = [minus(p, e) for p in (a, b, c, d)]
    lifts = [sum(x * x for x in row) for row in rows]
    others = [[rows[j] for j in range(4) if j != i] for i in range(4)]
    return sum((-1) ** i * lifts[i] * det3(*others[i]) for i in range(4))


def draw(path, points, wrong):
    panel = Panel(0, 0, f"{len(wrong):,} wrong tetrahedra", *[span(points, axis) for axis in (0, 2)])
    edges = {tuple(sorted((a, b))) for t in wrong for i, a in enumerate(t) for b in t[i + 1 :]}
    for a, b in sorted(edges):
        panel.line([flat(points[a]), flat(points[b])], RED, 0.35)
    panel.dots([flat(point) for point in points], TEXT, 1.1)
    figure(path, "The tetrahedra whose spheres are not empty after triangulation in floating point", [panel])


def flat(point):
    return float(point[0]), float(point[2])


def span(points, axis):
    values = [float(point[axis]) for point in points]
    return min(values) - MARGIN, max(values) + MARGIN
