"""Tables of molecules, compared with closed forms for two balls and with scipy."""

import math
import tempfile
import unittest
from pathlib import Path

import numpy as np

import spmesh
from support import DATA

ATOM = "ATOM  {:5d}  C   ALA {}{:4d}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           C\n"


class Molecules(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lysozyme = spmesh.molecule(DATA / "1aki.cif")

    def test_two_balls_have_the_areas_of_closed_forms(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "-two.pdb")
            path.write_text(ATOM.format(1, "A", 1, 0, 0, 0) + ATOM.format(2, "1", 1, 3, 0, 0) + "END\n")
            pair = spmesh.molecule(path, radii="bondi")
            radius, distance = 1.7 + 1.4, 3.0
            areas = pair.sasa(volumes=True)
            self.assertEqual((areas["serial"].tolist(), areas["serial"].dtype), ([1, 2], np.int64))
            np.testing.assert_allclose(areas["area"], 2 * math.pi * radius * (radius + distance / 2), rtol=1e-8)
            contacts = pair.contacts(between="chains")
            self.assertEqual((contacts["chain2"].tolist(), contacts["residue_number1"].tolist()), (["1"], [1]))
            np.testing.assert_allclose(contacts["area"], math.pi * (radius**2 - distance**2 / 4), rtol=1e-8)
            chains = pair.sasa(per="chain", probe=0)
            self.assertEqual((chains["chain"].tolist(), chains["atoms"].tolist()), (["A", "1"], [1, 1]))
            self.assertEqual(chains["chain"].dtype.kind, "U")
            np.testing.assert_allclose(chains["area"], 2 * math.pi * 1.7 * (1.7 + 1.5), rtol=1e-8)
            self.assertEqual(len(pair.contacts(min_area=1e5)["area"]), 0)

    def test_sums_are_the_same_on_all_levels(self):
        sums = [self.lysozyme.sasa(per=level)["area"].sum() for level in ("atom", "residue", "chain", "molecule")]
        np.testing.assert_allclose(sums, sums[0], rtol=1e-7)
        self.assertEqual(self.lysozyme.sasa(per="chain")["atoms"].sum(), 170)

    def test_edges_are_those_of_qhull(self):
        try:
            from scipy.spatial import Delaunay
        except ImportError:
            self.skipTest("scipy is not installed")
        mesh = self.lysozyme.read()
        serial = mesh.labels.astype(int)
        corners = serial[Delaunay(mesh.xyz).simplices]
        expected = {frozenset(c[[i, j]].tolist()) for c in corners for i in range(4) for j in range(i)}
        edges = self.lysozyme.neighbours()
        self.assertEqual(set(map(frozenset, zip(edges["serial1"].tolist(), edges["serial2"].tolist()))), expected)
        self.assertLess(self.lysozyme.neighbours(alpha=4)["distance"].max(), 8)

    def test_pockets_are_a_table(self):
        pockets = self.lysozyme.pockets(probe=1.0)
        self.assertEqual({pockets[name].dtype.kind for name in ("pocket", "mouths", "atoms", "tetrahedra")}, {"i"})
        self.assertEqual({pockets[name].dtype.kind for name in ("volume", "area", "mouth_area", "depth")}, {"f"})
        self.assertEqual(pockets["kind"].dtype.kind, "U")

    def test_structures_of_other_packages_are_taken(self):
        expected = self.lysozyme.sasa()["area"]
        for reader in (self.gemmi, self.biotite):
            try:
                structure = reader(DATA / "1aki.cif")
            except ImportError:
                continue
            with spmesh.molecule(structure) as molecule:
                np.testing.assert_allclose(molecule.sasa()["area"], expected, rtol=1e-6)
            self.assertFalse(molecule.path.exists())
        with self.assertRaisesRegex(TypeError, "structure is a builtins.int"):
            spmesh.molecule(5)

    @staticmethod
    def gemmi(path):
        import gemmi

        return gemmi.read_structure(str(path))

    @staticmethod
    def biotite(path):
        from biotite.structure.io import pdbx

        return pdbx.get_structure(pdbx.CIFFile.read(str(path)), model=1)

    def test_tables_are_frames_if_asked(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        frame = self.lysozyme.contacts(per="residue", as_frame=True)
        self.assertIsInstance(frame, pandas.DataFrame)
        columns = list(frame.columns)
        self.assertEqual(columns[:3] + columns[-2:], ["file", "model", "chain1", "contacts", "area"])

    def test_failures_have_the_message_of_the_program(self):
        with self.assertRaises(spmesh.ProgramError) as caught:
            spmesh.molecule("missing.cif").sasa()
        self.assertEqual((caught.exception.program, caught.exception.code), ("tess3", 1))
        with self.assertRaisesRegex(spmesh.ProgramError, "galaxy"):
            self.lysozyme.sasa(per="galaxy")


if __name__ == "__main__":
    unittest.main()
