//! Writes atoms with a value for each, as PDB (in the columns of the temperature factor) and mmCIF.

use std::borrow::Cow;
use std::io::Write;

use crate::molecules::selection::Selected;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::points::Point3;

/// Least and greatest numbers that fit their columns of a PDB file.
const SERIAL_MAX: u64 = 99_999;
const NUMBERS: std::ops::RangeInclusive<i32> = -999..=9_999;
const COORDINATES: std::ops::Range<f64> = -999.999..9_999.999_5;
const VALUES: std::ops::Range<f64> = -99.99..999.995;

/// An atom to write.
#[derive(Debug, Clone, Copy)]
pub struct WrittenAtom<'a> {
    /// Whether the record is HETATM.
    pub is_hetatm: bool,
    /// Serial number.
    pub serial: u64,
    /// Its name.
    pub name: &'a str,
    /// The symbol of its element.
    pub element: &'a str,
    /// Alternate location.
    pub altloc: &'a str,
    /// Name of the residue.
    pub residue: &'a str,
    /// Chain, as the authors name it, and as mmCIF does.
    pub chain: &'a str,
    /// See `chain`.
    pub subchain: &'a str,
    /// Number of the residue, if it has one.
    pub number: Option<i32>,
    /// Insertion code.
    pub insertion_code: &'a str,
    /// Position, in Å.
    pub at: Point3,
    /// Occupancy.
    pub occupancy: f32,
    /// What takes the place of the temperature factor; `None` is written as 0, or as nothing in mmCIF.
    pub value: Option<f64>,
}

/// The atoms of a selection, with their values. Points without names are left out.
pub fn written_atoms<'s>(
    selected: &'s Selected<'s>,
    value: impl Fn(usize) -> Option<f64> + 's,
) -> impl Iterator<Item = WrittenAtom<'s>> + 's {
    (0..selected.points().len()).filter_map(move |index| {
        let atom = selected.atom(index)?;
        Some(WrittenAtom {
            is_hetatm: atom.atom.is_hetatm,
            serial: atom.atom.serial,
            name: atom.name(),
            element: atom.element(),
            altloc: atom.altloc(),
            residue: atom.residue_name(),
            chain: atom.chain(),
            subchain: atom.subchain(),
            number: atom.residue_number(),
            insertion_code: atom.insertion_code(),
            at: selected.structure().coordinates.to_world(atom.point),
            occupancy: atom.atom.occupancy,
            value: value(index),
        })
    })
}

/// Writes atoms as PDB.
///
/// # Errors
/// Usage, if a name or a number does not fit its columns; if writing fails.
pub fn write_pdb<'a>(atoms: impl Iterator<Item = WrittenAtom<'a>>, output: &mut impl Write) -> Result<()> {
    for atom in atoms {
        check_columns(&atom)?;
        let WrittenAtom { serial, altloc, residue, chain, insertion_code, occupancy, element, .. } = atom;
        let record = if atom.is_hetatm { "HETATM" } else { "ATOM  " };
        // Symbols of two letters start one column before others.
        let name = match atom.name.len() {
            4 => atom.name.to_string(),
            _ if element.len() == 2 => format!("{:<4}", atom.name),
            _ => format!(" {:<3}", atom.name),
        };
        let number = atom.number.map_or(String::new(), |number| number.to_string());
        let [x, y, z] = atom.at;
        let value = atom.value.unwrap_or(0.0);
        let line = format!(
            "{record}{serial:>5} {name}{altloc:>1}{residue:>3}{chain:>2}{number:>4}{insertion_code:>1}   \
             {x:>8.3}{y:>8.3}{z:>8.3}{occupancy:>6.2}{value:>6.2}          {:>2}\n",
            element.to_ascii_uppercase()
        );
        output.write_all(line.as_bytes()).map_err(writing)?;
    }
    output.write_all(b"END\n").map_err(writing)
}

