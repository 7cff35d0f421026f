"""Areas, contacts and pockets of a molecule as columns of numpy."""

from pathlib import Path

import numpy as np

import spmesh

file = Path(__file__).resolve().parents[3] / "tests" / "data" / "1aki.cif"

with spmesh.molecule(file, classes="polymer") as lysozyme:
    areas = lysozyme.sasa(per="residue")
    most = np.argmax(areas["area"])
    print(f"{len(areas['area'])} residues; {areas['residue'][most]} has the greatest area, {areas['area'][most]:.1f} Å²")

    contacts = lysozyme.contacts(per="residue")
    first, second = contacts["residue1"], contacts["residue2"]
    most = np.argmax(contacts["area"])
    print(f"{len(first)} contacts; the greatest between {first[most]} and {second[most]}, {contacts['area'][most]:.1f} Å²")

    pockets = lysozyme.pockets()
    print(f"{len(pockets['volume'])} pockets and voids of {pockets['volume'].sum():.1f} Å³")

    mesh = lysozyme.read()
    print(f"{len(mesh.simplices)} tetrahedra between {len(mesh.xyz)} atoms")
