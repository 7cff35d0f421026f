//! Radii of the atoms of amino acids, nucleotides and water, without their hydrogens: each is the radius of
//! an atom together with the hydrogens bound to it.

/// Atoms that some residues have with the same radii.
pub(crate) struct Group {
    /// Names of the residues, between blanks.
    pub(crate) residues: &'static [&'static str],
    /// Radii in steps of 0.001 Å, and the names of the atoms that have them, between blanks.
    pub(crate) atoms: &'static [(u32, &'static str)],
}

impl Group {
    /// The names of its residues.
    pub(crate) fn residues(&self) -> impl Iterator<Item = &'static str> {
        self.residues.iter().flat_map(|names| names.split(' '))
    }

    /// The names of its atoms, with their radii.
    pub(crate) fn atoms(&self) -> impl Iterator<Item = (&'static str, u32)> {
        self.atoms.iter().flat_map(|&(radius, names)| names.split(' ').map(move |name| (name, radius)))
    }
}

/// Whether a residue is one of these tables, whose atoms' names start with the symbols of the elements.
pub(crate) fn is_known(residue: &str) -> bool {
    PROTOR.iter().any(|group| group.residues().any(|name| name == residue))
}

// Residues by their names in the Protein Data Bank, followed by names that AMBER, CHARMM and GROMACS give to
// residues with other hydrogens or at the ends of chains.
pub(crate) const PEPTIDE: &str = "ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL \
    ASX GLX PYL SEC MSE ARN ASH CYX CYM GLH HID HIE HIP HSD HSE HSP LYN";
pub(crate) const ARGININE: &str = "ARG ARN";
pub(crate) const ASPARTATE: &str = "ASP ASH";
pub(crate) const CYSTEINE: &str = "CYS CYX CYM";
pub(crate) const GLUTAMATE: &str = "GLU GLH";
pub(crate) const HISTIDINE: &str = "HIS HID HIE HIP HSD HSE HSP";
pub(crate) const LYSINE: &str = "LYS LYN";
pub(crate) const ADENINE: &str = "A DA RA ADE A3 A5 DA3 DA5 RA3 RA5";
pub(crate) const CYTOSINE: &str = "C DC RC CYT C3 C5 DC3 DC5 RC3 RC5";
pub(crate) const GUANINE: &str = "G DG RG GUA G3 G5 DG3 DG5 RG3 RG5";
const INOSINE: &str = "I DI";
pub(crate) const THYMINE: &str = "T DT THY DT3 DT5";
pub(crate) const URACIL: &str = "U DU RU URA U3 U5 RU3 RU5";
pub(crate) const WATER: &str = "HOH DOD WAT H2O SOL SPC TIP TIP3 TIP4 TIP5 TP3 TP4 TP5";

// Types of the table ProtOr: the element, its bonds, and its hydrogens (H) if they matter.
const C3H0: u32 = 1610;
const C3H1: u32 = 1760;
const C4: u32 = 1880;
const N: u32 = 1640;
const O1: u32 = 1420;
const O2: u32 = 1460;
const P: u32 = 1800;
const S: u32 = 1770;
const SE: u32 = 1900;
/// Either oxygen or nitrogen.
const X: u32 = 1500;

