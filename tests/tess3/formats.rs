//! Tables in other formats than text: the same rows, and the same rules for names.

use std::fs;

use serde_json::Value;

use super::molecules::Rows;
use crate::programs::{Folder, assert_outcome, outcome, run, sample};

/// Flags of each kind of table.
const TABLES: [&[&str]; 15] = [
    &["--table"],
    &["--contacts", "--alpha", "3"],
    &["--sasa", "--volumes"],
    &["--sasa", "--per", "residue"],
    &["--contact-areas"],
    &["--contact-areas", "--per", "residue"],
    &["--pockets", "--probe", "0"],
    &["--pockets", "--probe", "0", "--per", "atom"],
    &["--pockets", "--mouths", "--probe", "0"],
    &["--pockets", "--mouths", "--probe", "0", "--per", "residue"],
    &["--ses", "--probe", "1.4"],
    &["--sasa", "--per", "residue", "--classes", "polymer", "--by-kind", "--relative", "tien"],
    &["--sasa", "--volumes", "--gradients"],
    &["--buried-areas", "--between", "A:1-5"],
    &["--buried-areas", "--between", "A:1-5", "--per", "atom"],
];

/// The table of a sample in a format: the content of the file.
fn made(flags: &[&str], ending: &str) -> Vec<u8> {
    let folder = Folder::new();
    let path = folder.path(&format!("t.{ending}"));
    let output = run("tess3", &[flags, &["-q", &sample("1aki.pdb"), "-o", &path]].concat(), &[]);
    assert_eq!(outcome(&output).0, Some(0), "{flags:?}: {:?}", outcome(&output));
    fs::read(path).unwrap()
}

/// A field of text, as JSON would have it.
fn value(field: &str) -> Value {
    serde_json::from_str(field).unwrap_or_else(|_| Value::from(field))
}

/// The rows of a table of text, as JSON would have them.
fn expected(flags: &[&str]) -> (Vec<String>, Vec<Vec<Value>>) {
    let text = String::from_utf8(made(flags, "tsv")).unwrap();
    let mut lines = text.lines().map(|line| line.split('\t').map(str::to_string).collect::<Vec<_>>());
    let columns = lines.next().unwrap();
    (columns, lines.map(|line| line.iter().map(|field| value(field)).collect()).collect())
}

#[test]
fn json_lines_have_the_rows_of_text() {
    for flags in TABLES {
        let (columns, rows) = expected(flags);
        assert!(!rows.is_empty(), "{flags:?}");
        let text = String::from_utf8(made(flags, "jsonl")).unwrap();
        assert_eq!(text.lines().count(), rows.len());
        for (line, row) in text.lines().zip(&rows) {
            let object: Value = serde_json::from_str(line).unwrap();
            let fields: Vec<Value> = columns.iter().map(|column| object[column].clone()).collect();
            assert_eq!(&fields, row, "{flags:?}");
            assert_eq!(object.as_object().unwrap().len(), columns.len());
        }
    }
}

#[test]
fn names_tell_the_format_unless_a_flag_does() {
    let text = "C 0 0 0\nC 4 0 0\nC 0 4 0\nC 0 0 4\n".replace('C', "");
    let folder = Folder::new();
    let file = folder.write("four.xyz", text);
    let lines = run("tess3", &["--table", "--format", "jsonl", &file], &[]);
    let text = String::from_utf8(lines.stdout.clone()).unwrap();
    let start = format!("{{\"file\":\"{file}\",\"model\":1,\"atom1\":\"1\",");
    assert!(text.starts_with(&start), "{text}");
    let path = folder.path("t.txt");
    assert_eq!(outcome(&run("tess3", &["--table", "--format", "jsonl", &file, "-o", &path], &[])).0, Some(0));
    assert_eq!(fs::read(&path).unwrap(), lines.stdout);
    let wrong: [(&[&str], &str); 4] = [
        (&["--format", "jsonl"], "--format goes with tables"),
        (&["--filtration", "--format", "jsonl"], "--format goes with tables"),
        (&["--table", "--format", "jsonl", "-o", "t.tsv"], "the name is that of tsv, but --format is jsonl"),
        (&["--table", "-o", "t.json"], ".jsonl, .ndjson or .parquet"),
    ];
    for (flags, part) in wrong {
        assert_outcome("tess3", &[flags, &[&file[..]]].concat(), &[], 2, part);
    }
}

#[test]
fn a_sweep_has_tables_of_the_format_asked_for() {
    let folder = Folder::new();
    let out = folder.path("out");
    let file = sample("1aki.pdb");
    let flags = ["--contacts", "--alpha", "3", "--format", "jsonl", "--out-dir", &out, &file, "--resume"];
    assert!(outcome(&run("tess3", &flags, &[])).1.contains("1 file done;"));
    assert!(outcome(&run("tess3", &flags, &[])).1.contains("1 had been done before"));
    let made = fs::read(folder.path("out/1aki.contacts.jsonl")).unwrap();
    let alone = run("tess3", &["--contacts", "--alpha", "3", "--format", "jsonl", "-q", &file], &[]);
    assert_eq!(made, alone.stdout);
    let others = ["--contacts", "--alpha", "3", "--out-dir", &out, &file, "--resume"];
    assert!(
        outcome(&run("tess3", &others, &[])).1.contains("1 file done;"),
        "another format is another sweep"
    );
    let summary = Rows::new(&fs::read_to_string(folder.path("out/summary.tsv")).unwrap());
    assert_eq!(summary.text(0, "output"), "1aki.contacts.tsv");
    assert_eq!(summary.text(0, "violations"), "", "counted for rounded arithmetic alone");
}

