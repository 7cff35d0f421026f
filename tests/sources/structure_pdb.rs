//! PDB: what programs write, and what is refused.

use spmesh_base::error::ErrorKind;

use super::structure::{atoms, read};
use super::{assert_fails, sample};

/// The line of an atom: columns 1 to 30 as given, and fixed coordinates.
fn atom(start: &str) -> String {
    format!("{start:30}   1.000   2.000   3.000  1.00  0.00           C  \n")
}

/// The first atom of a file with this line, as `atoms` prints it, without the coordinates.
fn first(line: &str) -> String {
    let found = atoms(&read(line).unwrap_or_else(|error| panic!("{error}: {line:?}")));
    found[0].strip_suffix(" 1000 2000 3000").expect("the usual place").to_string()
}

#[test]
fn columns_are_read_whatever_ends_the_line() {
    let whole = "ATOM      7 HG21AILE B  -5C      1.000   2.000   3.000  0.25 20.00           H1+\n";
    let cases = [
        (whole.to_string(), "1 7 HG21 H A B ILE -5C 0.25"),
        (whole.replace('\n', "\r\n"), "1 7 HG21 H A B ILE -5C 0.25"),
        (whole.to_lowercase(), "1 7 hg21 H a b ile -5c 0.25"),
        (whole.replace("ATOM  ", "HETATM"), "1 7 HG21* H A B ILE -5C 0.25"),
        (whole[..54].to_string() + "\n", "1 7 HG21 H A B ILE -5C 1"),
        (whole[..59].to_string() + "\n", "1 7 HG21 H A B ILE -5C 0.2"),
        (whole[..77].to_string() + "\n", "1 7 HG21 H A B ILE -5C 0.25"),
        (whole[..78].to_string() + "\n", "1 7 HG21 H A B ILE -5C 0.25"),
        // Columns 73 to 80 in files of the 1990s: the code of the entry and the number of the line.
        (whole[..66].to_string() + "      1ABC  87\n", "1 7 HG21 H A B ILE -5C 0.25"),
        ("\u{feff}".to_string() + whole, "1 7 HG21 H A B ILE -5C 0.25"),
    ];
    for (line, expected) in cases {
        assert_eq!(first(&line), expected, "{line:?}");
    }
}

#[test]
fn numbers_beyond_their_columns_are_understood() {
    let cases = [
        ("ATOM  99999  CA  ALA A   1", "1 99999 CA C - A ALA 1 1"),
        ("ATOM  A0000  CA  ALA A   1", "1 100000 CA C - A ALA 1 1"),
        ("ATOM  ZZZZZ  CA  ALA A   1", "1 43770015 CA C - A ALA 1 1"),
        ("ATOM  a0000  CA  ALA A   1", "1 43770016 CA C - A ALA 1 1"),
        ("ATOM  zzzzz  CA  ALA A   1", "1 87440031 CA C - A ALA 1 1"),
        ("ATOM  186a0  CA  ALA A   1", "1 100000 CA C - A ALA 1 1"),
        ("ATOM  123456 CA  ALA A   1", "1 123456 CA C - A ALA 1 1"),
        ("HETATM123456 CA  ALA A   1", "1 123456 CA* C - A ALA 1 1"),
        ("ATOM 1234567 CA  ALA A   1", "1 1234567 CA C - A ALA 1 1"),
        ("ATOM      1  CA  ALA A9999", "1 1 CA C - A ALA 9999 1"),
        ("ATOM      1  CA  ALA AA000", "1 1 CA C - A ALA 10000 1"),
        ("ATOM      1  CA  ALA Aa000", "1 1 CA C - A ALA 1223056 1"),
        ("ATOM      1  CA  ALA A270f", "1 1 CA C - A ALA 9999 1"),
        ("ATOM      1  CA  ALA A 12A", "1 1 CA C - A ALA - 1"),
        ("ATOM      1  CA  ALA A-999", "1 1 CA C - A ALA -999 1"),
        ("ATOM      1  CA  ALA A12345", "1 1 CA C - A ALA 12345 1"),
        ("ATOM      1  OH2 TIP3 10000", "1 1 OH2 C - - TIP3 10000 1"),
        ("ATOM      1  OH2 TIP3W1", "1 1 OH2 C - W TIP3 1 1"),
        ("ATOM      1  CA  ALA A  12A", "1 1 CA C - A ALA 12A 1"),
        ("ATOM      1  CA", "1 1 CA C - - - - 1"),
    ];
    for (start, expected) in cases {
        assert_eq!(first(&atom(start)), expected, "{start:?}");
    }
}

