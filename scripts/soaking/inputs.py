"""Seeded input files of scripts/soak: points with ties, lines, structures, and an endless stream of points."""

import math
import struct

# All points with integer coordinates on the circle of this radius around the origin.
RADIUS = 1105
CIRCLE = [
    (x, sign * y)
    for x in range(-RADIUS, RADIUS + 1)
    for y in [math.isqrt(RADIUS * RADIUS - x * x)]
    if x * x + y * y == RADIUS * RADIUS
    for sign in (1, -1)
]


def uniform(random, n, dims):
    return [tuple(random.randrange(1 << 20) for _ in range(dims)) for _ in range(n)]


def lattice(random, n, dims):
    """As many places as points: a third of them coincide, and all others are cocircular with neighbours."""
    side = max(2, round(n ** (1 / dims)))
    return [tuple(random.randrange(side) for _ in range(dims)) for _ in range(n)]


def clusters(random, n, dims):
    centres = [[random.randrange(1 << 20) for _ in range(dims)] for _ in range(5)]
    return [tuple(int(random.gauss(c, 300)) for c in random.choice(centres)) for _ in range(n)]


def circles(random, n, dims):
    """Concentric circles; in space, rings of cylinders."""
    found = []
    for _ in range(n):
        (x, y), k = random.choice(CIRCLE), random.randrange(1, 30)
        found.append((k * x, k * y, *(random.randrange(8) for _ in range(dims - 2))))
    return found


def line(random, n, dims):
    return [tuple((k + 1) * i for k in range(dims)) for i in (random.randrange(4 * n) for _ in range(n))]


AREAS = [uniform, lattice, clusters, circles]
ALL = [*AREAS, line]


def points(random, family, n, dims):
    """Integer points of three coordinates; in the plane, the third is an elevation."""
    places = family(random, n, dims)
    if dims == 3:
        return places
    return [(x, y, (x // 7 + y // 11) % 500 + random.randrange(5)) for x, y in places]


def write_text(path, points):
    with open(path, "w") as file:
        file.writelines(f"{x} {y} {z}\n" for x, y, z in points)


def write_npy(path, points):
    header = "{'descr': '<f8', 'fortran_order': False, 'shape': (%d, 3), }" % len(points)
    header += " " * (63 - (10 + len(header)) % 64) + "\n"
    with open(path, "wb") as file:
        file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode())
        for point in points:
            file.write(struct.pack("<3d", *point))


def write_las(path, points, scale=0.01):
    """LAS 1.2, point format 0; the coordinates of the file are those of the points times the scale."""
    low = [scale * min(point[axis] for point in points) for axis in range(3)]
    high = [scale * max(point[axis] for point in points) for axis in range(3)]
    box = [bound for axis in (0, 1, 2) for bound in (high[axis], low[axis])]
    counts = (len(points), len(points), 0, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"LASF" + bytes(20) + b"\x01\x02" + b"soak".ljust(32, b"\0") + b"scripts/soak".ljust(32, b"\0"))
        file.write(struct.pack("<HHHIIBH6I", 1, 2026, 227, 227, 0, 0, 20, *counts))
        file.write(struct.pack("<12d", *[scale] * 3, 0, 0, 0, *box))
        for point in points:
            file.write(struct.pack("<3iHBBbBH", *point, 0, 9, 2, 0, 0, 0))


def write_raw(path, random, n):
    """Points of three unsigned 16-bit numbers (--raw u16le); many coincide in the plane."""
    with open(path, "wb") as file:
        for start in range(0, n, 100_000):
            file.write(random.randbytes(6 * min(100_000, n - start)))


def write_lines(path, random, points, n):
    """Polylines of n vertices in all between given points, which cross each other."""
    with open(path, "w") as file:
        for start in range(0, n, 5):
            file.write("line\n")
            for _ in range(min(5, n - start)):
                file.write("%d %d %d\n" % random.choice(points))


def write_structure(path, random, n):
    """A structure in PDB with n atoms, on a grid of 0.1 so that some are cospherical."""
    side = 3 * n ** (1 / 3)
    with open(path, "w") as file:
        for i in range(n):
            x, y, z = (round(random.uniform(0, side), 1) for _ in range(3))
            element = random.choice("CNO")
            file.write(f"ATOM  {i % 99999 + 1:5d}  {element}   GLY A{i // 4 % 9999 + 1:4d}    "
                       f"{x:8.3f}{y:8.3f}{z:8.3f}  1.00  0.00           {element}\n")
        file.write("END\n")


def strip(random, depth=22, wide=4, side=1024, cell_points=200):
    """An endless strip of cells as the text twin of a stream, a string for each cell. After each, the caller may
    stop and write what `end` returns for the counts so far. Cells beside the strip are empty and tagged, so that
    only the front of the strip waits in the programs that read it."""
    yield 0, 0, (
        "#spmesh version 2\n#spmesh kind points\n#spmesh coordinates f64\n#spmesh dims 2\n#spmesh elevation yes\n"
        f"#spmesh tree {depth} 0 0 0 {side << depth}\n#spmesh chunked yes\n#spmesh producer \"soak\"\n"
    )
    written = tags = 0
    waiting = [(0, 1, 0, 0)]
    while waiting:
        level, code, column, row = waiting.pop()
        if column << (depth - level) >= wide:
            text = ""
        elif level < depth:
            waiting += [(level + 1, 4 * code + k, 2 * column + k % 2, 2 * row + k // 2) for k in (3, 2, 1, 0)]
            continue
        else:
            x, y = column * side, row * side
            text = "".join(
                f"v {x + random.randrange(side)} {y + random.randrange(side)} {random.randrange(90)}\n"
                for _ in range(cell_points)
            )
            written += cell_points
        tags += 1
        yield written, tags, f"{text}x cell {code}\n"


def end(written, tags):
    return f"# end points {written} cells {tags} vertices 0 simplices 0 merged 0 residual 0 walls 0\n"
