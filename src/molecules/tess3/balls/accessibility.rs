//! What accessible areas of residues are compared with, and the kinds of atoms that they are divided into.

use super::Molecule;
use crate::balls::{Balls, nearest};
use spmesh_formats::molecules::Class;

/// Greatest areas of residues, with which relative accessibilities are 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Maxima {
    /// Theoretical: of the middle residue of Gly-X-Gly over all allowed conformations (Tien, Meyer, Sydykova,
    /// Spielman and Wilke 2013, PLoS ONE 8, e80635, table 1).
    Tien,
    /// Of the middle residue of extended Gly-X-Gly (Miller, Janin, Lesk and Chothia 1987, J. Mol. Biol. 196,
    /// 641).
    Miller,
}

/// The amino acids, with the areas of Tien and of Miller in Å². Both columns were compared with
/// `Bio.Data.PDBData` of Biopython 1.88 ("Wilke" and "Miller"), and with the table of Tien et al. itself.
const MAXIMA: [(&str, f64, f64); 20] = [
    ("ALA", 129.0, 113.0),
    ("ARG", 274.0, 241.0),
    ("ASN", 195.0, 158.0),
    ("ASP", 193.0, 151.0),
    ("CYS", 167.0, 140.0),
    ("GLN", 225.0, 189.0),
    ("GLU", 223.0, 183.0),
    ("GLY", 104.0, 85.0),
    ("HIS", 224.0, 194.0),
    ("ILE", 197.0, 182.0),
    ("LEU", 201.0, 180.0),
    ("LYS", 236.0, 211.0),
    ("MET", 224.0, 204.0),
    ("PHE", 240.0, 218.0),
    ("PRO", 159.0, 143.0),
    ("SER", 155.0, 122.0),
    ("THR", 172.0, 146.0),
    ("TRP", 285.0, 259.0),
    ("TYR", 263.0, 229.0),
    ("VAL", 174.0, 160.0),
];

impl Maxima {
    /// The name of the table.
    pub fn name(self) -> &'static str {
        match self {
            Maxima::Tien => "tien",
            Maxima::Miller => "miller",
        }
    }

    /// The greatest area of an amino acid in Å²; `None` for other residues.
    pub(super) fn of(self, residue: &str) -> Option<f64> {
        let &(_, tien, miller) = MAXIMA.iter().find(|(name, ..)| name.eq_ignore_ascii_case(residue))?;
        Some(if self == Maxima::Tien { tien } else { miller })
    }
}

/// Names of atoms of the main chain, as freesasa has them: of amino acids, and of the backbone of nucleotides
/// with its sugar.
const MAIN_CHAIN: [&str; 16] =
    ["CA", "N", "O", "C", "OXT", "P", "OP1", "OP2", "O5'", "C5'", "C4'", "O4'", "C3'", "O3'", "C2'", "C1'"];

/// Atomic numbers.
const HYDROGEN: u8 = 1;
const CARBON: u8 = 6;

/// Greatest length of a bond to hydrogen, in Å.
const BOND: f64 = 1.5;

/// Names of the columns of kinds.
pub(super) const KINDS: [&str; 4] = ["polar", "apolar", "main_chain", "side_chain"];

/// For each atom the columns of [`KINDS`] that it counts for. Carbon is apolar, all else polar. Hydrogen is
/// as the nearest other atom, if it is as near as one that it is bonded to. What is no polymer is of no
/// chain.
pub(super) fn kinds(molecule: &Molecule<'_>) -> Vec<[bool; 4]> {
    let selected = molecule.selected;
    let count = selected.points().len();
    let number = |index: u32| selected.atom(index as usize).map_or(0, |atom| atom.atom.atomic_number);
    let radii = vec![0.5 * BOND / molecule.scale; count];
    let balls = Balls { centres: selected.points(), radii: &radii };
    let heavy: Vec<u32> = (0..count as u32).filter(|&index| number(index) != HYDROGEN).collect();
    let hydrogens: Vec<u32> = (0..count as u32).filter(|&index| number(index) == HYDROGEN).collect();
    let mut bearers: Vec<u32> = (0..count as u32).collect();
    for (hydrogen, bearer) in hydrogens.iter().zip(nearest(balls, &heavy, &hydrogens)) {
        bearers[*hydrogen as usize] = bearer.unwrap_or(*hydrogen);
    }
    let kind = |bearer: u32| {
        let Some(atom) = selected.atom(bearer as usize) else { return [false; 4] };
        let is_apolar = atom.atom.atomic_number == CARBON;
        let is_polymer = atom.residue().class == Class::Polymer;
        let is_main = MAIN_CHAIN.contains(&atom.name());
        [!is_apolar, is_apolar, is_polymer && is_main, is_polymer && !is_main]
    };
    bearers.into_iter().map(kind).collect()
}
