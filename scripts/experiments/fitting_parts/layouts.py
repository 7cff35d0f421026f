"""Knots for scattered points."""

import numpy as np

# Distance by which inner knots are moved, in cells, so that no three are collinear.
MOVED = 0.2
SEED = 1


def grid(cells):
    """Makes a function that writes knots on a grid of nearly square cells over the box of points: `cells`
    along the longer side, with inner knots moved."""

    def make(work, points):
        low, high = points[:, :2].min(0), points[:, :2].max(0)
        counts = np.maximum(np.round(cells * (high - low) / (high - low).max()), 2).astype(int)
        columns, rows = np.meshgrid(*(np.arange(count + 1) for count in counts))
        places = np.column_stack([columns.ravel(), rows.ravel()]).astype(float)
        inside = ((places > 0) & (places < counts)).all(1)
        random = np.random.default_rng(SEED)
        moves = random.uniform(-1, 1, places.shape)
        # An edge that cuts off a corner would allow a fold along it. Knots moved towards the corner have an
        # edge to it.
        next_to_corner = ((places == 1) | (places == counts - 1)).all(1)
        moves[next_to_corner] = np.where(places == 1, -1.0, 1.0)[next_to_corner]
        places[inside] += MOVED * moves[inside]
        knots = np.where(places == counts, high, low + places / counts * (high - low))
        return work.table("knots.xy", knots)

    return make
