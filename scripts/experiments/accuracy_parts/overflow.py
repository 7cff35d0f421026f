"""Audit of a mesh in integers of 64 bits that overflow.

The in-sphere determinant of differences of b bits has about 5b bits. However it is evaluated without division, what
overflows is lost modulo 2^64, so that the result is the exact determinant reduced to a signed word. Such an audit of a
mesh that is right finds what table 3.1 of the thesis calls its exact audit: nothing to 16 bits, and faults nearly
everywhere from 20.
"""

from collections import defaultdict

WORD = 1 << 64
FACETS = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))


def count_not_delaunay(points, tetrahedra):
    """Tetrahedra with a vertex of a neighbour inside of their sphere or on it, as overflowing integers see it.

    `points` are triples of integers, `tetrahedra` positive quadruples of their numbers. One value tells for both sides
    of a facet: it is the same determinant, of the same five points.
    """
    beyond = defaultdict(list)
    for number, tetrahedron in enumerate(tetrahedra):
        for apex, facet in enumerate(FACETS):
            beyond[tuple(sorted(tetrahedron[i] for i in facet))].append((number, tetrahedron[apex]))
    faulty = set()
    for sides in beyond.values():
        if len(sides) == 2:
            (left, _), (right, apex) = sides
            corners = [points[vertex] for vertex in tetrahedra[left]]
            if reduced(in_sphere(corners, points[apex])) >= 0:
                faulty.update((left, right))
    return len(faulty)


def reduced(value):
    """The signed word that is left of an integer."""
    return (value + WORD // 2) % WORD - WORD // 2


def in_sphere(corners, point):
    """Positive if the point is inside of the sphere of a positive tetrahedron."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz), (dx, dy, dz) = (
        tuple(x - y for x, y in zip(corner, point)) for corner in corners
    )
    ab, bc, cd = ax * by - bx * ay, bx * cy - cx * by, cx * dy - dx * cy
    da, ac, bd = dx * ay - ax * dy, ax * cy - cx * ay, bx * dy - dx * by
    abc, bcd = az * bc - bz * ac + cz * ab, bz * cd - cz * bd + dz * bc
    cda, dab = cz * da + dz * ac + az * cd, dz * ab + az * bd + bz * da
    lifted = (x * x + y * y + z * z for x, y, z in ((ax, ay, az), (bx, by, bz), (cx, cy, cz), (dx, dy, dz)))
    a, b, c, d = lifted
    return (a * bcd - b * cda) + (c * dab - d * abc)
