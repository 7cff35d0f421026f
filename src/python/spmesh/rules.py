"""Rules that need memory: final cells, chunks, live vertices (format, sections 2.4, 4.3, 4.4 and 6.1)."""

from __future__ import annotations

from typing import Sequence

import numpy as np

from .blocks import NOT_A_VERTEX, Patch, ResidualPoints
from .errors import MalformedError, require
from .header import Header, Tree

Point = Sequence[float]


def codes_of(tree: Tree, level: int, xyz: np.ndarray) -> np.ndarray:
    """Location codes (n,) uint64 of the cells of a level that hold points. Borders are exact in float64."""
    dims = len(tree.origin)
    code = np.full(len(xyz), 1, np.uint64)
    low = np.tile(np.array(tree.origin, float), (len(xyz), 1))
    side, points = tree.side, xyz[:, :dims].astype(float)
    for _ in range(level):
        side /= 2
        upper = points >= low + side
        low += upper * side
        code <<= np.uint64(dims)
        for axis in range(dims):
            code |= upper[:, axis].astype(np.uint64) << np.uint64(axis)
    return code


def code_of(tree: Tree, level: int, point: Point) -> int:
    """As `codes_of`, of one point."""
    dims = len(tree.origin)
    low, side, code = list(tree.origin), tree.side, 1
    for _ in range(level):
        side /= 2
        code <<= dims
        for axis in range(dims):
            if point[axis] >= low[axis] + side:
                low[axis] += side
                code |= 1 << axis
    return code


class FinalCells:
    """Cells that no later point lies in. A cell whose children are all final is final itself."""

    def __init__(self, tree: Tree):
        self.tree, self.dims = tree, len(tree.origin)
        self.final: set[int] = set()
        # Cells of which a part is final, or all of it.
        self.touched: set[int] = set()
        self.deepest = 0

    def level(self, code: int) -> int | None:
        bits = code.bit_length() - 1
        level = bits // self.dims
        return level if code > 0 and bits % self.dims == 0 and level <= self.tree.depth else None

    def is_final(self, code: int) -> bool:
        while code:
            if code in self.final:
                return True
            code >>= self.dims
        return False

    def tag(self, code: int) -> None:
        level = self.level(code)
        if level is None:
            raise MalformedError(f"location code {code} is not a cell of the tree")
        require(not self.is_final(code), f"cell {code} is final already")
        self.deepest = max(self.deepest, level)
        above = code
        while above and above not in self.touched:
            self.touched.add(above)
            above >>= self.dims
        self.final.add(code)
        while code > 1:
            first = code >> self.dims << self.dims
            siblings = range(first, first + (1 << self.dims))
            if not all(sibling in self.final for sibling in siblings):
                break
            self.final.difference_update(siblings)
            code >>= self.dims
            self.final.add(code)

    def check(self, xyz: np.ndarray, low: Point, high: Point) -> None:
        """Checks that no point lies in a final cell; `low` and `high` are the corners of their box."""
        if not self.final or not len(xyz):
            return
        # The points of a block are mostly in one cell that is open as a whole.
        one, other = code_of(self.tree, self.deepest, low), code_of(self.tree, self.deepest, high)
        while one != other:
            one, other = one >> self.dims, other >> self.dims
        require(not self.is_final(one), "a point lies in a cell that is final")
        if one in self.touched:
            for code in np.unique(codes_of(self.tree, self.deepest, xyz)).tolist():
                require(not self.is_final(code), "a point lies in a cell that is final")


class Chunks:
    """Points between two runs of tags lie in one cell of the second run."""

    def __init__(self, tree: Tree):
        self.tree, self.in_tags = tree, False
        self.box: tuple[Point, Point] | None = None

    def points(self, low: Point, high: Point) -> None:
        """Takes points with these corners of their box."""
        if self.in_tags:
            self.end()
            self.in_tags = False
        if self.box is not None:
            low, high = list(map(min, low, self.box[0])), list(map(max, high, self.box[1]))
        self.box = low, high

    def tag(self, code: int) -> None:
        self.in_tags = True
        if self.box is not None:
            level = (code.bit_length() - 1) // len(self.tree.origin)
            if code_of(self.tree, level, self.box[0]) == code == code_of(self.tree, level, self.box[1]):
                self.box = None

    def end(self) -> None:
        require(self.box is None, "the stream is chunked, but points do not lie in one cell of the tags behind them")


class LiveVertices:
    """Vertices that later patches may use. Memory: those between their patch and their finalization."""

    def __init__(self, header: Header):
        self.live: set[int] = set()
        self.places: dict[int, bytes] = {}
        self.keeps_places = header.kind.startswith("partial ")

    def patch(self, patch: Patch) -> None:
        missing = set(patch.imported.tolist()) - self.live
        require(not missing, f"vertex {min(missing, default=0)} referenced after finalization")
        new = len(patch.new)
        stays = np.ones(new, bool)
        stays[patch.finalized[patch.finalized < new]] = False
        for local in np.flatnonzero(stays).tolist():
            self.live.add(patch.first_id + local)
            if self.keeps_places:
                self.places[patch.first_id + local] = patch.new[local].tobytes()
        leaving = patch.imported[patch.finalized[patch.finalized >= new] - new].tolist()
        self.live.difference_update(leaving)
        for vertex in leaving if self.keeps_places else ():
            del self.places[vertex]

    def residual(self, points: ResidualPoints) -> None:
        for vertex, place in zip(points.ids.tolist(), points.xyz):
            if vertex != NOT_A_VERTEX:
                require(vertex in self.live, f"residual point names vertex {vertex}, which is not live")
                self.live.remove(vertex)
                was = np.frombuffer(self.places.pop(vertex), points.xyz.dtype)
                require((was == place).all(), f"residual point has other coordinates than its vertex {vertex}")
