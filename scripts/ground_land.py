"""The land that scripts/gen-ground surveys: everything follows from its seed and a place, so that any part of it
can be drawn alone. Units: metres; classes are those of LAS."""

import math

import numpy as np

GROUND, SHRUB, TREE, ROOF, LOW_NOISE, BRIDGE, HIGH_NOISE = 2, 3, 5, 6, 7, 17, 18

# Lengths and heights of the hills' waves. The short ones stand only where the land is rough: there slopes come to 35
# degrees, and more where all waves fall together.
HILLS = [(2100.0, 30.0), (900.0, 14.0), (420.0, 9.0), (17.0, 0.05), (11.0, 0.03)]
ROUGH = [(170.0, 9.0), (75.0, 4.0)]
# Things that come back every so many metres, along x and y.
QUARRIES, QUARRY_RADIUS, TERRACE, CLIFF, CLIFF_WIDTH = 1200.0, 85.0, 22.0, 10.0, 1.0
RAVINES, RAVINE_WIDTH, RAVINE_DEPTH = 700.0, 12.0, 6.0
BRIDGES, BRIDGE_WIDTH, BRIDGE_LENGTH = 600.0, 8.0, 32.0
NOISE_CELL = 200.0
# Sides of plots, the widths of their roofs, and the part of the mask "town" in which they are built on.
PLOTS = [(32.0, (6.0, 14.0), (0.4, 2.0)), (90.0, (14.0, 60.0), (-0.6, 0.4))]
# Side of a cell with one tree, its least and greatest height and radius.
TREES = [(12.0, (14.0, 28.0), (3.0, 5.5)), (7.0, (4.0, 15.0), (1.2, 3.2))]
SHRUB_CELL = 3.0
FOREST_SHARE, FIELD_SHARE = 0.85, 0.04


class Cells:
    """A lattice of squares with random numbers of their own, those of squares around some places at hand."""

    def __init__(self, seed, side, numbers, x, y):
        self.side, self.low = side, (math.floor(x.min() / side), math.floor(y.min() / side))
        high = math.floor(x.max() / side), math.floor(y.max() / side)
        self.columns, self.rows = high[0] - self.low[0] + 1, high[1] - self.low[1] + 1
        column = np.repeat(np.arange(self.low[0], high[0] + 1), self.rows)
        row = np.tile(np.arange(self.low[1], high[1] + 1), self.columns)
        self.x, self.y = (column + 0.5) * side, (row + 0.5) * side
        self.random = [unit(seed + 1000 * number, column, row) for number in range(numbers)]

    def at(self, x, y):
        """The number of the cell of each place."""
        column = np.floor(x * (1 / self.side)).astype(np.int64) - self.low[0]
        row = np.floor(y * (1 / self.side)).astype(np.int64) - self.low[1]
        return column * self.rows + row


def unit(seed, column, row):
    """A number in [0, 1) for each cell, by the finalizer of SplitMix64."""
    key = column.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    key ^= row.astype(np.uint64) * np.uint64(0xC2B2AE3D27D4EB4F)
    key += np.uint64(seed * 0xD6E8FEB86659FD93 % 2**64)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB), (31, 1)):
        key = (key ^ (key >> np.uint64(shift))) * np.uint64(factor)
    return (key >> np.uint64(11)) * 2.0**-53


def between(limits, share):
    return limits[0] + (limits[1] - limits[0]) * share


