"""Audit of a mesh in 64-bit integers that overflow.

The in-sphere determinant of differences of b bits has about 5b bits. Evaluated in any way without division,
it is reduced modulo 2^64, so that the result is the exact determinant wrapped to a signed word. Applied to a
correct mesh, this audit finds what table 3.1 of the thesis calls its exact audit: no faults up to 16 bits,
and faults nearly everywhere from 20 bits.
"""

from collections import defaultdict

WORD = 1 << 64
FACETS = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))


def count_not_delaunay(points, tetrahedra):
    """Number of tetrahedra with a neighbour's vertex inside or on their sphere, as overflowing integers
    decide it.

    `points` are triples of integers, `tetrahedra` positively oriented quadruples of indices. One value
    decides for both sides of a facet, because both have the same determinant of the same five points.
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
    """An integer wrapped to a signed word."""
    return (value + WORD // 2) % WORD - WORD // 2


def in_sphere(corners, point):
    """Positive if the point is inside the sphere of a positive tetrahedron."""
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
