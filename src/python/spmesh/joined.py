"""Meshes in parts as one mesh in memory (formats/parts.md of the project)."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, replace
from typing import Any, Mapping, TypeGuard

import numpy as np

from .blocks import End, Patch
from .errors import MalformedError, TooNewError, require
from .header import NUMBER_BITS, Header
from .reader import Reader
from .types import FilePath

MANIFEST_MAX = 2**28
NONE = "this is JSON, but no manifest of a mesh in parts"
FIELDS = {"format": str, "version": int, "plan": str, "bounds": (list, type(None)), "points": int, "merged": int, "parts": list}
PART_FIELDS = {"number": int, "file": str, "bytes": int, "vertices": int, "simplices": int}


def is_manifest(file: object) -> TypeGuard[FilePath]:
    """Whether `file` is the path of a manifest."""
    if not isinstance(file, (str, os.PathLike)) or not os.path.isfile(file):
        return False
    with open(file, "rb") as source:
        return b"".join(source.read(256).split()).startswith(b'{"format":"spmeshmeshinparts"')


@dataclass
class Whole:
    """A joined mesh: its header, vertices, simplices and rows of attributes, and its totals."""

    header: Header
    stored: np.ndarray
    simplices: np.ndarray
    rows: np.ndarray | None
    totals: dict[str, int]


class Join:
    def __init__(self, path: FilePath):
        manifest = _manifest(path)
        self.folder, self.plan = os.path.dirname(os.fspath(path)), int(manifest["plan"], 16)
        self.parts, self.manifest = manifest["parts"], manifest
        self.first, self.size, vertices = dict[int, int](), dict[int, int](), 0
        for part in self.parts:
            number = part["number"]
            twice = f"part {number} of {len(self.parts)} comes twice, or is none"
            require(number < len(self.parts) and number not in self.first, twice)
            self.first[number], self.size[number] = vertices, part["vertices"]
            vertices += part["vertices"]
        self._header: Header | None = None
        self.merged, self.done = 0, set[int]()
        # Ids of vertices that a part before has kept, and no part has finalized since.
        self.shared: set[int] = set()
        self.stored: list[np.ndarray] = []
        self.simplices: list[np.ndarray] = []
        self.rows: list[np.ndarray] = []

    @property
    def header(self) -> Header:
        """That of the joined mesh, once a part was read."""
        assert self._header is not None, "a manifest has a part"
        return self._header

    def read(self, memory: bool) -> Whole:
        for part in self.parts:
            path = os.path.join(self.folder, part["file"])
            # Opening a pipe waits for a writer, which may never come.
            require(os.path.isfile(path) or not os.path.exists(path), f"{path} is no regular file")
            with Reader(path, memory) as reader:
                try:
                    self._check_header(reader.header, part["number"])
                    self._part(reader, part)
                except MalformedError as error:
                    raise MalformedError(f"{path}: {error}") from None
        require(not self.shared, f"{len(self.shared)} vertices are kept for parts that do not come")
        stored, simplices = np.concatenate(self.stored), np.concatenate(self.simplices)
        header = self.header
        if header.stored_bounds is not None and len(stored):
            low, high = stored.min(axis=0), stored.max(axis=0)
            inside = (low >= header.stored_bounds[: header.axes]).all() and (high <= header.stored_bounds[3 : 3 + header.axes]).all()
            require(inside, "a point lies outside of the header's bounding box")
        totals = dict(
            points=len(stored) + self.merged, cells=0, vertices=len(stored), simplices=len(simplices), merged=self.merged,
            residual=0, walls=0,
        )
        stated = self.manifest["points"], self.manifest["merged"]
        require((totals["points"], self.merged) == stated, "the parts do not have the points that the manifest states")
        return Whole(header, stored, simplices, np.concatenate(self.rows) if header.attributes else None, totals)

    def _check_header(self, header: Header, number: int) -> None:
        is_it = header.part == (self.plan, number) and header.has_patches
        require(is_it, f"this is not part {number} of the plan")
        if self._header is None:
            bounds = self.manifest["bounds"]
            bounds = None if bounds is None else tuple(map(float, bounds[0] + bounds[1]))
            self._header = replace(header, part=None, points=None, tree=None, stored_bounds=bounds)
            self._header.check()
        same = _common(header) == _common(self._header)
        require(same, "its grid or its attributes are not those of the other parts")

    def _part(self, reader: Reader, part: dict[str, Any]) -> None:
        start = own = self.first[part["number"]]
        tables, kept = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
        simplices: list[np.ndarray] = [np.empty((0, self.header.corners), np.int64)]
        for block in reader:
            if isinstance(block, End):
                self.merged += block.totals["merged"]
            elif isinstance(block, Patch):
                is_own = np.ones(len(block.new), bool)
                is_own[block.origins["local"]] = False
                ids = np.empty(len(block.new), np.int64)
                ids[is_own] = np.arange(own, own + is_own.sum(), dtype=np.int64)
                ids[~is_own] = self._ids_of(block.origins["id"])
                own += int(is_own.sum())
                self.stored.append(block.new[is_own])
                if block.rows is not None:
                    self.rows.append(block.rows[is_own])
                tables.append(ids)
                kept.append(block.ids[block.kept])
                simplices.append(block.simplices_by_id)
        require(own - start == part["vertices"], f"{own - start} vertices of its own, expected {part['vertices']}")
        if not self.rows and self.header.attributes:
            self.rows.append(np.empty(0, self.header.row_dtype))
        self.stored.append(np.empty((0, self.header.axes), self.header.dtype))
        table = np.concatenate(tables)
        self.shared.difference_update(table.tolist())
        self.shared.update(table[np.concatenate(kept)].tolist())
        self.simplices.append(table[np.concatenate(simplices)])
        require(len(self.simplices[-1]) == part["simplices"], "another number of simplices than the manifest states")
        self.done.add(part["number"])

    def _ids_of(self, origins: np.ndarray) -> np.ndarray:
        ids = []
        for origin in origins.tolist():
            part, number = origin >> NUMBER_BITS, origin % 2**NUMBER_BITS
            require(part in self.done and number < self.size[part], "a vertex of no part before this one")
            ids.append(self.first[part] + number)
        require(self.shared.issuperset(ids), "a vertex that no part before this one has kept")
        return np.array(ids, np.int64)


def _common(header: Header) -> tuple[object, ...]:
    """What all parts have in common."""
    return header.kind, header.scale, header.offset, header.has_elevation, header.attributes


def _manifest(path: FilePath) -> dict[str, Any]:
    require(os.path.getsize(path) <= MANIFEST_MAX, f"a manifest of more than {MANIFEST_MAX} bytes")
    with open(path, "rb") as file:
        try:
            found: Any = json.load(file)
        except ValueError:
            raise MalformedError(NONE) from None
    if found.get("version") != 1:
        raise TooNewError(f"version {found.get('version')} of a manifest; this package reads 1")
    _check_fields(found, FIELDS)
    for part in found["parts"]:
        _check_fields(part, PART_FIELDS)
    require(found["parts"], "a mesh without parts")
    digits = len(found["plan"]) == 16 and set(found["plan"]) <= set("0123456789abcdef")
    require(digits, f"{found['plan']!r} is no hash of a plan")
    if found["bounds"] is not None:
        sides = [side for side in found["bounds"] if isinstance(side, list) and len(side) == 3]
        numbers = all(type(x) in (int, float) for side in sides for x in side)
        require(len(sides) == len(found["bounds"]) == 2 and numbers, NONE)
    return dict(found)


def _check_fields(found: Any, fields: Mapping[str, Any]) -> None:
    require(isinstance(found, dict) and set(found) == set(fields), NONE)
    for name, types in fields.items():
        value = found[name]
        require(isinstance(value, types) and not isinstance(value, bool), NONE)
        require(not isinstance(value, int) or 0 <= value < 2**64, NONE)
