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
BOX = (list, type(None))
FIELDS = {"format": str, "version": int, "bounds": BOX, "points": int, "merged": int, "skipped": list, "parts": list}
PART_FIELDS = {"name": str, "below": int, "file": str, "bytes": int, "vertices": int, "simplices": int, "box": BOX}
SKIPPED_FIELDS = {"file": str, "reason": str}


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
        self.folder = os.path.dirname(os.fspath(path))
        self.parts, self.manifest = manifest["parts"], manifest
        # For each part, the id of its first vertex in the joined mesh.
        self.first = [0]
        for part in self.parts:
            self.first.append(self.first[-1] + part["vertices"])
        self._header: Header | None = None
        self.merged = 0
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
        for place, part in enumerate(self.parts):
            path = os.path.join(self.folder, part["file"])
            # Opening a pipe waits for a writer, which may never come.
            require(os.path.isfile(path) or not os.path.exists(path), f"{path} is no regular file")
            with Reader(path, memory) as reader:
                try:
                    self._check_header(reader.header, part)
                    self._part(reader, place)
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

    def _check_header(self, header: Header, part: dict[str, Any]) -> None:
        is_it = header.part == (int(part["name"], 16), part["below"]) and header.has_patches
        require(is_it, "this is another part than the manifest names")
        if self._header is None:
            bounds = self.manifest["bounds"]
            bounds = None if bounds is None else tuple(map(float, bounds[0] + bounds[1]))
            self._header = replace(header, part=None, points=None, tree=None, stored_bounds=bounds)
            self._header.check()
        same = _common(header) == _common(self._header)
        require(same, "its grid or its attributes are not those of the other parts")

    def _part(self, reader: Reader, place: int) -> None:
        part = self.parts[place]
        start = own = self.first[place]
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
                ids[~is_own] = self._ids_of(block.origins["id"], place - part["below"])
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

    def _ids_of(self, origins: np.ndarray, lowest: int) -> np.ndarray:
        """The ids in the joined mesh of vertices that a part names, whose first part below is at the place `lowest`."""
        ids = []
        for origin in origins.tolist():
            part, number = lowest + (origin >> NUMBER_BITS), origin % 2**NUMBER_BITS
            require(number < self.parts[part]["vertices"], "a vertex of no part before this one")
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
    if found.get("version") != 2:
        raise TooNewError(f"version {found.get('version')} of a manifest; this package reads 2")
    _check_fields(found, FIELDS)
    for file in found["skipped"]:
        _check_fields(file, SKIPPED_FIELDS)
    for place, part in enumerate(found["parts"]):
        _check_fields(part, PART_FIELDS)
        _check_box(part["box"])
        name, below = part["name"], part["below"]
        require(len(name) == 16 and set(name) <= set("0123456789abcdef"), f"{name!r} is no name of a part")
        require(below <= place, f"part {place} comes before one of the {below} below it")
    require(found["parts"], "a mesh without parts")
    _check_box(found["bounds"])
    return dict(found)


def _check_box(box: list[Any] | None) -> None:
    if box is not None:
        sides = [side for side in box if isinstance(side, list) and len(side) == 3]
        numbers = all(type(x) in (int, float) for side in sides for x in side)
        require(len(sides) == len(box) == 2 and numbers, NONE)


def _check_fields(found: Any, fields: Mapping[str, Any]) -> None:
    require(isinstance(found, dict) and set(found) == set(fields), NONE)
    for name, types in fields.items():
        value = found[name]
        require(isinstance(value, types) and not isinstance(value, bool), NONE)
        require(not isinstance(value, int) or 0 <= value < 2**64, NONE)