mod parquet {
    use std::fs;

    use serde_json::Value as Json;

    use super::{TABLES, expected, made};
    use crate::programs::{Folder, outcome, run, sample};
    use crate::tess3::molecules::Rows;
    use crate::tess3::parquet_reader::{Field, Value, read};

    fn assert_is(field: &Field, text: &Json) {
        match (field.as_ref().expect("a value"), text) {
            (Value::Number(found), Json::Number(number)) => {
                let number = number.as_f64().unwrap();
                assert!((found - number).abs() <= 1e-8 * number.abs(), "{found}, not {number}");
            }
            (Value::Integer(found), Json::Number(number)) => assert_eq!(Some(*found), number.as_i64()),
            (Value::Text(found), Json::String(text)) => assert_eq!(found, text),
            (found, _) => panic!("{found:?} and {text:?}"),
        }
    }

    #[test]
    fn files_have_the_rows_of_text_with_types() {
        for flags in TABLES {
            let (columns, rows) = expected(flags);
            let found = read(&made(flags, "parquet"));
            assert_eq!(
                found.columns.iter().map(|(name, _)| name).collect::<Vec<_>>(),
                columns.iter().collect::<Vec<_>>()
            );
            assert_eq!(found.rows.len(), rows.len(), "{flags:?}");
            for (found, row) in found.rows.iter().zip(&rows) {
                found.iter().zip(row).for_each(|(field, text)| assert_is(field, text));
            }
        }
    }

    #[test]
    fn a_table_without_rows_has_columns() {
        let table = read(&made(&["--contacts", "--alpha", "0.001"], "parquet"));
        assert_eq!((table.columns.len(), table.rows.len()), (26, 0));
        assert_eq!(table.columns[24], ("distance".to_string(), "DOUBLE"));
        assert_eq!(table.columns[12], ("serial1".to_string(), "INT64"));
    }

    #[test]
    fn many_rows_are_in_groups() {
        let text: String = (0..20_000u64)
            .map(|i| format!("{} {} {}\n", i * i % 7919, i * 31 % 6007, i * 57 % 5003))
            .collect();
        let arguments = ["--contacts", "--format", "parquet", "-"];
        let content = run("tess3", &arguments, text.as_bytes()).stdout;
        let table = read(&content);
        assert!(table.groups.len() > 1);
        let lines = run("tess3", &["--contacts", "-"], text.as_bytes()).stdout;
        let lines = Rows::new(&String::from_utf8(lines).unwrap());
        assert_eq!(table.rows.len(), lines.len());
        for (row, fields) in table.rows.iter().zip(&lines.rows) {
            // Points have no names.
            assert!(row[2].is_none());
            assert_is(&row[12], &fields[12].parse::<i64>().unwrap().into());
            assert_is(&row[24], &fields[24].parse::<f64>().unwrap().into());
        }
    }

    #[test]
    fn a_summary_can_be_resumed() {
        let folder = Folder::new();
        let (out, summary) = (folder.path("out"), folder.path("s.parquet"));
        let bad = folder.write("bad.pdb", "");
        let flags = ["--out-dir", &out, "--summary", &summary, "--resume", &sample("1aki.pdb"), &bad];
        assert_eq!(outcome(&run("tess3", &flags, &[])).0, Some(1));
        let table = read(&fs::read(&summary).unwrap());
        let text = Rows::new(&fs::read_to_string(folder.path("out/summary.tsv")).unwrap());
        assert_eq!((table.rows.len(), table.columns.len()), (2, text.rows[0].len()));
        for (row, fields) in table.rows.iter().zip(&text.rows) {
            for ((field, text), (name, _)) in row.iter().zip(fields).zip(&table.columns) {
                match field {
                    None => assert_eq!(text, "", "{name}"),
                    Some(Value::Text(found)) => assert_eq!(found, text, "{name}"),
                    Some(Value::Integer(found)) => assert_eq!(&found.to_string(), text, "{name}"),
                    Some(Value::Number(found)) => assert_eq!(*found, text.parse::<f64>().unwrap(), "{name}"),
                }
            }
        }
        let (_, message) = outcome(&run("tess3", &flags, &[]));
        assert!(message.contains("1 had been done before") && message.contains("s.parquet"), "{message}");
        assert_eq!(read(&fs::read(&summary).unwrap()).rows.len(), 2);
    }

    #[test]
    fn a_file_of_an_input_that_fails_does_not_appear() {
        let folder = Folder::new();
        let (bad, path) =
            (folder.write("bad.pdb", "ATOM      1  CA  ALA A   1      xx.xxx\n"), folder.path("t.parquet"));
        let (code, _) = outcome(&run("tess3", &["--table", &bad, "-o", &path], &[]));
        assert!(code != Some(0) && !fs::exists(&path).unwrap());
    }
}
