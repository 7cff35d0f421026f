"""A real structure many times over, side by side, as a large cloud with the density and distances of atoms."""

import array
import itertools

import structures
import target

# A small protein, if no folder of structures is given.
SOURCE = target.ROOT / "tests" / "data" / "1l2y.pdb.gz"
# In thousandths of an angstrom, as files of the PDB have them.
UNIT = 1e-3
GAP = 1500


def source(folder):
    """The largest structure of a folder, or SOURCE."""
    return max(structures.find(folder), key=lambda path: path.stat().st_size) if folder else SOURCE


def write(source, count, path):
    """Writes `count` points as triples of f64, copy by copy of a structure, along x first and z last."""
    atoms = [tuple(round(x / UNIT) for x in atom) for atom in structures.atoms(source)]
    pitch = [max(column) - min(column) + GAP for column in zip(*atoms)]
    copies = -(-count // len(atoms))
    side = side_of(copies)
    with open(path, "wb") as file:
        for z, y, x in itertools.islice(itertools.product(range(side), repeat=3), copies):
            shift = [place * step for place, step in zip((x, y, z), pitch)]
            taken = atoms[: min(len(atoms), count)]
            count -= len(taken)
            # Divisions by 1000 round to the nearest, as reading decimals does.
            numbers = (float(a + b) / 1000 for atom in taken for a, b in zip(atom, shift))
            array.array("d", numbers).tofile(file)


def side_of(copies):
    """The side of the least cube with room for that many."""
    return next(side for side in itertools.count(1) if side**3 >= copies)