class Land:
    def __init__(self, seed, side):
        random = np.random.default_rng([seed, 0])
        self.seed, self.side = seed, side
        wave = lambda length: (2 * math.pi / length / random.uniform(0.8, 1.25), *random.uniform(0, 2 * math.pi, 2))
        self.hills = [(height, *wave(length)) for length, height in HILLS]
        self.rough = [(height, *wave(length)) for length, height in ROUGH]
        lengths = {"rough": (900, 600), "forest": (520, 340), "town": (610, 380)}
        self.masks = {name: [(1.0, *wave(length)) for length in of] for name, of in lengths.items()}
        # So that a small survey has each of them too.
        small = min(side, 500)
        self.quarry = random.uniform(0.25, 0.3, 2) * small
        self.ravine, self.bridge = random.uniform(0.74, 0.8) * small, random.uniform(0.3, 0.6) * small
        self.cloud = random.uniform(0.3, 0.7, 2) * side

    def waves(self, waves, x, y):
        total = np.zeros(len(x))
        for height, number, direction, phase in waves:
            total += height * np.sin(x * (number * math.cos(direction)) + y * (number * math.sin(direction)) + phase)
        return total

    def mask(self, name, x, y):
        """From -2 to 2."""
        return self.waves(self.masks[name], x, y)

    def height(self, x, y):
        rough = np.clip(self.mask("rough", x, y), 0, 1)
        z = 250 + self.waves(self.hills, x, y) + rough * self.waves(self.rough, x, y)
        self.dig_quarry(x, y, z)
        near, across = self.near_ravine(x, y, RAVINE_WIDTH)
        z[near] -= RAVINE_DEPTH / 2 * (1 + np.cos(math.pi / RAVINE_WIDTH * across))
        return z

    def dig_quarry(self, x, y, z):
        """Terraces, each a cliff below the one around it."""
        east, north = (fold(place - centre, QUARRIES) for place, centre in zip((x, y), self.quarry))
        radius = np.hypot(east, north)
        near = np.flatnonzero(radius < 1.2 * QUARRY_RADIUS)
        # Not round, so that cliffs have all directions and corners.
        radius = radius[near] * (1 + 0.12 * np.sin(3 * np.arctan2(north[near], east[near])))
        for terrace in range(3):
            z[near] -= CLIFF * np.clip((QUARRY_RADIUS - TERRACE * terrace - radius) / CLIFF_WIDTH, 0, 1)

    def near_ravine(self, x, y, reach):
        """The places within reach of a ravine, and how far they are to the north of its middle."""
        across = fold(y - self.ravine - 20 * np.sin(x / 110), RAVINES)
        near = np.flatnonzero(np.abs(across) < reach)
        return near, across[near]

    def decks(self, x, y):
        """The places on bridges, and the heights of the decks, which end on the ground."""
        near, across = self.near_ravine(x, y, BRIDGE_LENGTH / 2)
        on = np.abs(fold(x[near] - self.bridge, BRIDGES)) < BRIDGE_WIDTH / 2
        near, across = near[on], across[on]
        ends = BRIDGE_LENGTH / 2, -BRIDGE_LENGTH / 2
        north, south = (self.height(x[near], y[near] - across + end) for end in ends)
        share = across / BRIDGE_LENGTH + 0.5
        return near, share * north + (1 - share) * south

    def roofs(self, x, y):
        """Of houses and of large buildings: the places on roofs, the heights there, those of the eaves, and how far
        the places are from an edge."""
        for layer, (side, widths, within) in enumerate(PLOTS):
            yield self.roofs_of(Cells(self.seed + 1 + layer, side, 5, x, y), widths, within, x, y)

    def roofs_of(self, plots, widths, within, x, y):
        built, wide, long, turn, tall = plots.random
        width = widths[0] * (widths[1] / widths[0]) ** wide
        length = np.minimum(width * (1 + long), np.sqrt((plots.side - 2) ** 2 - width**2))
        cos, sin = np.cos(math.pi * turn), np.sin(math.pi * turn)
        ends = [(a * length / 2, b * width / 2) for a in (-1, 1) for b in (-1, 1)]
        corners = [self.height(plots.x + u * cos - v * sin, plots.y + u * sin + v * cos) for u, v in ends]
        low, high = np.min(corners, 0), np.max(corners, 0)
        town = self.mask("town", plots.x, plots.y)
        stands = (built < 0.8) & (town > within[0]) & (town < within[1]) & (high - low < 8)
        stands[self.near_ravine(plots.x, plots.y, plots.side / 2 + RAVINE_WIDTH)[0]] = False
        eaves = high + 3 + 12 * tall * np.minimum(1, width / 25)
        pitch = np.where(width < 18, 0.6, 0.0)
        at = plots.at(x, y)
        on = np.flatnonzero(stands[at])
        at = at[on]
        east, north = x[on] - plots.x[at], y[on] - plots.y[at]
        along = length[at] / 2 - np.abs(east * cos[at] + north * sin[at])
        across = width[at] / 2 - np.abs(north * cos[at] - east * sin[at])
        inside = (along > 0) & (across > 0)
        on, at, along, across = on[inside], at[inside], along[inside], across[inside]
        return on, eaves[at] + pitch[at] * across, eaves[at], np.minimum(along, across)

    def crowns(self, x, y):
        """For all places the height of the crown there, or NaN, that of its lower end, and its density."""
        top, bottom, dense = np.full(len(x), np.nan), np.zeros(len(x)), np.zeros(len(x))
        for layer, (side, heights, radii) in enumerate(TREES):
            cells = Cells(self.seed + 10 + layer, side, 6, x, y)
            there, tall, wide, east, north, thick = cells.random
            share = np.where(self.mask("forest", cells.x, cells.y) > 0.3, FOREST_SHARE, FIELD_SHARE)
            tree_top, radius = between(heights, tall), between(radii, wide)
            reach = side / 2 - radius
            tree_x, tree_y = cells.x + reach * (2 * east - 1), cells.y + reach * (2 * north - 1)
            foot = self.height(tree_x, tree_y)
            at = cells.at(x, y)
            square = ((x - tree_x[at]) ** 2 + (y - tree_y[at]) ** 2) / radius[at] ** 2
            under = np.flatnonzero((square < 1) & (there < share)[at])
            at = at[under]
            crown = foot[at] + tree_top[at] * (0.5 + 0.5 * np.sqrt(1 - square[under]))
            higher = ~(crown <= top[under])
            under, at = under[higher], at[higher]
            top[under], bottom[under] = crown[higher], foot[at] + 0.35 * tree_top[at]
            dense[under] = 0.35 + 0.6 * thick[at]
        return top, bottom, dense

    def shrubs(self, x, y):
        """The places in shrubs, and how far these reach above the ground."""
        cells = Cells(self.seed + 20, SHRUB_CELL, 3, x, y)
        there, tall, wide = cells.random
        at = cells.at(x, y)
        near = np.flatnonzero(there[at] < 0.12)
        at = at[near]
        radius = between((0.5, 1.4), wide[at])
        inside = (x[near] - cells.x[at]) ** 2 + (y[near] - cells.y[at]) ** 2 < radius**2
        return near[inside], between((0.3, 1.0), tall[at[inside]])

    def pits(self, x, y):
        """The places in a cluster of low noise, and how far below the ground it is."""
        cells = Cells(self.seed + 30, NOISE_CELL, 5, x, y)
        there, east, north, wide, deep = cells.random
        at = cells.at(x, y)
        place = lambda middle, share: middle + NOISE_CELL * 0.45 * (2 * share - 1)
        square = (x - place(cells.x, east)[at]) ** 2 + (y - place(cells.y, north)[at]) ** 2
        inside = np.flatnonzero((square < between((0.5, 1.8), wide[at]) ** 2) & (there[at] < 0.5))
        return inside, between((1.0, 30.0), deep[at[inside]])

    def in_cloud(self, x, y):
        """The places under the one cloud, which is lower over small surveys."""
        radius = min(30.0, self.side / 10)
        return np.flatnonzero((x - self.cloud[0]) ** 2 + (2 * (y - self.cloud[1])) ** 2 < radius**2)


def fold(distance, period):
    """The distance from the nearest of the places that come back each period."""
    return distance - period * np.round(distance / period)
