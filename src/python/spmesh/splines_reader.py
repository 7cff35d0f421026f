"""Decodes configurations and splines, and checks their rules (format, sections 4.11 to 4.13)."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from . import blocks as b
from .errors import require

KNOTS_OF = (("edge", 2), ("vertex", 1), ("tent", 2), ("crease", 3), ("face", 4))


class Splines:
    """What blocks before tell about the next ones. `totals` are those of the reader, which it counts on."""

    def __init__(self, kind: str, totals: dict[str, int]):
        self.kind, self.totals = kind, totals
        # Degree and standing of the configurations so far.
        self.degree: tuple[int, int] | None = None
        self._group: tuple[int, ...] | None = None
        self._boundary: tuple[int, ...] | None = None
        self._function: tuple[int, tuple[int, ...]] | None = None
        self._has_pairs = False

    def configurations(self, payload: bytes) -> b.Configurations:
        require(len(payload) >= 12, f"configurations in {len(payload)} bytes")
        degree, standing, groups = struct.unpack_from("<3I", payload)
        require(degree <= 4096 and standing < 3, f"configurations of degree {degree} and standing {standing}")
        start = 12 + groups * (degree + 1) * 4
        require(start <= len(payload), "the counts of the configurations do not add up")
        interiors = np.frombuffer(payload, "<u4", groups * degree, 12).reshape(groups, degree)
        counts = np.frombuffer(payload, "<u4", groups, 12 + groups * degree * 4)
        require(start + int(counts.sum(dtype=np.uint64)) * 12 == len(payload), "the counts of the configurations do not add up")
        boundaries = np.frombuffer(payload, "<u4", -1, start).reshape(-1, 3)
        self._start_degree(degree, standing)
        at = 0
        for number, (interior, count) in enumerate(zip(interiors.tolist(), counts.tolist())):
            self._start_group(tuple(interior), number == 0)
            require(count > 0, "an interior set has no configuration")
            for boundary in boundaries[at : at + count].tolist():
                self._configuration(interior, tuple(boundary))
            at += count
        self.totals["simplices"] += len(boundaries)
        return b.Configurations(degree, standing, interiors, counts, boundaries)

    def _start_degree(self, degree: int, standing: int) -> None:
        if self.degree:
            last, known = self.degree
            require(degree >= last, f"configurations of degree {degree} after those of {last}")
            require(degree == last or self.kind != "splines", "splines have one degree")
            require(degree > last or standing == known, f"the configurations of degree {degree} change their standing")
        self._has_pairs |= degree == 1
        if self.degree != (degree, standing):
            self.degree, self._group = (degree, standing), None

    def _start_group(self, interior: tuple[int, ...], is_first: bool) -> None:
        if is_first and interior == self._group:
            return
        require(self._group is None or interior > self._group, "interior sets do not follow each other")
        increasing = all(x < y for x, y in zip(interior, interior[1:]))
        knots = self.totals["points"]
        require(increasing and all(knot < knots for knot in interior), "an interior set is not of increasing knots")
        self._group, self._boundary = interior, None

    def _configuration(self, interior: list[int], boundary: tuple[int, ...]) -> None:
        knots, infinite = self.totals["points"], boundary[2] == b.FARAWAY
        ends = boundary[:2] if infinite else boundary
        require(all(knot < knots and knot != b.FARAWAY for knot in ends), "a boundary is not of numbers of knots")
        require(len(set(boundary)) == 3, "a boundary repeats a knot")
        require(infinite or boundary[0] == min(boundary), "a boundary does not have its least knot first")
        require(not set(ends) & set(interior), "a boundary has a knot of its interior set")
        if self._boundary:
            was = self._boundary[2] == b.FARAWAY
            follows = infinite > was or infinite == was and (not interior or self._boundary < boundary)
            require(follows, "a boundary does not follow the one before it in its group")
        self._boundary = boundary

    def functions(self, payload: bytes) -> b.Functions:
        require(self._has_pairs or not payload, "functions in a stream without configurations of degree 1")
        at, found, knots = 0, [], self.totals["points"]
        while at < len(payload):
            require(at + 8 <= len(payload), "a function is cut off")
            code, count = struct.unpack_from("<2I", payload, at)
            require(code < len(KNOTS_OF), f"a function of kind {code}")
            name, corners = KNOTS_OF[code]
            end = at + 8 + 4 * corners + 16 * count
            require(end <= len(payload), "a function is cut off")
            kind = struct.unpack_from(f"<{corners}I", payload, at + 8)
            terms = list(struct.iter_unpack("<2Id", payload[at + 8 + 4 * corners : end]))
            require(max(kind) < knots and len(set(kind)) == corners, "a function of unknown or repeated knots")
            require(self._function is None or self._function < (code, kind), "functions do not follow each other")
            require(terms, "a function has no term")
            pairs = [term[:2] for term in terms]
            require(all(p < q < knots for p, q in pairs), "a term of no increasing numbers of knots")
            require(all(np.isfinite(x) and x != 0 for _, _, x in terms), "a factor is not finite, or zero")
            require(all(x < y for x, y in zip(pairs, pairs[1:])), "terms do not follow each other")
            self._function, at = (code, kind), end
            found.append(b.Function(name, kind, terms))
        self.totals["vertices"] += len(found)
        return b.Functions(found)

    def coefficients(self, payload: bytes) -> b.Coefficients:
        values = records_of(payload, "<f8")
        require(np.isfinite(values).all(), "a coefficient is not finite")
        self.totals["residual"] += len(values)
        return b.Coefficients(values)


def records_of(payload: bytes, dtype: Any) -> np.ndarray:
    dtype = np.dtype(dtype)
    require(len(payload) % dtype.itemsize == 0, f"{len(payload)} bytes are not a whole number of records")
    return np.frombuffer(payload, dtype)
