//! Elements: their symbols, and their radii where no residue tells more.

/// Symbols of the elements, by atomic number less one.
const SYMBOLS: [&str; 118] = [
    "H", "He", "Li", "Be", "B", "C", "N", "O", "F", "Ne", "Na", "Mg", "Al", "Si", "P", "S", "Cl", "Ar", "K",
    "Ca", "Sc", "Ti", "V", "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn", "Ga", "Ge", "As", "Se", "Br", "Kr",
    "Rb", "Sr", "Y", "Zr", "Nb", "Mo", "Tc", "Ru", "Rh", "Pd", "Ag", "Cd", "In", "Sn", "Sb", "Te", "I", "Xe",
    "Cs", "Ba", "La", "Ce", "Pr", "Nd", "Pm", "Sm", "Eu", "Gd", "Tb", "Dy", "Ho", "Er", "Tm", "Yb", "Lu",
    "Hf", "Ta", "W", "Re", "Os", "Ir", "Pt", "Au", "Hg", "Tl", "Pb", "Bi", "Po", "At", "Rn", "Fr", "Ra",
    "Ac", "Th", "Pa", "U", "Np", "Pu", "Am", "Cm", "Bk", "Cf", "Es", "Fm", "Md", "No", "Lr", "Rf", "Db",
    "Sg", "Bh", "Hs", "Mt", "Ds", "Rg", "Cn", "Nh", "Fl", "Mc", "Lv", "Ts", "Og",
];

/// An element, by its atomic number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Element(u8);

impl Element {
    /// The element of a symbol in upper or lower case. Deuterium (D) and tritium (T) are hydrogen.
    pub(crate) fn of_symbol(symbol: &str) -> Option<Element> {
        let symbol = if matches!(symbol, "D" | "d" | "T" | "t") { "H" } else { symbol };
        let index = SYMBOLS.iter().position(|known| known.eq_ignore_ascii_case(symbol))?;
        Element::of_number(index + 1)
    }

    /// The element of an atomic number.
    pub(crate) fn of_number(number: usize) -> Option<Element> {
        (1..=SYMBOLS.len()).contains(&number).then_some(Element(number as u8))
    }

    /// Its atomic number.
    pub(crate) fn number(self) -> u8 {
        self.0
    }

    /// Its symbol.
    pub(crate) fn symbol(self) -> &'static str {
        SYMBOLS[usize::from(self.0) - 1]
    }

    /// Its van der Waals radius in steps of 0.001 Å; `None` beyond lawrencium.
    ///
    /// Source: for the main group Mantina, Chamberlin, Valero, Cramer and Truhlar 2009, table 12 (J. Phys.
    /// Chem. A 113, 5806), which keeps the radii of Bondi 1964 (J. Phys. Chem. 68, 441) but that of hydrogen;
    /// for Ni, Cu, Zn, Pd, Ag, Cd, Pt, Au, Hg and U Bondi; for other metals Hu, Zhou and Robertson 2009
    /// (Z. Kristallogr. 224, 375), as listed in the CRC Handbook of Chemistry and Physics.
    pub(crate) fn radius(self) -> Option<u32> {
        RADII_PM.get(usize::from(self.0) - 1).map(|&picometres| u32::from(picometres) * 10)
    }
}

/// Radii in units of 0.01 Å, by atomic number less one.
#[rustfmt::skip]
const RADII_PM: [u16; 103] = [
    110, 140,
    181, 153, 192, 170, 155, 152, 147, 154,
    227, 173, 184, 210, 180, 180, 175, 188,
    275, 231,
    215, 211, 207, 206, 205, 204, 200, 163, 140, 139,
    187, 211, 185, 190, 183, 202,
    303, 249,
    232, 223, 218, 217, 216, 213, 210, 163, 172, 158,
    193, 217, 206, 206, 198, 216,
    343, 268,
    243, 242, 240, 239, 238, 236, 235, 234, 233, 231, 230, 229, 227, 226, 224,
    223, 222, 218, 216, 216, 213, 175, 166, 155,
    196, 202, 207, 197, 202, 220,
    348, 283,
    247, 245, 243, 186, 239, 243, 244, 245, 244, 245, 245, 245, 246, 246, 246,
];
