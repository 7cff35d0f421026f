"""Pictures of space: a parallel projection, and surfaces over the plane."""

import math


class View:
    """From (x, y, z) to (right, up), seen from above one side. `azimuth` and `tilt` are in degrees; a tilt of
    90 looks straight down."""

    def __init__(self, azimuth, tilt, lift=1.0):
        a, b = math.radians(azimuth), math.radians(tilt)
        self.turn = math.cos(a), math.sin(a)
        self.tilt = math.cos(b), math.sin(b)
        self.lift = lift

    def __call__(self, place):
        x, y, z = place
        across, depth = self.turned(x, y)
        return across, depth * self.tilt[1] + z * self.lift * self.tilt[0]

    def turned(self, x, y):
        (c, s) = self.turn
        return x * c - y * s, x * s + y * c

    def depth(self, place):
        """Grows away from the eye."""
        return self.turned(place[0], place[1])[1]


def ranges(places, pad=0.04):
    """The ranges of projected places, and some room around them."""
    result = []
    for axis in (0, 1):
        values = [place[axis] for place in places]
        room = pad * (max(values) - min(values))
        result.append((min(values) - room, max(values) + room))
    return result


def surface(panel, view, faces, colour):
    """Draws faces, which are lists of places in space, back to front; those at height zero are left out. Heights are
    shaded from light to the colour."""
    top = max(place[2] for face in faces for place in face)
    raised = [face for face in faces if max(abs(place[2]) for place in face) > 1e-9]

    def middle(face):
        return [sum(place[axis] for place in face) / len(face) for axis in range(3)]

    for face in sorted(raised, key=lambda face: view.depth(middle(face)), reverse=True):
        fill = shade(colour, middle(face)[2] / top)
        panel.polygon([view(place) for place in face], fill, stroke=shade(colour, 1.15), width=0.35)


def quadrilaterals(rows, heights):
    """The faces of a grid of places (x, y) with heights."""
    lifted = [
        [(*place, height) for place, height in zip(row, found, strict=True)]
        for row, found in zip(rows, heights, strict=True)
    ]
    return [
        [above[i], above[i + 1], below[i + 1], below[i]]
        for above, below in zip(lifted, lifted[1:], strict=False)
        for i in range(len(above) - 1)
    ]


def divided(triangle, parts):
    """The small triangles of a triangle in the plane whose sides are cut into parts."""

    def at(i, j):
        shares = (parts - i - j) / parts, i / parts, j / parts
        return tuple(sum(share * corner[axis] for share, corner in zip(shares, triangle, strict=True)) for axis in (0, 1))

    for i in range(parts):
        for j in range(parts - i):
            yield [at(i, j), at(i + 1, j), at(i, j + 1)]
            if i + j < parts - 1:
                yield [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]


def shade(colour, share):
    """From a light tint at 0 to the colour at 1, and darker beyond."""
    parts = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
    light = [240, 243, 247]
    mixed = [min(255, max(0, round(a + share * (b - a)))) for a, b in zip(light, parts, strict=True)]
    return "#" + "".join(f"{part:02x}" for part in mixed)