#[test]
fn hexadecimal_numbers_go_on_until_the_next_model() {
    let serials = ["99999", "186a0", "186a1", "18700", "a0000"];
    let lines: String =
        serials.iter().map(|serial| atom(&format!("ATOM  {serial}  CA  ALA A   1"))).collect();
    let structure = read(format!("MODEL        1\n{lines}ENDMDL\nMODEL        2\n{lines}")).unwrap();
    let serials = |model: usize| structure.models[model].atoms.iter().map(|atom| atom.serial);
    assert!(serials(0).eq([99999, 100000, 100001, 100096, 655360]));
    assert!(serials(1).eq(serials(0)));
}

#[test]
fn what_cannot_be_read_is_counted_on_and_said() {
    let lines = [
        atom("ATOM  99999  CA  ALA A   1"),
        atom("ATOM  *****  CA  ALA A****"),
        atom("ATOM         CA  ALA A   2").replace("1.00  0.00", " inf  0.00"),
    ];
    let structure = read(lines.concat()).unwrap();
    let found = atoms(&structure);
    assert!(found[1].starts_with("1 100000 CA C - A ALA - 1 "), "{found:?}");
    assert!(found[2].starts_with("1 100001 CA C - A ALA 2 1 "), "{found:?}");
    let expected = [
        "2 serial numbers cannot be read, the first in line 2",
        "1 residue numbers cannot be read, the first in line 2",
        "1 occupancies are no numbers, the first in line 3",
    ];
    for (warning, expected) in structure.warnings.iter().zip(expected) {
        assert!(warning.starts_with(expected), "{warning}");
    }
    assert_eq!(structure.warnings.len(), expected.len());
}

#[test]
fn models_end_where_they_may() {
    let one = atom("ATOM      1  CA  ALA A   1");
    let cases: [(String, &[i64], usize); 9] = [
        (one.clone(), &[1], 0),
        (format!("MODEL        7\n{one}ENDMDL\nEND\n"), &[7], 0),
        (format!("MODEL        7\n{one}END\nENDMDL\nMODEL 8\n{one}"), &[7, 8], 0),
        (format!("MODEL 0\n{one}MODEL 1\n{one}"), &[0, 1], 0),
        (format!("MODEL     1\n{one}ENDMDL\nEND\nMODEL     1\n{one}ENDMDL\nEND\n"), &[1, 1], 0),
        (format!("MODEL\n{one}ENDMDL\n"), &[1], 1),
        (format!("{one}END\n{one}{one}END\n"), &[1, 2], 1),
        (format!("MODEL        3\n{one}ENDMDL\n{one}"), &[3, 4], 1),
        (format!("MODEL        1\nENDMDL\nMODEL        2\n{one}ENDMDL\n"), &[2], 0),
    ];
    for (text, expected, warnings) in cases {
        let structure = read(&text).unwrap();
        let numbers: Vec<i64> = structure.models.iter().map(|model| model.number).collect();
        assert_eq!((numbers.as_slice(), structure.warnings.len()), (expected, warnings), "{text}");
    }
}

