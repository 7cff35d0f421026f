"""Real structures as inputs: the atoms of PDB and mmCIF files, also .gz, as files of coordinates.

These readers find coordinates and nothing else, and share no code with ours.
"""

import gzip
import re
import struct

# With fewer atoms, a run is hardly longer than the start of a program.
ATOMS_MIN = 1000
ENDINGS = (".pdb", ".cif", ".ent")
WORD = re.compile(r"'[^']*'(?=\s|$)|\"[^\"]*\"(?=\s|$)|\S+")


def find(folder):
    """All structure files under `folder`, by name."""
    return sorted(path for path in folder.rglob("*") if path.name.removesuffix(".gz").lower().endswith(ENDINGS))


def atoms(path):
    """Coordinates of the atoms of the first model, in angstrom."""
    opened = gzip.open(path, "rt", errors="replace") if path.suffix == ".gz" else open(path, errors="replace")
    with opened as lines:
        return list(of_mmcif(lines) if ".cif" in path.name.lower() else of_pdb(lines))


def of_pdb(lines):
    for line in lines:
        if line.startswith("ENDMDL"):
            return
        if line[:6] in ("ATOM  ", "HETATM"):
            yield tuple(float(line[start : start + 8]) for start in (30, 38, 46))


def of_mmcif(lines):
    """Coordinates from the loop over _atom_site, of the first model."""
    columns = []
    first_model = None
    for line in lines:
        if line.startswith("_atom_site."):
            columns.append(line.split()[0].removeprefix("_atom_site."))
        elif columns and line[:1] in "#_" or line.startswith(("loop_", "data_")):
            if columns:
                return
        elif columns:
            row = dict(zip(columns, WORD.findall(line)))
            first_model = first_model or row.get("pdbx_PDB_model_num")
            if row.get("pdbx_PDB_model_num") == first_model:
                yield tuple(float(row[f"Cartn_{axis}"]) for axis in "xyz")


def prepare(folder, place):
    """Writes coordinate files to `place` for all structures under `folder` that are large enough, each once.
    Returns their names and files, the largest first, and the structures that cannot be read, with the
    reason."""
    place.mkdir(parents=True, exist_ok=True)
    found, unread, known = [], {}, set()
    for path in find(folder):
        name = str(path.relative_to(folder))
        try:
            points = atoms(path)
        except (OSError, ValueError, KeyError) as error:
            unread[name] = str(error)
            continue
        data = b"".join(struct.pack("<3d", *point) for point in points)
        if len(points) >= ATOMS_MIN and data not in known:
            known.add(data)
            target = place / f"{name.replace('/', '_')}.f64"
            target.write_bytes(data)
            found.append((len(points), name, target))
    return [(name, target) for _, name, target in sorted(found, reverse=True)], unread
