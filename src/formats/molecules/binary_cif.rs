//! Reads BinaryCIF: the categories of mmCIF as encoded columns, in a map of MessagePack.

use std::io::Read;

use crate::drivers::AnyInput;
use crate::molecules::binary_columns::BinaryColumn;
use crate::molecules::builder::StructureBuilder;
use crate::molecules::mmcif::{CATEGORY, Item, Row, finish, item_of};
use crate::molecules::mmcif_tables::{Tables, column};
use crate::molecules::msgpack::Value;
use crate::text::lines::Lines;
use spmesh_base::error::{Error, Result};

/// Rows that a small file may state: an encoding may repeat a value. Others take a byte each.
const ROWS_FREE: u64 = 1 << 16;

/// Reads the atoms of the first data block that has any. Memory: the file, and its columns.
pub(crate) fn read(mut lines: Lines<AnyInput>, builder: &mut StructureBuilder) -> Result<()> {
    let mut bytes = Vec::new();
    lines.input().read_to_end(&mut bytes).map_err(|e| Error::io("reading", e))?;
    let file = Value::read(&bytes)?;
    let mut blocks = 0;
    for block in file.items("dataBlocks")? {
        let categories = block.items("categories")?;
        let is_atoms = |category: &&Value<'_>| category.text("name").is_ok_and(is_category);
        let Some(atoms) = categories.iter().find(is_atoms) else { continue };
        blocks += 1;
        if blocks > 1 {
            continue;
        }
        let mut tables = Tables::default();
        for category in categories {
            read_table(category, bytes.len() as u64, &mut tables)?;
        }
        tables.give(builder);
        read_atoms(atoms, bytes.len() as u64, builder).map_err(|e| e.at("_atom_site"))?;
    }
    finish(blocks, builder);
    Ok(())
}

/// Whether this is the name of the category of atoms.
fn is_category(name: &str) -> bool {
    CATEGORY.strip_suffix(b".").is_some_and(|category| name.as_bytes().eq_ignore_ascii_case(category))
}

/// The number of rows of a category in a file of so many bytes.
fn rows_of(category: &Value<'_>, bytes: u64) -> Result<usize> {
    let rows = category.integer("rowCount")?;
    let found = u64::try_from(rows).ok().filter(|&rows| rows <= bytes.max(ROWS_FREE));
    let found = found.and_then(|rows| usize::try_from(rows).ok());
    found.ok_or_else(|| {
        Error::malformed(format!("found {rows} as the number of rows in a file of {bytes} bytes"))
    })
}

/// Reads the columns of a category that are used.
fn columns<'b, T>(
    category: &Value<'b>,
    rows: usize,
    wanted: impl Fn(&str) -> Option<T>,
) -> Result<Vec<(T, BinaryColumn<'b>)>> {
    let mut columns = Vec::new();
    for column in category.items("columns")? {
        let name = column.text("name")?;
        let Some(found) = wanted(name) else { continue };
        let values = BinaryColumn::read(column, rows).map_err(|e| e.at(format!("column {name}")))?;
        columns.push((found, values));
    }
    Ok(columns)
}

fn read_table(category: &Value<'_>, bytes: u64, tables: &mut Tables) -> Result<()> {
    let name = category.text("name")?;
    let rows = rows_of(category, bytes)?;
    let columns = columns(category, rows, |item| column(format!("{name}.{item}").as_bytes()))?;
    let Some(&(first, _)) = columns.first() else { return Ok(()) };
    let mut text = Vec::new();
    for row in 0..rows {
        tables.start_row(first);
        for (column, values) in columns.iter().filter(|(_, values)| values.has(row)) {
            values.text(row, &mut text)?;
            tables.set(*column, &text);
        }
    }
    Ok(())
}

fn read_atoms(category: &Value<'_>, bytes: u64, builder: &mut StructureBuilder) -> Result<()> {
    let rows = rows_of(category, bytes)?;
    let columns = columns(category, rows, |item| item_of(item.as_bytes()))?;
    let (mut atom, mut text) = (Row::default(), Vec::new());
    for row in 0..rows {
        for (item, values) in columns.iter().filter(|(_, values)| values.has(row)) {
            if matches!(item, Item::X | Item::Y | Item::Z) {
                atom.set_place(*item, values.number(row));
            } else {
                values.text(row, &mut text)?;
                atom.set(*item, &text);
            }
        }
        let number = row as u64 + 1;
        atom.push_to(builder, number).map_err(|e| e.at(format!("row {number} of _atom_site")))?;
        atom.clear();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::path::Path;

    use crate::molecules::{Structure, read_structure, read_structure_from};
    use spmesh_base::random::Random;

    const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/");

    /// All that is read of atoms and residues, and the assemblies.
    fn content(structure: &Structure) -> String {
        let text = |name| structure.names.text(name);
        let atoms = structure.models[0].atoms.iter().zip(&structure.models[0].points).map(|(atom, point)| {
            let residue = structure.residues[atom.residue as usize];
            let names =
                [atom.name, atom.element, atom.altloc, residue.chain, residue.name, residue.insertion_code];
            let numbers = (residue.number, residue.chain_number, residue.class, text(residue.subchain));
            format!(
                "{} {point:?} {:?} {numbers:?} {} {}\n",
                atom.serial,
                names.map(text),
                atom.occupancy,
                atom.is_hetatm
            )
        });
        let assemblies = structure.assemblies.names().join(" ");
        let assembled = structure.clone().assembled("1").unwrap().models[0].points.len();
        atoms.collect::<String>() + &format!("{:?} {assemblies} {assembled}", structure.coordinates)
    }

    #[test]
    fn a_file_of_biotite_has_the_atoms_of_its_mmcif() {
        let read = |name: &str| read_structure(&Path::new(DATA).join(name), None).unwrap();
        let (binary, text) = (read("1pfe.bcif"), read("1pfe.cif.gz"));
        assert_eq!(content(&binary), content(&text));
        assert_eq!(binary.warnings, text.warnings);
    }

    /// The reader returns, whatever the bytes are.
    #[test]
    fn damaged_files_are_errors() {
        const MUTANTS: usize = 2000;
        let whole = std::fs::read(Path::new(DATA).join("1pfe.bcif")).unwrap();
        let (mut random, mut failed) = (Random::new(66), 0);
        for _ in 0..MUTANTS {
            let mut mutant = whole.clone();
            for _ in 0..1 + random.bits() % 8 {
                let place = random.bits() as usize % mutant.len();
                mutant[place] = if random.bits() % 2 == 0 { random.bits() as u8 } else { 0xff };
            }
            if random.bits() % 8 == 0 {
                mutant.truncate(random.bits() as usize % mutant.len());
            }
            failed += usize::from(read_structure_from(Cursor::new(mutant), "in", None).is_err());
        }
        assert!(failed > MUTANTS / 4, "{failed}");
    }
}