#[test]
fn places_that_are_not_certain_are_refused() {
    let start = "ATOM      1  CA  ALA A   1    ";
    let cases = [
        ("     NaN   2.000   3.000", &["\"     NaN\"", "x in columns 31 to 38"][..]),
        ("   1.000     inf   3.000", &["\"     inf\"", "y in columns 39 to 46"]),
        ("   1.000   2.000********", &["\"********\"", "z in columns 47 to 54"]),
        ("   1.000           3.000", &["\"        \"", "y in columns 39 to 46"]),
        ("   1.000   2.000   3,000", &["z in columns"]),
        // Coordinates one column too far to the right, and two.
        ("     1.000   2.000   3.000", &["y in columns"]),
        ("   26.981  53.977  40.085", &["y in columns"]),
        ("   1.000   2.000   3.00", &["ends after column 53", "z in columns 47 to 54"]),
        ("   1.000   2.000", &["ends after column 46", "z in columns 47 to 54"]),
        ("", &["ends after column 30", "x in columns 31 to 38"]),
        ("   1.00010000.000   3.000", &["line 2", "columns 47 to 54"]),
        (" 12345.6712345.6712345.67", &["y in columns"]),
        ("12345.6712345.6712345.67", &["run over their columns", "y in columns 39 to 46", "mmCIF"]),
        ("   1.000   2.000 12345.61.00", &["run over their columns", "z in columns 47 to 54"]),
        ("1\t2\t3\t                   ", &["x in columns"]),
    ];
    for (place, parts) in cases {
        let text = format!("REMARK\n{start}{place}\n");
        assert_fails(read(&text), ErrorKind::Malformed, &[&["input: line 2: "], parts].concat());
    }
    let far = format!("{}1234.567   2.000   3.000\n", start.replace("    ", "   -"));
    assert_fails(read(far), ErrorKind::Malformed, &["run over", "x in columns 31 to 38"]);
    let touching = format!("{start}1234.5671234.567-123.456100.00\n");
    assert_eq!(read(touching).unwrap().models[0].points, [[1234567.0, 1234567.0, -123456.0]]);
    let one = atom("ATOM      1  CA  ALA A   1");
    assert_fails(read(one.replace("ALA", "\u{c4}L")), ErrorKind::Malformed, &["byte 0xc3 in column 18"]);
    let old_mac = format!("REMARK\r{}", one.replace('\n', "\r"));
    assert_fails(read(old_mac), ErrorKind::Malformed, &["line 1", "carriage return"]);
}

#[test]
fn a_file_that_may_be_cut_off_is_told() {
    let one = atom("ATOM      1  CA  ALA A   1");
    assert_eq!(read(format!("{one}END")).unwrap().warnings.len(), 0);
    let warnings = read(one.trim_end()).unwrap().warnings;
    assert!(warnings[0].contains("cut off"), "{warnings:?}");
}

#[test]
fn other_records_are_passed_over() {
    let one = atom("ATOM      1  CA  ALA A   1");
    let text = format!(
        "REMARK \u{e9}\nANISOU    1  CA  ALA A   1      640   1000   1160    345   -225   -118       C  \n\
         SIGATM    1  CA  ALA A   1       0.1\n{one}TER\nATOMS\nENDED\nMODELS\nMASTER\nEND   \n"
    );
    let structure = read(text).unwrap();
    assert_eq!(structure.models[0].atoms.len(), 1);
    assert!(structure.warnings.is_empty());
}

#[test]
fn a_file_that_ends_in_the_name_of_a_record_is_cut() {
    let whole = std::fs::read(sample("1aki.pdb")).unwrap();
    let atom = whole.windows(5).rposition(|window| window == b"\nATOM").unwrap() + 1;
    for len in 1..4 {
        assert_fails(read(&whole[..atom + len]), ErrorKind::Malformed, &["truncated", "inside of a record"]);
    }
    assert!(read([&whole[..atom], b"END"].concat()).unwrap().warnings.is_empty());
}
