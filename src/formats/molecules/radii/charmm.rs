//! Radii of the force field CHARMM36m, for each atom of amino acids, nucleotides and water, hydrogens too,
//! and of ions.

use crate::molecules::radii::residues::{
    ADENINE, ARGININE, ASPARTATE, CYSTEINE, CYTOSINE, GLUTAMATE, GUANINE, Group, HISTIDINE, LYSINE, PEPTIDE,
    THYMINE, URACIL, WATER,
};

const DEOXY: &str = "DA DC DG DA3 DA5 DC3 DC5 DG3 DG5";

// Half the distance of least energy between two atoms of a type, in steps of 0.001 Å.
/// H, HC and others: of polar groups.
const POLAR: u32 = 225;
/// HA1, HA2, HA3, HB2, HN8, HN9: of aliphatic carbon.
const ALIPHATIC: u32 = 1340;
/// HB1, HN7: of the backbone and of sugars.
const BACKBONE: u32 = 1320;
/// HP: of benzene rings.
const RING: u32 = 1358;
/// HN3: of bases.
const BASE: u32 = 1100;
/// C, CC, CD, CT1.
const C: u32 = 2000;
/// CT2, CT2A, CN8, CN8B.
const CT2: u32 = 2010;
/// CT3, CN9.
const CT3: u32 = 2040;
/// CA.
const CA: u32 = 1992;
/// CPH1, CPH2.
const CPH: u32 = 1800;
/// CP2, CP3.
const CP2: u32 = 2175;
/// CP1, CN7, CN7B.
const CP1: u32 = 2275;
/// CN1 to CN5.
const CN: u32 = 1900;
/// All types of nitrogen.
const N: u32 = 1850;
/// O, OC, OB, ON1, ON3.
const O: u32 = 1700;
/// OH1, ON2, ON4 to ON6.
const OH: u32 = 1770;

