//! Names of residues that files use without stating what they are.
//!
//! Names are those of the Chemical Component Dictionary of the wwPDB, and those of force fields (AMBER,
//! CHARMM, GROMACS).

use crate::molecules::elements::Element;

/// Amino acids; also ambiguous and unknown ones, the states of protonation of force fields, and caps.
const AMINO_ACIDS: &str = "ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL \
                           SEC PYL ASX GLX XLE UNK \
                           HID HIE HIP HSD HSE HSP ASH GLH LYN CYX CYM CYN ARN TYM \
                           ACE NH2 NME NMA FOR";

/// Modified amino acids that chains contain often. D-amino acids are in the last two lines.
const MODIFIED_AMINO_ACIDS: &str = "MSE SEP TPO PTR CSO CSD CSS CSX CSW CME OCS CAS CAF SCY SMC YCM SNC SCH \
                                    KCX LLP MLY MLZ M3L ALY BTK HYP PCA CGU FME TYS TYI IYR MHO SME SEB \
                                    AIB ABA NLE NVA ORN SAR MVA MLE BMT MAA NEP HIC MHS AGM ASA ASB BHD \
                                    IAS SNN DHA DBB CRO CRQ CR2 NRQ TRQ TPQ TOX HTR FTR OMT MEN MEQ DAH \
                                    DAL DAR DAS DCY DGL DGN DHI DIL DLE DLY DPN DPR DSG DSN DTH DTR DTY \
                                    DVA MED";

/// Nucleotides; also unknown ones, and the names of force fields with the ends of strands.
const NUCLEOTIDES: &str = "A C G U I N T DA DC DG DT DU DI DN ADE CYT GUA THY URA \
                           DA3 DC3 DG3 DT3 DA5 DC5 DG5 DT5 RA RC RG RU RA3 RC3 RG3 RU3 RA5 RC5 RG5 RU5 \
                           A3 C3 G3 U3 A5 C5 G5 U5";

/// Modified nucleotides that strands contain often.
const MODIFIED_NUCLEOTIDES: &str = "PSU 5MU 5MC 5CM 5BU BRU CBR BGM 2MG M2G 7MG G7M 1MA 6MA MA6 A2M OMC OMG \
                                    OMU H2U YG YYG QUO 4SU MIA 1MG 8OG UR3 4OC 2MA CCC A23 US5";

/// Water and heavy water.
const WATERS: &str = "HOH DOD WAT H2O D2O OH2 SOL TIP TP3 TIP2 TIP3 TIP4 TIP5 SPC SPCE";

/// Ions whose names do not begin with their elements, as CHARMM has them.
const FORCE_FIELD_IONS: &str = "SOD CLA POT CES CAL LIT RUB BAR CAD";

/// Metals and halogens: single atoms of them are ions.
const IONIC_ELEMENTS: &str = "LI NA K RB CS FR BE MG CA SR BA RA SC TI V CR MN FE CO NI CU ZN Y ZR NB MO TC \
                              RU RH PD AG CD LA CE PR ND PM SM EU GD TB DY HO ER TM YB LU HF TA W RE OS IR \
                              PT AU HG AC TH PA U AL GA IN SN TL PB BI F CL BR I";

/// What the name of a residue tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A residue of proteins or nucleic acids.
    Polymer,
    Water,
    /// A name that tells nothing.
    Other,
}

/// What `name` tells.
pub(crate) fn kind(name: &str) -> Kind {
    let polymers = [AMINO_ACIDS, NUCLEOTIDES, MODIFIED_AMINO_ACIDS, MODIFIED_NUCLEOTIDES];
    if contains(WATERS, name) {
        Kind::Water
    } else if polymers.iter().any(|list| contains(list, name)) {
        Kind::Polymer
    } else {
        Kind::Other
    }
}

/// Whether the only atom of a residue is an ion.
pub(crate) fn is_ion_atom(residue: &str, atomic_number: u8) -> bool {
    let element = Element::of_number(usize::from(atomic_number));
    contains(FORCE_FIELD_IONS, residue)
        || element.is_some_and(|element| contains(IONIC_ELEMENTS, element.symbol()))
}

/// Whether a list of words has `name`, in upper or lower case.
fn contains(list: &str, name: &str) -> bool {
    !name.is_empty() && list.split_ascii_whitespace().any(|word| word.eq_ignore_ascii_case(name))
}