/// Radii of heavy atoms by their bonds.
///
/// Source: Tsai, Taylor, Chothia and Gerstein 1999 (J. Mol. Biol. 290, 253), table 2. The paper has no radii
/// for selenium, phosphorus, nucleotides and water: these, and which bonds an atom has, are those of the
/// program `FreeSASA` (Mitternacht 2016, F1000Research 5, 189).
pub(crate) const PROTOR: &[Group] = &[
    Group {
        residues: &[PEPTIDE],
        atoms: &[(N, "N"), (C4, "CA CB"), (C3H0, "C"), (O1, "O OT1 OC1"), (O2, "OXT OT2 OC2")],
    },
    Group { residues: &[ARGININE], atoms: &[(C4, "CG CD"), (N, "NE NH1 NH2"), (C3H0, "CZ")] },
    Group { residues: &["ASN"], atoms: &[(C3H0, "CG"), (O1, "OD1"), (N, "ND2")] },
    Group { residues: &[ASPARTATE], atoms: &[(C3H0, "CG"), (O1, "OD1"), (O2, "OD2")] },
    Group { residues: &["ASX"], atoms: &[(C3H0, "CG"), (X, "XD1 XD2 AD1 AD2")] },
    Group { residues: &[CYSTEINE], atoms: &[(S, "SG")] },
    Group { residues: &["GLN"], atoms: &[(C4, "CG"), (C3H0, "CD"), (O1, "OE1"), (N, "NE2")] },
    Group { residues: &[GLUTAMATE], atoms: &[(C4, "CG"), (C3H0, "CD"), (O1, "OE1"), (O2, "OE2")] },
    Group { residues: &["GLX"], atoms: &[(C4, "CG"), (C3H0, "CD"), (X, "XE1 XE2 AE1 AE2")] },
    Group { residues: &[HISTIDINE], atoms: &[(C3H0, "CG"), (C3H1, "CD2 CE1"), (N, "ND1 NE2")] },
    Group { residues: &["ILE"], atoms: &[(C4, "CG1 CG2 CD1 CD")] },
    Group { residues: &["LEU"], atoms: &[(C4, "CG CD1 CD2")] },
    Group { residues: &[LYSINE], atoms: &[(C4, "CG CD CE"), (N, "NZ")] },
    Group { residues: &["MET"], atoms: &[(C4, "CG CE"), (S, "SD")] },
    Group { residues: &["MSE"], atoms: &[(C4, "CG CE"), (SE, "SE")] },
    Group { residues: &["PHE"], atoms: &[(C3H0, "CG"), (C3H1, "CD1 CD2 CE1 CE2 CZ")] },
    Group { residues: &["PRO"], atoms: &[(C4, "CG CD")] },
    Group {
        residues: &["PYL"],
        atoms: &[(C4, "CG CD CE CA2 CB2 CG2 CD2"), (C3H1, "CE2"), (C3H0, "C2"), (N, "NZ N2"), (O1, "O2")],
    },
    Group { residues: &["SEC"], atoms: &[(SE, "SE")] },
    Group { residues: &["SER"], atoms: &[(O2, "OG")] },
    Group { residues: &["THR"], atoms: &[(O2, "OG1"), (C4, "CG2")] },
    Group { residues: &["TRP"], atoms: &[(C3H0, "CG CD2 CE2"), (C3H1, "CD1 CE3 CZ2 CZ3 CH2"), (N, "NE1")] },
    Group { residues: &["TYR"], atoms: &[(C3H0, "CG CZ"), (C3H1, "CD1 CD2 CE1 CE2"), (O2, "OH")] },
    Group { residues: &["VAL"], atoms: &[(C4, "CG1 CG2")] },
    Group { residues: &["ACE"], atoms: &[(C3H1, "C"), (O1, "O"), (C4, "CH3")] },
    Group { residues: &["NH2"], atoms: &[(N, "N")] },
    Group { residues: &["NME"], atoms: &[(N, "N"), (C4, "C CH3")] },
    Group {
        residues: &[ADENINE, CYTOSINE, GUANINE, INOSINE, THYMINE, URACIL],
        atoms: &[
            (P, "P"),
            (O1, "OP1 O1P"),
            (O2, "OP2 O2P OP3 O3P O5' O4' O3' O2'"),
            (C4, "C5' C4' C3' C2' C1'"),
        ],
    },
    Group { residues: &[ADENINE], atoms: &[(N, "N1 N3 N6 N7 N9"), (C3H1, "C2 C8"), (C3H0, "C4 C5 C6")] },
    Group { residues: &[CYTOSINE], atoms: &[(N, "N1 N3 N4"), (C3H0, "C2 C4"), (C3H1, "C5 C6"), (O1, "O2")] },
    Group {
        residues: &[GUANINE],
        atoms: &[(N, "N1 N2 N3 N7 N9"), (C3H1, "C8"), (C3H0, "C2 C4 C5 C6"), (O1, "O6")],
    },
    Group {
        residues: &[INOSINE],
        atoms: &[(N, "N1 N3 N7 N9"), (C3H1, "C2 C8"), (C3H0, "C4 C5 C6"), (O1, "O6")],
    },
    Group {
        residues: &[THYMINE],
        atoms: &[(N, "N1 N3"), (C3H0, "C2 C4 C5"), (C3H1, "C6"), (C4, "C7 C5M"), (O1, "O2 O4")],
    },
    Group { residues: &[URACIL], atoms: &[(N, "N1 N3"), (C3H0, "C2 C4"), (C3H1, "C5 C6"), (O1, "O2 O4")] },
    Group { residues: &[WATER], atoms: &[(O2, "O OW OH2")] },
];