/// Half the distance of least energy between equal atoms ("Rmin/2"), rounded to steps of 0.001 Å. Where two
/// groups have an atom of a residue, the last one counts.
///
/// Names of hydrogens are those of the Protein Data Bank, and those of CHARMM.
///
/// Source: the files top_all36_prot, par_all36m_prot, top_all36_na, par_all36_na and toppar_water_ions of the
/// force field of July 2024 (Best and others 2012, J. Chem. Theory Comput. 8, 3257; Huang and others 2017,
/// Nature Methods 14, 71; Hart and others 2012, J. Chem. Theory Comput. 8, 348), as the program
/// `OpenMM` 8.6 (MIT licence) has them.
pub(crate) const CHARMM: &[Group] = &[
    Group {
        residues: &[PEPTIDE],
        atoms: &[
            (N, "N"),
            (POLAR, "H HN H1 H2 H3 HT1 HT2 HT3"),
            (C, "CA C"),
            (BACKBONE, "HA"),
            (CT2, "CB"),
            (ALIPHATIC, "HB HB1 HB2 HB3"),
            (O, "O OXT OT1 OT2 OC1 OC2"),
        ],
    },
    Group { residues: &["ALA"], atoms: &[(CT3, "CB")] },
    Group {
        residues: &[ARGININE],
        atoms: &[
            (CT2, "CG CD"),
            (ALIPHATIC, "HG1 HG2 HG3 HD1 HD2 HD3"),
            (N, "NE NH1 NH2"),
            (C, "CZ"),
            (POLAR, "HE HH11 HH12 HH21 HH22"),
        ],
    },
    Group { residues: &["ASN"], atoms: &[(C, "CG"), (O, "OD1"), (N, "ND2"), (POLAR, "HD21 HD22")] },
    Group { residues: &[ASPARTATE], atoms: &[(C, "CG"), (O, "OD1 OD2")] },
    Group { residues: &["ASH"], atoms: &[(OH, "OD2"), (POLAR, "HD2")] },
    Group { residues: &[CYSTEINE], atoms: &[(2000, "SG"), (450, "HG HG1")] },
    Group { residues: &["CYX"], atoms: &[(1975, "SG")] },
    Group { residues: &["CYM"], atoms: &[(2200, "CB SG")] },
    Group {
        residues: &["GLN"],
        atoms: &[
            (CT2, "CG"),
            (ALIPHATIC, "HG1 HG2 HG3"),
            (C, "CD"),
            (O, "OE1"),
            (N, "NE2"),
            (POLAR, "HE21 HE22"),
        ],
    },
    Group {
        residues: &[GLUTAMATE],
        atoms: &[(CT2, "CG"), (ALIPHATIC, "HG1 HG2 HG3"), (C, "CD"), (O, "OE1 OE2")],
    },
    Group { residues: &["GLH"], atoms: &[(OH, "OE2"), (POLAR, "HE2")] },
    Group { residues: &["GLY"], atoms: &[(CT2, "CA"), (ALIPHATIC, "HA1 HA2 HA3")] },
    Group {
        residues: &[HISTIDINE],
        atoms: &[(CPH, "CG CD2 CE1"), (N, "ND1 NE2"), (POLAR, "HD1 HE2"), (900, "HE1"), (1468, "HD2")],
    },
    Group { residues: &["HIP HSP"], atoms: &[(700, "HE1"), (900, "HD2")] },
    Group {
        residues: &["ILE"],
        atoms: &[
            (C, "CB"),
            (CT2, "CG1"),
            (CT3, "CG2 CD1 CD"),
            (ALIPHATIC, "HG11 HG12 HG13 HG21 HG22 HG23 HD11 HD12 HD13 HD1 HD2 HD3"),
        ],
    },
    Group {
        residues: &["LEU"],
        atoms: &[(C, "CG"), (CT3, "CD1 CD2"), (ALIPHATIC, "HG HD11 HD12 HD13 HD21 HD22 HD23")],
    },
    Group {
        residues: &[LYSINE],
        atoms: &[
            (CT2, "CG CD CE"),
            (ALIPHATIC, "HG1 HG2 HG3 HD1 HD2 HD3 HE1 HE2 HE3"),
            (N, "NZ"),
            (POLAR, "HZ1 HZ2 HZ3"),
        ],
    },
    Group {
        residues: &["MET"],
        atoms: &[(CT2, "CG"), (2000, "SD"), (CT3, "CE"), (ALIPHATIC, "HG1 HG2 HG3 HE1 HE2 HE3")],
    },
    Group {
        residues: &["PHE TYR"],
        atoms: &[(CA, "CG CD1 CD2 CE1 CE2 CZ"), (RING, "HD1 HD2 HE1 HE2 HZ"), (OH, "OH"), (POLAR, "HH")],
    },
    Group {
        residues: &["PRO"],
        atoms: &[(CP1, "CA"), (CP2, "CB CG CD"), (ALIPHATIC, "HG1 HG2 HG3 HD1 HD2 HD3"), (POLAR, "HN1 HN2")],
    },
    Group { residues: &["SER"], atoms: &[(OH, "OG"), (POLAR, "HG HG1")] },
    Group {
        residues: &["THR"],
        atoms: &[(C, "CB"), (OH, "OG1"), (POLAR, "HG1"), (CT3, "CG2"), (ALIPHATIC, "HG21 HG22 HG23")],
    },
    Group {
        residues: &["TRP"],
        atoms: &[
            (1990, "CG CE3 CZ2"),
            (CA, "CD1 CZ3 CH2"),
            (1860, "CD2 CE2"),
            (N, "NE1"),
            (POLAR, "HE1"),
            (RING, "HD1 HE3 HZ2 HZ3 HH2"),
        ],
    },
    Group {
        residues: &["VAL"],
        atoms: &[(C, "CB"), (CT3, "CG1 CG2"), (ALIPHATIC, "HG11 HG12 HG13 HG21 HG22 HG23")],
    },
    Group {
        residues: &["ACE"],
        atoms: &[
            (CT3, "CH3 CAY"),
            (C, "C CY"),
            (O, "O OY"),
            (ALIPHATIC, "H1 H2 H3 HH31 HH32 HH33 HY1 HY2 HY3"),
        ],
    },
    Group { residues: &["NH2"], atoms: &[(N, "N NT"), (POLAR, "HN1 HN2 HT1 HT2")] },
    Group {
        residues: &["NME"],
        atoms: &[
            (N, "N NT"),
            (POLAR, "H HN HNT"),
            (CT3, "C CH3 CAT"),
            (ALIPHATIC, "H1 H2 H3 HH31 HH32 HH33 HT1 HT2 HT3"),
        ],
    },
    Group {
        residues: &[ADENINE, CYTOSINE, GUANINE, THYMINE, URACIL],
        atoms: &[
            (2150, "P"),
            (O, "OP1 OP2 OP3 O1P O2P O3P"),
            (OH, "O5' O4' O3' O2' O5T"),
            (CT2, "C5'"),
            (CP1, "C4' C3' C2' C1'"),
            (ALIPHATIC, "H5' H5'' H5'1 H5'2"),
            (BACKBONE, "H4' H3' H2' H2'1 H1'"),
            (POLAR, "HO2' HO3' HO5' H3T H5T"),
        ],
    },
    // CHARMM calls the hydrogen of the hydroxyl group H2', and that of the carbon H2''.
    Group { residues: &["ADE CYT GUA THY URA"], atoms: &[(POLAR, "H2'"), (BACKBONE, "H2''")] },
    Group {
        residues: &[DEOXY, "T DT DT3 DT5 DU"],
        atoms: &[(CT2, "C2'"), (ALIPHATIC, "H2' H2'' H2'1 H2'2")],
    },
    Group {
        residues: &[ADENINE],
        atoms: &[(N, "N1 N3 N6 N7 N9"), (CN, "C2 C4 C5 C6 C8"), (BASE, "H2 H8"), (POLAR, "H61 H62")],
    },
    Group {
        residues: &[CYTOSINE],
        atoms: &[(N, "N1 N3 N4"), (CN, "C2 C4 C5 C6"), (O, "O2"), (BASE, "H5 H6"), (POLAR, "H41 H42")],
    },
    Group {
        residues: &[GUANINE],
        atoms: &[
            (N, "N1 N2 N3 N7 N9"),
            (CN, "C2 C4 C5 C6 C8"),
            (O, "O6"),
            (BASE, "H8"),
            (POLAR, "H1 H21 H22"),
        ],
    },
    Group {
        residues: &[THYMINE],
        atoms: &[
            (N, "N1 N3"),
            (CN, "C2 C4 C5 C6"),
            (O, "O2 O4"),
            (CT3, "C7 C5M"),
            (ALIPHATIC, "H71 H72 H73 H51 H52 H53"),
            (BASE, "H6"),
            (POLAR, "H3"),
        ],
    },
    Group {
        residues: &[URACIL],
        atoms: &[(N, "N1 N3"), (CN, "C2 C4 C5 C6"), (O, "O2 O4"), (BASE, "H5 H6"), (POLAR, "H3")],
    },
    Group { residues: &[WATER], atoms: &[(1768, "O OW OH2"), (POLAR, "H1 H2 D1 D2 HW1 HW2")] },
    Group { residues: &["LI LIT"], atoms: &[(1298, "LI LIT")] },
    Group { residues: &["NA SOD"], atoms: &[(1411, "NA SOD")] },
    Group { residues: &["MG"], atoms: &[(1185, "MG")] },
    Group { residues: &["K POT"], atoms: &[(1764, "K POT")] },
    Group { residues: &["CA CAL"], atoms: &[(1367, "CA CAL")] },
    Group { residues: &["RB RUB"], atoms: &[(1900, "RB RUB")] },
    Group { residues: &["CS CES"], atoms: &[(2100, "CS CES")] },
    Group { residues: &["BA BAR"], atoms: &[(1890, "BA BAR")] },
    Group { residues: &["ZN ZN2"], atoms: &[(1090, "ZN")] },
    Group { residues: &["CD CD2"], atoms: &[(1357, "CD")] },
    Group { residues: &["CL CLA"], atoms: &[(2270, "CL CLA")] },
];
