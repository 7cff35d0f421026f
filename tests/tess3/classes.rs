//! Classes of residues, by entities, sequences, ends of chains, and names.

use super::mesh::Mesh;
use super::molecules::{Record, cloud, pdb};
use crate::programs::{outcome, run};

fn labels(arguments: &[&str], text: &str) -> Vec<u64> {
    let output = run("tess3", &[arguments, &["-"]].concat(), text.as_bytes());
    assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    let mut labels = Mesh::read(&output.stdout).labels;
    labels.sort_unstable();
    labels
}

fn tens(numbers: impl IntoIterator<Item = u64>) -> Vec<u64> {
    numbers.into_iter().map(|i| 10 * i).collect()
}

/// Atoms 10 to 40 are an alanine of chain A, 50 to 80 the HETATM records of `modified` behind it, 90 to 120
/// glycerol, 130 to 160 four ions and 170 to 200 four waters.
fn molecule(modified: &'static str) -> Vec<Record> {
    let mut atoms = cloud(20, 9_000, 50);
    for (i, atom) in atoms.iter_mut().enumerate() {
        atom.number = 1 + i as i32 / 4;
        atom.name = ["N", "CA", "C", "CB"][i % 4];
        match i {
            0..4 => {}
            4..8 => (atom.record, atom.residue) = ("HETATM", modified),
            8..12 => (atom.record, atom.residue) = ("HETATM", "GOL"),
            12..16 => {
                let ion = ["CA", "ZN", "CL", "NA"][i % 4];
                (atom.residue, atom.name, atom.element) = (ion, ion, if i == 12 { "" } else { ion });
                (atom.record, atom.number) = ("HETATM", 100 + i as i32);
            }
            _ => {
                (atom.record, atom.residue, atom.name, atom.element) = ("HETATM", "HOH", "O", "O");
                atom.number = 200 + i as i32;
            }
        }
    }
    atoms
}

#[test]
fn names_tell_classes() {
    let text = pdb(&molecule("MSE"));
    assert_eq!(labels(&["--classes", "polymer"], &text), tens(1..=8));
    assert_eq!(labels(&["--classes", "ligand"], &text), tens(9..=12));
    assert_eq!(labels(&["--classes", "ion"], &text), tens(13..=16));
    assert_eq!(labels(&["--classes", "water"], &text), tens(17..=20));
    assert_eq!(labels(&["--classes", "water,polymer"], &text), tens((1..=8).chain(17..=20)));
    assert_eq!(labels(&[], &text), tens(1..=20));
}

/// `--hetatm` means records, so it drops selenomethionine, which `--classes polymer` keeps.
#[test]
fn modified_residues_stay_with_their_chain() {
    let text = pdb(&molecule("MSE"));
    assert_eq!(labels(&["--hetatm", "off"], &text), tens(1..=4));
    assert_eq!(labels(&["--classes", "polymer"], &text), tens(1..=8));
}

#[test]
fn sequences_and_ends_of_chains_tell_what_names_do_not() {
    let atoms = molecule("XYZ");
    let lines: Vec<String> = atoms.iter().map(Record::line).collect();
    let with_end = |after: usize| {
        let (before, behind) = lines.split_at(after);
        before.concat() + "TER\n" + &behind.concat() + "END\n"
    };
    let all = with_end(20);
    let sequence = |chain| format!("SEQRES   1 {chain}    2  ALA XYZ\n");
    let modified = |number| format!("MODRES 1ABC XYZ A {number:>4}  ALA  SOMETHING\n");
    let unended = pdb(&atoms);
    let cases = [
        ("no statement", unended.clone(), 4),
        ("SEQRES", sequence('A') + &unended, 8),
        ("SEQRES of another chain", sequence('B') + &unended, 4),
        ("MODRES", modified(2) + &unended, 8),
        ("MODRES of another residue", modified(3) + &unended, 4),
        ("TER behind", with_end(8), 8),
        ("TER before", with_end(4), 4),
        ("SEQRES, but behind TER", sequence('A') + &with_end(4), 4),
        // Before a TER, glycerol would be taken for a cap of the chain.
        ("TER behind everything", all, 12),
    ];
    for (case, text, expected) in cases {
        assert_eq!(labels(&["--classes", "polymer"], &text), tens(1..=expected), "{case}");
    }
}

/// A free amino acid is a ligand, but the atoms of a chain count also behind a TER.
#[test]
fn amino_acids_behind_the_end_of_the_chain_are_ligands() {
    let atoms = molecule("GLY");
    let (before, behind) = atoms.split_at(4);
    let text = |behind: &[Record]| {
        let lines = |atoms: &[Record]| atoms.iter().map(Record::line).collect::<String>();
        lines(before) + "TER\n" + &lines(behind) + "END\n"
    };
    assert_eq!(labels(&["--classes", "ligand"], &text(behind)), tens(5..=12));
    let mut chained = behind.to_vec();
    chained[..4].iter_mut().for_each(|atom| atom.record = "ATOM");
    assert_eq!(labels(&["--classes", "polymer"], &text(&chained)), tens(1..=8));
}

/// DNA with a peptide of D-serine, N-methylcysteine and other residues that only the entity tells.
#[test]
fn entities_tell_classes() {
    for (classes, expected) in [("polymer", 237), ("ligand", 24), ("water", 80), ("polymer,ion", 238)] {
        let arguments = ["--altloc", "all", "--classes", classes, "tests/data/1pfe.cif.gz"];
        let output = run("tess3", &arguments, b"");
        let mesh = Mesh::read(&output.stdout);
        assert_eq!(mesh.points.len() + mesh.merged as usize, expected, "{classes}");
    }
}

#[test]
fn classes_need_residues() {
    for (text, words) in [
        ("4\n\nC 0 0 0\nC 1 0 0\nC 0 1 0\nC 0 0 1\n", "without residues"),
        ("1 2 3\n4 5 6\n7 8 8\n", "without names"),
    ] {
        let (code, message) = outcome(&run("tess3", &["--classes", "polymer", "-"], text.as_bytes()));
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains(words), "{message}");
    }
    let text = pdb(&molecule("MSE")[..16]);
    let (code, message) = outcome(&run("tess3", &["--classes", "water", "-"], text.as_bytes()));
    assert_eq!(code, Some(2));
    assert!(message.contains("with all classes there would be 16"), "{message}");
}
