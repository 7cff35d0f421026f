"""Point sets in 3D for comparisons, most of them degenerate, and weights for them.

Each function of FAMILIES makes about `count` points; each of WEIGHTS makes one weight per point.
"""

import itertools
import math


def uniform(rng, count):
    return [(rng.random(), rng.random(), rng.random()) for _ in range(count)]


def ten_bits(rng, count):
    return [tuple(rng.randrange(1024) for _ in range(3)) for _ in range(count)]


def atoms(rng, count):
    """Multiples of 0.001, as decimals or scaled to integers, as dense as atoms."""
    side = round(1000 * (10 * count) ** (1 / 3)) + 1
    unit = rng.choice([1, 1000])
    return [tuple(rng.randrange(-side, side) / unit for _ in range(3)) for _ in range(count)]


def box(rng, count):
    """Integer points of a box with about `count` points; its sides may be as short as one."""
    sides = [max(1, round(count ** rng.uniform(0.1, 0.45))) for _ in range(2)]
    sides.append(max(1, count // (sides[0] * sides[1])))
    rng.shuffle(sides)
    return list(itertools.product(*map(range, sides)))


def cubic(rng, count):
    side = max(1, round(count ** (1 / 3)))
    return list(itertools.product(range(side), repeat=3))


def cubic_grid(rng, count):
    return rng.choice([cubic, box])(rng, count)


def cubic_grid_with_holes(rng, count):
    share, step = rng.uniform(0.05, 0.95), rng.choice([1, 0.25, 7])
    grid = rng.choice([cubic, box])(rng, int(count / share))
    return [tuple(step * c for c in point) for point in grid if rng.random() < share]


def face_centred_grid(rng, count):
    side = max(2, round((2 * count) ** (1 / 3)))
    return [point for point in itertools.product(range(side), repeat=3) if sum(point) % 2 == 0]


def face_centred_grid_with_holes(rng, count):
    share = rng.uniform(0.1, 0.95)
    return [point for point in face_centred_grid(rng, int(count / share)) if rng.random() < share]


def rotated_lattice(rng, count):
    """A grid with or without holes, transformed by an integer matrix, whose rows may be orthogonal."""
    rows = rng.choice([[(3, -4, 0), (4, 3, 0), (0, 0, 5)], [(1, 2, 2), (2, 1, -2), (2, -2, 1)], [(3, 1, 0), (-1, 3, 1), (1, -1, 2)]])
    grid = rng.choice([cubic, cubic_grid_with_holes])(rng, count)
    return [tuple(sum(a * c for a, c in zip(row, point)) for row in rows) for point in grid]


def turned_lattice(rng, count):
    """A grid turned by random angles, which makes every tie a near tie."""
    angle, tilt = rng.uniform(0, 6), rng.uniform(0, 6)
    c, s, k, t = math.cos(angle), math.sin(angle), math.cos(tilt), math.sin(tilt)
    turned = ((c * x - s * y, s * x + c * y, z) for x, y, z in cubic_grid_with_holes(rng, count))
    return [(x, k * y - t * z, t * y + k * z) for x, y, z in turned]


def sphere(squares):
    """All integer points whose squared distance from the origin is `squares`."""
    reach = math.isqrt(squares)
    found = []
    for x in range(-reach, reach + 1):
        for y in range(-math.isqrt(squares - x * x), math.isqrt(squares - x * x) + 1):
            z = math.isqrt(squares - x * x - y * y)
            if x * x + y * y + z * z == squares:
                found += {(x, y, z), (x, y, -z)}
    return found


def cospherical(rng, count):
    """Integer points on one sphere or several, with or without the centre."""
    # Integers that are sums of three squares in many ways, about ten times their square root.
    sums = [number for number in (5, 9, 41, 89, 194, 1105, 5525, 27625, 99986, 300005) if number < 9 + count * count / 50]
    spheres = [sphere(rng.choice(sums[-4:])) for _ in range(rng.choice([1, 1, 2, 3]))]
    points = [point for each in spheres for point in each]
    rng.shuffle(points)
    return points[:count] + [(0, 0, 0)] * rng.randrange(2)


def nested_cubes(rng, count):
    """Corners of cubes, or of boxes, around one centre: eight cospherical points each."""
    sizes = [rng.randrange(1, 4 * count) for _ in range(max(1, count // 8))]
    heights = sizes if rng.random() < 0.5 else [rng.randrange(1, 100) for _ in sizes]
    signs = list(itertools.product((-1, 1), repeat=3))
    return [(x * size, y * size, z * height) for size, height in zip(sizes, heights) for x, y, z in signs]


def random_plane(rng):
    """A start and two integer directions."""
    return [[rng.randrange(-3, 4) for _ in range(3)] for _ in range(3)]


def in_plane(plane, i, j):
    start, u, v = plane
    return tuple(10 * a + i * b + j * c for a, b, c in zip(start, u, v))


def coplanar_pieces(rng, count):
    """Integer squares in a few planes that intersect."""
    planes = [random_plane(rng) for _ in range(rng.randrange(2, 6))]
    reach = max(1, math.isqrt(count // len(planes)) // 2)
    return [in_plane(rng.choice(planes), rng.randint(-reach, reach), rng.randint(-reach, reach)) for _ in range(count)]


def tent(rng, count):
    """A piece of a plane and a few points beside it."""
    plane, reach = random_plane(rng), max(1, math.isqrt(count))
    flat = [in_plane(plane, rng.randrange(reach), rng.randrange(reach)) for _ in range(count)]
    return [tuple(rng.randrange(-50, 50) for _ in range(3)) for _ in range(rng.randrange(1, 5))] + flat


def flat(rng, count):
    """Points in one plane, on one line, or one point."""
    plane, reach = random_plane(rng), max(1, math.isqrt(count))
    width = rng.choice([reach, reach, 1])
    return [in_plane(plane, rng.randrange(reach), rng.randrange(width)) for _ in range(count)]


def collinear_runs(rng, count):
    """Points along a few lines, which have about as many tetrahedra as pairs of points."""
    lines = [random_plane(rng)[:2] for _ in range(rng.randrange(2, 6))]
    if rng.random() < 0.5:
        lines = [(start, rng.choice([(1, 0, 0), (0, 1, 0), (0, 0, 1)])) for start, _ in lines]
    few = min(count, 600)
    return [tuple(a + rng.randrange(few) * b for a, b in zip(*rng.choice(lines))) for _ in range(few)]


def duplicates(rng, count):
    """More points than distinct positions."""
    side = rng.choice([2, 3, 4, max(2, round((count / 3) ** (1 / 3)))])
    return [tuple(rng.randrange(side) for _ in range(3)) for _ in range(count)]


def clusters(rng, count):
    """Clusters about 1e-6 wide, with random offsets, multiples of 1e-6 or multiples of 2^-20."""
    centres = [[rng.choice([rng.randrange(100), rng.random()]) for _ in range(3)] for _ in range(rng.randrange(1, 20))]
    near = rng.choice([lambda: rng.gauss(0, 1e-6), lambda: rng.randrange(8) * 1e-6, lambda: rng.randrange(8) * 2.0**-20])
    return [tuple(c + near() for c in rng.choice(centres)) for _ in range(count)]


def extreme(rng, count):
    """Very small or very large coordinates of grids or random points."""
    scale = rng.choice([1e-300, 2.0**-1070, 2.0**-400, 1e-30, 1e30, 2.0**400, 1e150, 1e300])
    make = rng.choice([uniform, cubic_grid_with_holes, duplicates])
    points = make(rng, min(count, 3000))
    far = max((abs(c) for point in points for c in point), default=1) or 1
    scale = min(scale, 1e307 / far)
    return [tuple(c * scale for c in point) for point in points]


def mixed_scales(rng, count):
    """Random points whose distances from the origin span many orders of magnitude."""
    few = min(count, 3000)
    return [tuple(rng.choice([-1, 1]) * 10 ** rng.uniform(-12, 12) for _ in range(3)) for _ in range(few)]


def surface(rng, count):
    """A unit sphere in f64, or a large sphere or cylinder rounded to integers."""
    radius = rng.choice([1, 1000, 1e6])
    points = []
    for _ in range(count):
        z, angle = rng.uniform(-1, 1), rng.uniform(0, math.tau)
        across = math.sqrt(1 - z * z) if radius != 1000 else 1
        point = [radius * across * math.cos(angle), radius * across * math.sin(angle), radius * z]
        points.append(tuple(point if radius == 1 else map(round, point)))
    return points


def few(rng, count):
    """Up to eight points on a 3 x 3 x 3 grid, so that every way to start occurs."""
    return [tuple(rng.randrange(3) for _ in range(3)) for _ in range(rng.randrange(0, 9))]


FAMILIES = [
    uniform, ten_bits, atoms, cubic_grid, cubic_grid_with_holes, face_centred_grid, face_centred_grid_with_holes,
    rotated_lattice, turned_lattice, cospherical, nested_cubes, coplanar_pieces, tent, flat, collinear_runs,
    duplicates, clusters, extreme, mixed_scales, surface, few,
]  # fmt: skip


def square_of_spacing(points):
    """The square of the mean distance between neighbours, if the points filled their box."""
    sides = [max(axis) - min(axis) for axis in zip(*points)]
    spacing = max(sides, default=0) / max(1, len(points)) ** (1 / 3)
    return spacing * spacing


def equal(rng, points):
    return [rng.uniform(-1, 1) * square_of_spacing(points)] * len(points)


def small(rng, points):
    """Random weights that hide few points."""
    square = square_of_spacing(points)
    return [rng.uniform(-0.2, 0.2) * square for _ in points]


def large(rng, points):
    """Random weights that hide many points."""
    square = rng.choice([3, 30, 1000]) * square_of_spacing(points)
    return [rng.random() * square for _ in points]


def integer(rng, points):
    return [rng.randrange(3) for _ in points]


def lifted_to_planes(rng, points):
    """Weights that lift the points to one horizontal hyperplane, or to three: exactly so, if the squares of
    their distances from the origin are exact."""
    steps = rng.choice([[0], [-1, 0, 1]])
    return [sum(c * c for c in point) + rng.choice(steps) for point in points]


def one_huge(rng, points):
    """Equal weights but one, which may hide all other points or none."""
    weights = [0.0] * len(points)
    if points:
        weights[rng.randrange(len(points))] = 10 ** rng.uniform(-1, 6) * square_of_spacing(points)
    return weights


WEIGHTS = [equal, small, large, integer, lifted_to_planes, one_huge]


def with_weights(rng, points, weights):
    """The points, each with its weight as its fourth number, of a function of WEIGHTS."""
    finite = (min(max(float(weight), -1e307), 1e307) for weight in weights(rng, points))
    return [(*point, weight) for point, weight in zip(points, finite)]