// Types of the united-atom table: carbon with four bonds and with three, nitrogen of amines and of amides.
const ALIPHATIC: u32 = 1870;
const TRIGONAL: u32 = 1760;
const AMINE: u32 = 1500;
const AMIDE: u32 = 1650;
const OXYGEN: u32 = 1400;

/// Radii of united atoms in amino acids. Other atoms have those of [`UNITED_ELEMENTS`].
///
/// Source: Chothia 1976 (J. Mol. Biol. 105, 1), as the program NACCESS (Hubbard and Thornton 1993) assigns
/// them; unknown oxygen or nitrogen as in [`PROTOR`].
pub(crate) const UNITED: &[Group] = &[
    Group {
        residues: &[PEPTIDE],
        atoms: &[(AMIDE, "N"), (ALIPHATIC, "CA CB"), (TRIGONAL, "C"), (OXYGEN, "O OXT OT1 OT2 OC1 OC2")],
    },
    Group { residues: &[ARGININE], atoms: &[(ALIPHATIC, "CG CD"), (TRIGONAL, "CZ"), (AMIDE, "NE NH1 NH2")] },
    Group { residues: &["ASN", ASPARTATE], atoms: &[(TRIGONAL, "CG"), (AMIDE, "ND2")] },
    Group { residues: &["ASX"], atoms: &[(TRIGONAL, "CG"), (X, "XD1 XD2 AD1 AD2")] },
    Group { residues: &["GLN", GLUTAMATE], atoms: &[(ALIPHATIC, "CG"), (TRIGONAL, "CD"), (AMIDE, "NE2")] },
    Group { residues: &["GLX"], atoms: &[(ALIPHATIC, "CG"), (TRIGONAL, "CD"), (X, "XE1 XE2 AE1 AE2")] },
    Group { residues: &[HISTIDINE], atoms: &[(TRIGONAL, "CG CD2 CE1"), (AMIDE, "ND1 NE2")] },
    Group { residues: &["ILE"], atoms: &[(ALIPHATIC, "CG1 CG2 CD1 CD")] },
    Group { residues: &["LEU"], atoms: &[(ALIPHATIC, "CG CD1 CD2")] },
    Group { residues: &[LYSINE], atoms: &[(ALIPHATIC, "CG CD CE"), (AMINE, "NZ")] },
    Group { residues: &["MET", "MSE"], atoms: &[(ALIPHATIC, "CG CE")] },
    Group { residues: &["PHE", "TYR"], atoms: &[(TRIGONAL, "CG CD1 CD2 CE1 CE2 CZ")] },
    Group { residues: &["PRO"], atoms: &[(ALIPHATIC, "CG CD")] },
    Group { residues: &["THR"], atoms: &[(ALIPHATIC, "CG2")] },
    Group { residues: &["TRP"], atoms: &[(TRIGONAL, "CG CD1 CD2 CE2 CE3 CZ2 CZ3 CH2"), (AMIDE, "NE1")] },
    Group { residues: &["VAL"], atoms: &[(ALIPHATIC, "CG1 CG2")] },
    Group { residues: &["ACE"], atoms: &[(TRIGONAL, "C"), (ALIPHATIC, "CH3")] },
    Group { residues: &["NH2 NME"], atoms: &[(AMIDE, "N"), (ALIPHATIC, "C CH3")] },
];

/// Radii of united atoms elsewhere: those of nucleotides, in steps of 0.001 Å.
///
/// Source: as [`UNITED`].
pub(crate) const UNITED_ELEMENTS: &[(&str, u32)] =
    &[("C", 1800), ("N", 1600), ("O", OXYGEN), ("P", 1900), ("S", 1850), ("SE", 1800)];
