//! Radii of atoms: tables of the literature, files of the user, and elements that only names tell.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::molecules::{Radii, Structure};

use super::assert_fails;
use super::structure::read;

/// The radii of all atoms of the first model in steps of 0.001 Å, or the first error.
fn steps(radii: &Radii, structure: &Structure) -> Result<Vec<u32>> {
    let selected = structure.select(&Default::default())?;
    let mut finder = radii.finder(structure);
    let atoms = (0..selected.points().len()).map(|index| selected.atom(index).expect("atoms have names"));
    atoms.map(|atom| finder.steps_of(&atom)).collect()
}

/// The radius in a table of the only atom of a file with this record: columns 1 to 26, and the element.
fn step(table: &Radii, start: &str, element: &str) -> Result<u32> {
    let line = format!("{start:30}   1.000   2.000   3.000  1.00  0.00          {element:>2}\n");
    steps(table, &read(line)?).map(|all| all[0])
}

fn named(name: &str) -> Radii {
    Radii::named(name).expect("the table exists")
}

fn of_file(text: &str) -> Radii {
    Radii::read_from(text.as_bytes(), "mine").unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_name_of_a_table_is_known() {
    for name in Radii::NAMES {
        assert!(Radii::named(name).is_some(), "{name}");
    }
    assert!(Radii::named("ProtOr").is_none());
}

#[test]
fn tables_have_the_radii_of_the_literature() {
    let cases = [
        ("ATOM      1  CA  ALA A   1", "C", [1880, 1700, 1870, 2000]),
        ("ATOM      1  C   ALA A   1", "C", [1610, 1700, 1760, 2000]),
        ("ATOM      1  O   ALA A   1", "O", [1420, 1520, 1400, 1700]),
        ("ATOM      1  NZ  LYS A   1", "N", [1640, 1550, 1500, 1850]),
        ("ATOM      1  CZ  PHE A   1", "C", [1760, 1700, 1760, 1992]),
        ("ATOM      1  SD  MET A   1", "S", [1770, 1800, 1850, 2000]),
        ("HETATM    1 SE   MSE A   1", "SE", [1900, 1900, 1800, 1900]),
        ("ATOM      1  CE1 HSD A   1", "C", [1760, 1700, 1760, 1800]),
        ("ATOM      1  O1P   G A   1", "O", [1420, 1520, 1400, 1700]),
        ("ATOM      1  C1*  DA A   1", "C", [1880, 1700, 1800, 2275]),
        ("HETATM    1  O   HOH A   1", "O", [1460, 1520, 1400, 1768]),
        ("HETATM    1  C1  LIG A   1", "C", [1700, 1700, 1800, 1700]),
        ("ATOM      1  HA  ALA A   1", "H", [1100, 1100, 1100, 1320]),
        ("ATOM      1  DA  ALA A   1", "D", [1100, 1100, 1100, 1100]),
        ("HETATM    1 FE   HEM A   1", "FE", [2040, 2040, 2040, 2040]),
        ("HETATM    1 ZN    ZN A   1", "ZN", [1390, 1390, 1390, 1090]),
    ];
    for (start, element, expected) in cases {
        for (table, expected) in Radii::NAMES.into_iter().map(named).zip(expected) {
            assert_eq!(step(&table, start, element).expect(start), expected, "{start}");
        }
    }
}

#[test]
fn an_element_not_stated_is_that_of_the_name() {
    let cases = [
        ("ATOM      1  CA  ALA A   1", "C"),
        ("ATOM      1 CA   ALA A   1", "C"),
        ("HETATM    1 CA   PCA A   1", "C"),
        ("HETATM    1 CA    CA A   1", "CA"),
        ("HETATM    1  CA   CA A   1", "CA"),
        ("HETATM    1 CL   CLA A   1", "CL"),
        ("ATOM      1  CLA CLA A   1", "CL"),
        ("ATOM      1  SOD SOD A   1", "NA"),
        ("HETATM    1 NA   HEM A   1", "NA"),
        ("HETATM    1  NA  HEM A   1", "N"),
        ("HETATM    1 FE   HEM A   1", "FE"),
        ("HETATM    1 FE12 XYZ A   1", "FE"),
        ("HETATM    1 CL12 XYZ A   1", "CL"),
        ("HETATM    1 CAAB XYZ A   1", "C"),
        ("HETATM    1 1HG  XYZ A   1", "H"),
        ("HETATM    1 HG   XYZ A   1", "HG"),
        ("ATOM      1  HG  SER A   1", "H"),
        ("ATOM      1 HG   SER A   1", "H"),
        ("ATOM      1 HG11 VAL A   1", "H"),
        ("ATOM      1 DG11 VAL A   1", "D"),
        ("HETATM    1  CAB XYZ A   1", "C"),
        ("HETATM    1 SE   MSE A   1", "SE"),
    ];
    let bondi = named("bondi");
    for (start, element) in cases {
        let stated = step(&bondi, "HETATM    1  Q1  XYZ A   1", element).expect(start);
        assert_eq!(step(&bondi, start, "").expect(start), stated, "{start}");
    }
}

#[test]
fn an_atom_without_radius_is_named_with_a_remedy() {
    let protor = named("protor");
    let cases = [
        ("HETATM    7  X1  UNX B   5", "X", "atom 7 X1 in residue UNX 5 of chain B, element X"),
        ("HETATM    8  Q    QQ     5C", "", "atom 8 Q in residue QQ 5C, of unknown element"),
        ("HETATM    9 RF    RF A   1", "RF", "atom 9 RF in residue RF 1 of chain A, element Rf"),
    ];
    for (start, element, expected) in cases {
        let error = step(&protor, start, element).expect_err(start);
        assert_eq!(error.kind(), ErrorKind::Usage);
        let shown = error.to_string();
        assert!(shown.contains(expected) && shown.contains("--radii"), "{shown}");
    }
}

#[test]
fn lines_of_a_file_count_from_the_particular_to_the_general() {
    let file = of_file(
        "# mine\n* * 1\nO 1.3\nala cb 1.234 # side chain\n* CA 1.5\nANY CB 1.6\nHOH ANY 1.45\nlys,*,1.55\n\
        D 0.9\n",
    );
    let cases = [
        ("ATOM      1  CB  ALA A   1", "C", 1234),
        ("ATOM      1  CB  VAL A   1", "C", 1600),
        ("ATOM      1  CA  VAL A   1", "C", 1500),
        ("ATOM      1  CB  LYS A   1", "C", 1550),
        ("ATOM      1  O   VAL A   1", "O", 1300),
        ("HETATM    1  O   HOH A   1", "O", 1450),
        ("HETATM    1 CA    CA A   1", "CA", 1000),
        ("ATOM      1  HA  VAL A   1", "H", 900),
    ];
    for (start, element, expected) in cases {
        assert_eq!(step(&file, start, element).expect(start), expected, "{start}");
    }
}

#[test]
fn a_file_may_add_to_a_table() {
    let file = of_file("table protor\nUNX * 1.7\nC 1.9\n");
    let cases = [
        ("HETATM    1  X   UNX A   1", "X", 1700),
        ("ATOM      1  C   ALA A   1", "C", 1900),
        ("ATOM      1  N   ALA A   1", "N", 1640),
    ];
    for (start, element, expected) in cases {
        assert_eq!(step(&file, start, element).expect(start), expected, "{start}");
    }
    // "else" comes behind the table.
    let rest = of_file("else 1.5\ntable protor\nO 1.3\n");
    let cases = [
        ("HETATM    1  X   UNX A   1", "X", 1500),
        ("ATOM      1  MW  SOL A   1", "", 1500),
        ("ATOM      1  C   ALA A   1", "C", 1610),
        ("ATOM      1  N   XYZ A   1", "N", 1550),
    ];
    for (start, element, expected) in cases {
        assert_eq!(step(&rest, start, element).expect(start), expected, "{start}");
    }
    assert!(step(&of_file("N 1.6\n"), "ATOM      1  C   ALA A   1", "C").is_err(), "no table was named");
}

#[test]
fn a_damaged_file_is_refused_with_its_line() {
    let cases = [
        ("C 1.7\nALA CB\n", "mine: line 2: found \"ALA\", expected the symbol of an element"),
        ("C\n", "mine: line 1: found \"C\", expected \"RESIDUE ATOM RADIUS\""),
        ("ALA CB 1.7 apolar\n", "line 1: found \"ALA CB 1.7 apolar\""),
        ("C 1.7001\n", "found \"1.7001\", expected a radius"),
        ("C -1.7\n", "found \"-1.7\", expected a radius"),
        ("C 1e0\n", "found \"1e0\", expected a radius"),
        ("C 100.001\n", "expected a radius of 0 to 100 Å"),
        ("Xx 1.7\n", "found \"Xx\", expected the symbol"),
        ("ALA CB 1.7\n\nala cb 1.8\n", "line 3: a second radius for \"ALA CB\", which differs"),
        ("H 1\nD 1.1\n", "line 2: a second radius for \"H\", which differs"),
        ("table amber\n", "expected the name of a table: protor, bondi, united, charmm"),
        ("table bondi\ntable bondi\n", "line 2: a second table"),
        ("else 1\nelse 1.2\n", "line 2: a second radius for \"else\", which differs"),
        ("else\n", "\"table NAME\" or \"else RADIUS\""),
        ("C 1.7\0\n", "line 1: zero byte"),
    ];
    for (text, expected) in cases {
        assert_fails(Radii::read_from(text.as_bytes(), "mine"), ErrorKind::Malformed, &[expected]);
    }
    of_file("C 1.70000\nC 1.7\nN 0\nO 100\n");
}

#[test]
fn radii_in_angstroms_are_the_nearest_numbers() {
    let structure = read("1\n\nC 0 0 0\n").expect("it is valid");
    let selected = structure.select(&Default::default()).expect("it has an atom");
    let radii = of_file("C 1.234\n");
    let atom = selected.atom(0).expect("it has a name");
    assert_eq!(radii.finder(&structure).of(&atom).expect("it has a radius").to_bits(), 1.234f64.to_bits());
}
