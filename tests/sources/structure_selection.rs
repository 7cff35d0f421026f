//! Selections: which atoms are kept, and how the points are labelled.

use spmesh_base::error::ErrorKind;
use spmesh_formats::molecules::{Altlocs, Atoms, Models, Selection, Structure, read_structure};

use super::structure::read;
use super::{assert_fails, sample};

/// Labels of the selected atoms, which must be their serial numbers.
fn labels(structure: &Structure, selection: &Selection) -> Vec<u64> {
    let selected = structure.select(selection).unwrap_or_else(|error| panic!("{error}"));
    let labels: Vec<u64> = (0..selected.points().len()).map(|index| selected.label(index)).collect();
    for (index, &label) in labels.iter().enumerate() {
        let atom = selected.atom(index).expect("atoms have names");
        assert_eq!((atom.atom.serial, atom.point), (label, selected.points()[index]));
    }
    labels
}

/// A structure of atoms `serial name element altloc residue chain number occupancy`; a line that ends with
/// HET is a HETATM record.
fn structure(atoms: &[&str]) -> Structure {
    let tags = "id auth_atom_id type_symbol label_alt_id auth_comp_id auth_asym_id auth_seq_id occupancy \
                group_PDB Cartn_x \
                Cartn_y Cartn_z";
    let tags: String = tags.split(' ').map(|tag| format!("_atom_site.{tag}\n")).collect();
    let row = |(index, atom): (usize, &&str)| {
        let group = if atom.contains("HET") { "" } else { " ATOM" };
        format!("{}{group} {index} 2 3\n", atom.replace("HET", "HETATM"))
    };
    let rows: String = atoms.iter().enumerate().map(row).collect();
    read(format!("data_\nloop_\n{tags}{rows}")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn models_and_chains_are_chosen_by_name() {
    let path = sample("1l2y.pdb.gz");
    let ensemble = read_structure(&path, None).unwrap();
    let count = |selection: &Selection| ensemble.select(selection).unwrap().points().len();
    assert_eq!(count(&Selection::default()), 304);
    let second = Selection { models: Models::One(2), ..Selection::default() };
    assert_eq!(ensemble.select(&second).unwrap().points(), ensemble.models[1].points);
    assert_eq!(ensemble.select(&second).unwrap().atom(0).unwrap().model, 2);
    assert_eq!(count(&Selection { models: Models::All, ..Selection::default() }), 608);
    assert_eq!(count(&Selection { chains: vec!["A".into()], ..Selection::default() }), 304);
    let calphas = Selection { atoms: Atoms::CAlpha, ..Selection::default() };
    assert_eq!(count(&calphas), 20);
    let heavy = Selection { atoms: Atoms::Heavy, ..Selection::default() };
    assert_eq!(count(&heavy), 154);

    let third = Selection { models: Models::One(3), ..Selection::default() };
    assert_fails(ensemble.select(&third).map(drop), ErrorKind::Usage, &["no model \"3\"", "only 1, 2"]);
    let other = Selection { chains: vec!["A".into(), "B".into()], ..Selection::default() };
    assert_fails(ensemble.select(&other).map(drop), ErrorKind::Usage, &["1l2y", "no chain \"B\"", "only A"]);
    assert_eq!(ensemble.chains(), ["A"]);
}

#[test]
fn kinds_of_atoms_are_told_by_element_and_name() {
    let atoms = [
        "1 CA C . ALA A 1 1",
        "2 CA CA . CA A 2 1 HET",
        "3 CA ? . ALA A 3 1",
        "4 CA ? . CA A 4 1 HET",
        "5 CA C . MSE A 5 1 HET",
        "6 HB1 H . ALA A 1 1",
        "7 1HB ? . ALA A 1 1",
        "8 D D . ALA A 1 1",
        "9 HG HG . HG A 9 1 HET",
        "10 HG ? . HG A 10 1 HET",
        "11 HG ? . SER A 1 1",
        "12 ca c . ala A 1 1",
        "13 D ? . ALA A 1 1",
        "14 DB1 ? . ALA A 1 1",
    ];
    let structure = structure(&atoms);
    let of = |atoms, hetatm| labels(&structure, &Selection { atoms, hetatm, ..Selection::default() });
    assert_eq!(of(Atoms::CAlpha, true), [1, 3, 5, 12]);
    assert_eq!(of(Atoms::CAlpha, false), [1, 3, 12]);
    assert_eq!(of(Atoms::Heavy, true), [1, 2, 3, 4, 5, 9, 10, 12]);
    assert_eq!(of(Atoms::All, false), [1, 3, 6, 7, 8, 11, 12, 13, 14]);
}

/// Columns of the name tell mercury from a hydrogen.
#[test]
fn hydrogens_are_those_of_all_rules() {
    let line = |start: &str| format!("{start:30}   1.000   2.000   3.000  1.00  0.00\n");
    for (start, is_heavy) in [
        ("ATOM      1  D   ALA A   1", false),
        ("ATOM      1  DA  ALA A   1", false),
        ("ATOM      1 DG11 VAL A   1", false),
        ("ATOM      1 HG   SER A   1", false),
        ("HETATM    1 HG   MMC A   1", true),
        ("HETATM    1  H1  MMC A   1", false),
        ("HETATM    1 HO2  GOL A   1", false),
        ("HETATM    1 HO    HO A   1", true),
        ("HETATM    1 1HB  XYZ A   1", false),
        ("HETATM    1  D1  DOD A   1", false),
    ] {
        let structure = read(line(start)).unwrap();
        let heavy = Selection { atoms: Atoms::Heavy, ..Selection::default() };
        assert_eq!(!labels(&structure, &heavy).is_empty(), is_heavy, "{start}");
    }
}

#[test]
fn one_conformer_is_whole() {
    let atoms = [
        "1 N N . SER A 1 1",
        "2 CA C A SER A 1 0.4",
        "3 CA C B SER A 1 0.6",
        "4 CB C A SER A 1 0.4",
        "5 CB C B SER A 1 0.6",
        // Conformer B, the best, has no OG: the OG with the highest occupancy takes its place.
        "6 OG O A SER A 1 0.1",
        "7 OG O C SER A 1 0.2",
        // Equal occupancy: the first one counts.
        "8 O O B HOH A 2 0.5 HET",
        "9 O O A HOH A 2 0.5 HET",
        // The alternate locations are different residues.
        "10 CA C A GLU A 3 0.3",
        "11 CA C B THR A 3 0.7",
        "12 CG C A GLU A 3 0.3",
        "13 CG2 C B THR A 3 0.7",
        "14 O O A HOH B 2 0.2 HET",
    ];
    let structure = structure(&atoms);
    let of = |altlocs| labels(&structure, &Selection { altlocs, ..Selection::default() });
    assert_eq!(of(Altlocs::Best), [1, 3, 5, 7, 8, 11, 13, 14]);
    assert_eq!(of(Altlocs::First), [1, 2, 4, 6, 8, 10, 12, 14]);
    assert_eq!(of(Altlocs::Named("B".into())), [1, 3, 5, 8, 11, 13]);
    assert_eq!(of(Altlocs::Named("Z".into())), [1]);
    assert_eq!(of(Altlocs::All), (1..=14).collect::<Vec<_>>());

    let sample = read_structure(&sample("altloc.cif"), None).unwrap();
    let prolines = labels(&sample, &Selection::default());
    assert_eq!(prolines, (372..=385).collect::<Vec<_>>());
}

#[test]
fn points_without_names_are_labelled_by_their_number() {
    let points = read("1 2 3\n4 5 6\n").unwrap();
    let heavy = Selection { atoms: Atoms::Heavy, hetatm: false, ..Selection::default() };
    for selection in [Selection::default(), heavy] {
        let selected = points.select(&selection).unwrap();
        assert_eq!(selected.points(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        assert_eq!((selected.label(0), selected.label(1)), (1, 2));
        assert!(selected.atom(0).is_none());
    }
    for selection in [
        Selection { chains: vec!["A".into()], ..Selection::default() },
        Selection { atoms: Atoms::CAlpha, ..Selection::default() },
    ] {
        assert_fails(points.select(&selection).map(drop), ErrorKind::Usage, &["points without names"]);
    }
}

#[test]
fn a_selection_may_be_empty() {
    let structure = structure(&["1 O O . HOH A 1 1 HET"]);
    assert!(labels(&structure, &Selection { hetatm: false, ..Selection::default() }).is_empty());
}
