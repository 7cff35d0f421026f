"""Areas, contacts and pockets of molecules, by `tess3`."""

from __future__ import annotations

import os
import re
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np

from . import programs
from .options import Owner, Place, flags_of
from .types import FilePath
from .whole import Stream, read

Table = dict[str, np.ndarray]

# Columns of the tables of `tess3`, without the number of an atom in a pair; all others are numbers of 64-bit
# floating point.
INTEGERS = {
    *("model", "frame", "serial", "residue_number", "tetrahedra", "atoms", "contacts", "pocket", "mouth", "mouths"),
}
TEXTS = {
    *("file", "kind", "atom", "chain", "label_chain", "segment", "insertion_code", "residue_name", "class"),
    *("atom_name", "element", "altloc"),
}


def molecule(structure: Any, **options: Any) -> Molecule:
    """A molecule from a file in PDB, PQR, mmCIF or XYZ (also .gz), a gemmi.Structure, or an AtomArray of
    biotite.

    Options are flags of `tess3` that select atoms: `chain="A"`, `classes="polymer"` (without water, ions and
    ligands), `atoms="heavy"`, `assembly="1"`, `altloc="best"`, `model="all"`; `radii="bondi"` names a table
    of radii.

        lysozyme = spmesh.molecule("1aki.cif", classes="polymer")
        areas = lysozyme.sasa(per="residue")["area"]
    """
    if isinstance(structure, (str, os.PathLike)):
        return Molecule(structure, **options)
    place = Place(None, "molecule.cif")
    try:
        _write(structure, place.path)
    except BaseException:
        place.remove()
        raise
    return Molecule(place, **options)


def _write(structure: Any, path: Path) -> None:
    kind = type(structure)
    package = kind.__module__.partition(".")[0]
    if package == "gemmi":
        structure.make_mmcif_document().write_file(str(path))
    elif package == "biotite":
        pdbx = import_module("biotite.structure.io.pdbx")
        file = pdbx.CIFFile()
        pdbx.set_structure(file, structure)
        file.write(str(path))
    else:
        found = f"{kind.__module__}.{kind.__qualname__}"
        raise TypeError(f"structure is a {found}, expected a path, a gemmi.Structure or an AtomArray of biotite")


class Molecule(Owner):
    """Atoms in a file, and the flags of `tess3` that select some of them.

    Tables are dictionaries of arrays, one for each column: lengths in Å, areas in Å², volumes in Å³. Integers
    are int64, names are text. Numbers that do not apply are NaN. With `as_frame=True` they are
    DataFrames of pandas. All methods raise ProgramError, and pass further options to `tess3`, such as
    `radii="bondi"`.
    """

    def __init__(self, path: FilePath | Place, **options: Any):
        super().__init__(path)
        self._options = options

    @overload
    def sasa(self, per: str = ..., probe: float = ..., as_frame: Literal[False] = ..., **options: Any) -> Table: ...
    @overload
    def sasa(self, per: str = ..., probe: float = ..., *, as_frame: Literal[True], **options: Any) -> Any: ...

    def sasa(self, per: str = "atom", probe: float = 1.4, as_frame: bool = False, **options: Any) -> Any:
        """Areas of the surface that a probe of this radius (Å) reaches, of each "atom", "residue", "chain" or
        the "molecule".

        Columns: file, model, what identifies the atom, residue or chain (chain, label_chain, segment,
        residue_number, insertion_code, residue_name, class; of atoms atom_name, element, altloc and serial,
        of others atoms, their number), area. `volumes=True` adds volume.

            areas = molecule.sasa(per="residue")
            exposed = areas["residue_number"][areas["area"] > 60]
        """
        return self._table("sasa", as_frame, {"per": per, "probe": probe, **options})

    @overload
    def contacts(self, per: str = ..., probe: float = ..., as_frame: Literal[False] = ..., **options: Any) -> Table: ...
    @overload
    def contacts(self, per: str = ..., probe: float = ..., *, as_frame: Literal[True], **options: Any) -> Any: ...

    def contacts(self, per: str = "atom", probe: float = 1.4, as_frame: bool = False, **options: Any) -> Any:
        """Areas of contact between atoms, residues or chains: those of the faces between their cells.

        Columns: file, model, what identifies both, as of `sasa` (chain1, ..., chain2, ...), distance, area; of
        residues and chains contacts, their number, for distance. `between="chains"` leaves out contacts within
        a chain; `min_area` and `within` (Å) those that are small or far.

            interface = molecule.contacts(per="residue", between="chains")
        """
        return self._table("contact-areas", as_frame, {"per": per, "probe": probe, **options})

    @overload
    def neighbours(self, alpha: float | None = ..., as_frame: Literal[False] = ..., **options: Any) -> Table: ...
    @overload
    def neighbours(self, alpha: float | None = ..., *, as_frame: Literal[True], **options: Any) -> Any: ...

    def neighbours(self, alpha: float | None = None, as_frame: bool = False, **options: Any) -> Any:
        """Edges of the Delaunay tetrahedralization of the centres, or of the alpha complex of the radius
        `alpha` (Å).

        Columns: as of `contacts`, but tetrahedra for area.

            edges = molecule.neighbours(alpha=4)
        """
        return self._table("contacts", as_frame, {"alpha": alpha, **options})

    @overload
    def pockets(self, probe: float = ..., as_frame: Literal[False] = ..., **options: Any) -> Table: ...
    @overload
    def pockets(self, probe: float = ..., *, as_frame: Literal[True], **options: Any) -> Any: ...

    def pockets(self, probe: float = 1.4, as_frame: bool = False, **options: Any) -> Any:
        """Pockets and voids, the largest first.

        Columns: file, model, pocket, kind ("pocket" or "void"), volume, area, mouths, mouth_area, depth, atoms,
        tetrahedra. With `per="atom"` or "residue" those around each, with `mouths=True` the mouths.

            largest = molecule.pockets()["volume"][:1]
        """
        return self._table("pockets", as_frame, {"probe": probe, **options})

    def read(self, **options: Any) -> Stream:
        """The Delaunay tetrahedralization of the atoms. `labels` of its vertices are the serial numbers of
        atoms.

            tetrahedra = molecule.read().simplices
        """
        with programs.Pipe(self._command(options)) as pipe:
            return read(pipe.stdout)

    def _command(self, options: dict[str, Any]) -> list[Any]:
        return ["tess3", *flags_of({**self._options, **options}), self.path]

    def _table(self, flag: str, as_frame: bool, options: dict[str, Any]) -> Any:
        text = programs.run([*self._command({**options, "format": "tsv"}), f"--{flag}"]).decode()
        table = _columns(text)
        return import_module("pandas").DataFrame(table) if as_frame else table


def _plain(field: str) -> str:
    """A text without the escapes of tables."""
    escapes = {"t": "\t", "n": "\n", "r": "\r"}
    return re.sub(r"\\(.)", lambda found: escapes.get(found[1], found[1]), field) if "\\" in field else field


def _columns(text: str) -> Table:
    """The columns of a table with tabs between fields."""
    head, *lines = text.removesuffix("\n").split("\n")
    names = head.split("\t")
    fields = list(zip(*(line.split("\t") for line in lines))) or [()] * len(names)
    table: Table = {}
    for name, values in zip(names, fields):
        kind = name.removeprefix("partner_").rstrip("0123456789")
        if kind in TEXTS:
            table[name] = np.array([_plain(value) for value in values], str)
            continue
        # What is not stated is no integer.
        dtype = np.int64 if kind in INTEGERS and "" not in values else np.float64
        table[name] = np.array([value or "nan" for value in values], dtype)
    return table
