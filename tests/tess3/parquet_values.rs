//! Values, lengths and counts in Parquet that tables of structures hardly have.

use std::fs;
use std::path::Path;

use spmesh_base::output::Output;
use spmesh_formats::sink::{Column, ColumnKind, TableFormat, TableSink};

use super::parquet_reader::{Field, Table, Value, read};
use crate::programs::Folder;

fn text(text: impl Into<String>) -> Field {
    Some(Value::Text(text.into()))
}

fn integer(value: i64) -> Field {
    Some(Value::Integer(value))
}

fn number(value: f64) -> Field {
    Some(Value::Number(value))
}

/// Writes rows of a text, an integer and a number, and reads them.
fn written(rows: &[[Field; 3]]) -> Table {
    let folder = Folder::new();
    let path = folder.path("t.parquet");
    let kinds =
        [("text é", ColumnKind::Text), ("integer", ColumnKind::Integer), ("number", ColumnKind::Number)];
    let columns = kinds.map(|(name, kind)| Column { name: name.to_string(), kind }).to_vec();
    let output = Output::create(Path::new(&path), true).unwrap();
    let mut table = TableSink::create(TableFormat::Parquet, columns, output);
    for row in rows {
        for field in row {
            match field {
                Some(Value::Text(text)) => table.field(text),
                Some(Value::Integer(value)) => table.integer(*value).unwrap(),
                Some(Value::Number(value)) => table.number(*value),
                None => table.nothing(),
            }
        }
        table.end().unwrap();
    }
    table.commit().unwrap();
    read(&fs::read(path).unwrap())
}

/// Compares numbers by their bits, also those that are not numbers.
fn bits(rows: impl IntoIterator<Item = impl AsRef<[Field]>>) -> Vec<Vec<String>> {
    let shown = |field: &Field| match field {
        Some(Value::Number(number)) => format!("{:016x}", number.to_bits()),
        other => format!("{other:?}"),
    };
    rows.into_iter().map(|row| row.as_ref().iter().map(shown).collect()).collect()
}

#[track_caller]
fn assert_round_trip(rows: &[[Field; 3]]) -> Table {
    let table = written(rows);
    assert!(bits(&table.rows) == bits(rows), "the rows read are not those written");
    table
}

#[test]
fn a_file_without_rows_has_no_groups() {
    let table = assert_round_trip(&[]);
    assert!(table.groups.is_empty());
    let expected = [("text é", "BYTE_ARRAY"), ("integer", "INT64"), ("number", "DOUBLE")];
    assert_eq!(table.columns, expected.map(|(name, kind)| (name.to_string(), kind)));
}

#[test]
fn extreme_values_are_kept_to_the_bit() {
    let texts = ["", " ", "Ångström/残基/🧬", "a\0b\n\t\"", "PAR1"];
    let integers = [i64::MIN, i64::MAX, 0, -1, 1];
    let numbers = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, f64::MIN_POSITIVE / 4.0];
    let rows: Vec<[Field; 3]> = texts
        .into_iter()
        .zip(integers)
        .zip(numbers)
        .map(|((t, i), n)| [text(t), integer(i), number(n)])
        .collect();
    assert_round_trip(&rows);
    assert_round_trip(&rows[..1]);
}

#[test]
fn rows_may_lack_any_of_their_values() {
    let all = || [text("x"), integer(7), number(0.5)];
    // Every pattern of three fields, then columns without any value.
    let patterns = (0..64).map(|pattern| {
        let mut row = all();
        (0..3).filter(|column| pattern >> column & 1 == 1).for_each(|column| row[column] = None);
        row
    });
    assert_round_trip(&patterns.collect::<Vec<_>>());
    assert_round_trip(&vec![[None, None, None]; 1000]);
    assert_round_trip(&vec![[None, integer(1), None]; 1]);
    // Runs of all lengths around those that take another byte.
    let runs = (0..400).flat_map(|len| {
        std::iter::repeat_n(if len % 2 == 0 { [None, None, number(1.0)] } else { all() }, len)
    });
    assert_round_trip(&runs.collect::<Vec<_>>());
}

#[test]
fn groups_end_after_rows_and_pages_after_bytes() {
    let row = |i: i64| {
        let name = (i % 3 > 0).then(|| Value::Text(format!("A/LYS/{}/CA", i % 1009)));
        [name, integer(i * i), if i % 1000 < 500 { number(i as f64 / 7.0) } else { None }]
    };
    let table = assert_round_trip(&(0..140_000).map(row).collect::<Vec<_>>());
    assert_eq!(table.groups, [65_536, 65_536, 140_000 - 2 * 65_536]);
    let table = assert_round_trip(&(0..65_536).map(row).collect::<Vec<_>>());
    assert_eq!(table.groups, [65_536], "no empty group at the end");
    // 8 MB of text are a group, about 1 MB are a page.
    let long: Vec<_> = (0..70).map(|i| [text("é".repeat(70_000 + i)), None, number(0.0)]).collect();
    let table = assert_round_trip(&long);
    assert_eq!(table.groups, [60, 10]);
    assert!(table.pages.iter().all(|&len| len < (1 << 20) + 150_000), "{:?}", table.pages);
    assert_eq!(table.pages.len(), 8 + 2 + 2 * 2);
    let short = [text("x"), None, None];
    let longest = [text("y".repeat(20 << 20)), integer(1), None];
    assert_eq!(assert_round_trip(&[short.clone(), longest, short]).groups, [2, 1]);
}