/// Refuses what does not fit the columns of PDB.
fn check_columns(atom: &WrittenAtom<'_>) -> Result<()> {
    let texts = [
        ("name of the atom", atom.name, 4),
        ("alternate location", atom.altloc, 1),
        ("name of the residue", atom.residue, 3),
        ("name of the chain", atom.chain, 1),
        ("insertion code", atom.insertion_code, 1),
        ("element", atom.element, 2),
    ];
    let long = texts.iter().find(|(_, text, most)| text.len() > *most || !text.is_ascii());
    let what = if let Some((what, text, _)) = long {
        format!("{what} {text:?}")
    } else if atom.serial > SERIAL_MAX {
        "serial number".to_string()
    } else if let Some(number) = atom.number.filter(|number| !NUMBERS.contains(number)) {
        format!("number of the residue {number}")
    } else if !atom.at.iter().all(|c| COORDINATES.contains(c)) {
        "position".to_string()
    } else if let Some(value) = atom.value.filter(|value| !VALUES.contains(value)) {
        format!("value {value:.2}")
    } else {
        return Ok(());
    };
    let message =
        format!("atom {}: its {what} does not fit the columns of PDB: write mmCIF (.cif)", atom.serial);
    Err(Error::usage(message))
}

/// Writes atoms as mmCIF, in a data block of this name.
///
/// # Errors
/// If writing fails.
pub fn write_mmcif<'a>(
    name: &str,
    model: i64,
    atoms: impl Iterator<Item = WrittenAtom<'a>>,
    output: &mut impl Write,
) -> Result<()> {
    let name: String =
        name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
    let items = [
        "group_PDB",
        "id",
        "type_symbol",
        "label_atom_id",
        "label_alt_id",
        "label_comp_id",
        "label_asym_id",
        "label_seq_id",
        "pdbx_PDB_ins_code",
        "Cartn_x",
        "Cartn_y",
        "Cartn_z",
        "occupancy",
        "B_iso_or_equiv",
        "auth_seq_id",
        "auth_comp_id",
        "auth_asym_id",
        "auth_atom_id",
        "pdbx_PDB_model_num",
    ];
    let items: String = items.iter().map(|item| format!("_atom_site.{item}\n")).collect();
    write!(output, "data_{name}\n#\nloop_\n{items}").map_err(writing)?;
    for atom in atoms {
        let record = if atom.is_hetatm { "HETATM" } else { "ATOM" };
        let number = atom.number.map_or("?".to_string(), |number| number.to_string());
        let value = atom.value.map_or("?".to_string(), |value| format!("{value:.3}"));
        let [x, y, z] = atom.at;
        let [atom_name, residue, chain] = [atom.name, atom.residue, atom.chain].map(quoted);
        let [symbol, altloc, subchain, code] =
            [atom.element, atom.altloc, atom.subchain, atom.insertion_code].map(quoted);
        writeln!(
            output,
            "{record} {} {symbol} {atom_name} {altloc} {residue} {subchain} . {code} {x:.3} {y:.3} {z:.3} {:.2} \
             {value} {number} {residue} {chain} {atom_name} {model}",
            atom.serial, atom.occupancy
        )
        .map_err(writing)?;
    }
    output.write_all(b"#\n").map_err(writing)
}

/// A text as a value of CIF: quoted where it would be something else; a point if it is empty.
fn quoted(text: &str) -> Cow<'_, str> {
    let lower = text.to_ascii_lowercase();
    let is_word = ["loop_", "stop_", "global_"].contains(&&lower[..])
        || lower.starts_with("data_")
        || lower.starts_with("save_");
    let is_plain = !is_word
        && !matches!(text, "." | "?")
        && !text.starts_with(['_', '#', '$', '\'', '"', '[', ']', ';'])
        && !text.contains([' ', '\t']);
    match text {
        "" => Cow::Borrowed("."),
        _ if is_plain && !text.contains(['\'', '"']) => Cow::Borrowed(text),
        // A quote ends where a blank follows.
        _ if !text.contains("\" ") => Cow::Owned(format!("\"{text}\"")),
        _ if !text.contains("' ") => Cow::Owned(format!("'{text}'")),
        // A field of lines; the line before ends first.
        _ => Cow::Owned(format!("\n;{text}\n;")),
    }
}

fn writing(cause: std::io::Error) -> Error {
    Error::io("writing atoms", cause)
}
