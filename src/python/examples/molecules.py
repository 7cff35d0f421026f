"""Areas, contacts and pockets of a molecule as columns of numpy."""

from pathlib import Path

import numpy as np

import spmesh

file = Path(__file__).resolve().parents[3] / "tests" / "data" / "1aki.cif"


def residue(table, end, row):
    """What a row is about: chain, name and number; `end` is that of the columns."""
    return " ".join(str(table[name + end][row]) for name in ("chain", "residue_name", "residue_number"))


with spmesh.molecule(file, classes="polymer") as lysozyme:
    areas = lysozyme.sasa(per="residue")
    most = np.argmax(areas["area"])
    name = residue(areas, "", most)
    print(f"{len(areas['area'])} residues; {name} has the greatest area, {areas['area'][most]:.1f} Å²")

    contacts = lysozyme.contacts(per="residue")
    most = np.argmax(contacts["area"])
    first, second = residue(contacts, "1", most), residue(contacts, "2", most)
    print(f"{len(contacts['area'])} contacts; the greatest between {first} and {second}, {contacts['area'][most]:.1f} Å²")

    pockets = lysozyme.pockets()
    print(f"{len(pockets['volume'])} pockets and voids of {pockets['volume'].sum():.1f} Å³")

    mesh = lysozyme.read()
    print(f"{len(mesh.simplices)} tetrahedra between {len(mesh.xyz)} atoms")
