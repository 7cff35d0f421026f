//! mmCIF: the syntax of CIF, and which items of `_atom_site` are taken.

use spmesh_base::error::ErrorKind;

use super::assert_fails;
use super::structure::{atoms, read};

/// A data block with one loop of atoms.
fn block(tags: &str, rows: &str) -> String {
    let tags: String = tags.split(' ').map(|tag| format!("_atom_site.{tag}\n")).collect();
    format!("data_test\nloop_\n{tags}{rows}\n")
}

const PLACE: &str = "Cartn_x Cartn_y Cartn_z";

#[test]
fn columns_may_be_in_any_order_and_any_case() {
    let tags = "Cartn_z b_iso_or_equiv AUTH_SEQ_ID id cartn_x Group_PDB pdbx_PDB_ins_code auth_asym_id \
                auth_comp_id \
                Cartn_y auth_atom_id type_symbol label_alt_id occupancy pdbx_PDB_model_num other";
    let text = block(tags, "3 20 -5 7 1.25 HETATM C AA HEM 2 FE Fe B 0.5 4 ?");
    assert_eq!(atoms(&read(text).unwrap()), ["4 7 FE* Fe B AA HEM -5C 0.5 1250 2000 3000"]);
}

#[test]
fn names_of_the_authors_come_before_those_of_the_archive() {
    let tags = format!(
        "{PLACE} id auth_atom_id label_atom_id auth_comp_id label_comp_id auth_asym_id label_asym_id \
         auth_seq_id \
         label_seq_id"
    );
    let rows = "1 2 3 1 A1 L1 A2 L2 A3 L3 4 5\n1 2 3 2 ? L1 . L2 ? L3 . 5\n1 2 3 3 ? ? ? ? ? ? ? ?";
    let structure = read(block(&tags, rows)).unwrap();
    assert_eq!(
        atoms(&structure),
        [
            "1 1 A1 - - A3 A2 4 1 1000 2000 3000",
            "1 2 L1 - - L3 L2 5 1 1000 2000 3000",
            "1 3 - - - - - - 1 1000 2000 3000"
        ]
    );
    assert!(structure.warnings.is_empty());
}

#[test]
fn values_may_be_quoted_and_run_over_lines() {
    let tags = format!("{PLACE} id auth_atom_id auth_asym_id label_alt_id");
    let rows = "1.5(3) # comment\n 2\t'3' 1 \"O5'\" 'a b' .\n\
                1 2 3 2 'it''s'\n;x'\n; '.'\n\
                1 2 3 3 O#5'\n;\n; ?";
    let structure = read(block(&tags, rows)).unwrap();
    assert_eq!(
        atoms(&structure),
        [
            "1 1 O5' O - a b - - 1 1500 2000 3000",
            "1 2 it''s I . x' - - 1 1000 2000 3000",
            "1 3 O#5' O - - - - 1 1000 2000 3000"
        ]
    );
}

#[test]
fn text_fields_hide_what_is_in_them() {
    let hidden =
        "_a.b\n;data_x\nloop_\n'unclosed\n_atom_site.Cartn_x\n;\n_a.c ';' # ;\nsave_frame\n_a.d 1\nsave_\n";
    let text = block(PLACE, "1 2 3\n").replacen("loop_", &format!("{hidden}loop_"), 1);
    let structure = read(text.replace('\n', "\r\n")).unwrap();
    assert_eq!(structure.models[0].points, [[1000.0, 2000.0, 3000.0]]);
}

#[test]
fn an_atom_needs_no_loop() {
    let text = "data_a\n_atom_site.id 7\n_atom_site.Cartn_x 1 _atom_site.Cartn_y 2\n_atom_site.Cartn_z\n3\n_cell.a 1\n";
    assert_eq!(atoms(&read(text).unwrap()), ["1 7 - - - - - - 1 1000 2000 3000"]);
    let without = text.replace("_atom_site.Cartn_y 2", "");
    assert_fails(read(without), ErrorKind::Malformed, &["no Cartn_x, Cartn_y or Cartn_z"]);
}

#[test]
fn atoms_of_models_may_be_mixed() {
    let tags = format!("{PLACE} id pdbx_PDB_model_num");
    let structure = read(block(&tags, "1 2 3 1 5\n1 2 3 2 9\n1 2 3 3 5\n1 2 3 4 ?\n1 2 3 x 9")).unwrap();
    let models: Vec<(i64, Vec<u64>)> = structure
        .models
        .iter()
        .map(|model| (model.number, model.atoms.iter().map(|atom| atom.serial).collect()))
        .collect();
    assert_eq!(models, [(5, vec![1, 3, 4]), (9, vec![2, 3])]);
    assert_eq!(structure.warnings.len(), 1, "{:?}", structure.warnings);
}

#[test]
fn the_first_block_with_atoms_is_read() {
    let one = block(PLACE, "1 2 3");
    let text = format!("data_empty\n_cell.a 1\n{one}{}{}", block(PLACE, "4 5 6"), block(PLACE, "7 8 9"));
    let structure = read(text).unwrap();
    assert_eq!(structure.models[0].points, [[1000.0, 2000.0, 3000.0]]);
    assert!(structure.warnings[0].contains("2 more data blocks"), "{:?}", structure.warnings);
}

#[test]
fn what_is_broken_is_named_with_line_and_column() {
    let tags = format!("{PLACE} auth_atom_id");
    let cases: [(String, &[&str]); 15] = [
        (block(&tags, "1 2 3 C\n4 5 x C"), &["line 8, column 5", "\"x\"", "a number for Cartn_z"]),
        (block(&tags, "1 2 3 C\n4 ? 6 C"), &["line 8, column 3", "\"?\"", "Cartn_y"]),
        (block(&tags, "1 2 3 C\n4 nan 6 C"), &["line 8, column 3", "\"nan\"", "Cartn_y"]),
        (block(&tags, "1 2 3 C\n4 5 6"), &["ends after 3 of 4 values"]),
        (
            block(&tags, "1 2 3 C\n4 5 6\n#\nloop_\n_a.b\n1"),
            &["line 10, column 1", "ends after 3 of 4 values"],
        ),
        (block(&tags, "1 2 3 'C\n"), &["line 7, column 8", "quotation has no end"]),
        (block(&tags, "1 2 3\n;C\n4 5 6 C\n"), &["truncated", "starts in line 8"]),
        (block("Cartn_x Cartn_y id", "1 2 3"), &["no tag Cartn_z"]),
        (block("Cartn_x Cartn_y Cartn_z Cartn_x", "1 2 3 4"), &["line 6, column 1", "a second time"]),
        (block(PLACE, "1 2 3\nloop_\n_atom_site.id\n1"), &["_atom_site a second time"]),
        (format!("{}5", block("a b", "1 2\n_c.d 4 ")), &["has no tag Cartn_x"]),
        ("data_a\n_cell.a 1 2\n".into(), &["line 2, column 11", "\"2\"", "a tag"]),
        ("data_a\n_cell.a\n_cell.b 1\n".into(), &["line 3, column 1", "has no value"]),
        ("data_a\nloop_\n1\n".into(), &["line 3, column 1", "without tags"]),
        ("data_a\nglobal_\n".into(), &["line 2, column 1", "global_"]),
    ];
    for (text, parts) in cases {
        assert_fails(read(&text), ErrorKind::Malformed, &[&["input: "], parts].concat());
    }
    let core = "data_a\nloop_\n_atom_site_label\n_atom_site_fract_x\nC1 0.5\n";
    assert_fails(read(core), ErrorKind::Malformed, &["core dictionary", "convert"]);
    let control = block(&tags, "1 2 3\n;C\nD\n;\n");
    assert_fails(read(control), ErrorKind::Malformed, &["auth_atom_id in printable characters"]);
    let old_mac = block(PLACE, "1 2 3").replace('\n', "\r");
    assert_fails(read(old_mac), ErrorKind::Malformed, &["carriage return"]);
}

#[test]
fn a_file_that_may_be_cut_off_is_told() {
    let text = block("Cartn_x Cartn_y id Cartn_z", "1 2 3 4");
    assert!(read(&text).unwrap().warnings.is_empty());
    assert!(read(format!("{text}#")).unwrap().warnings.is_empty());
    let warnings = read(text.trim_end()).unwrap().warnings;
    assert!(warnings[0].contains("cut off"), "{warnings:?}");
}

#[test]
fn long_lines_are_read() {
    let sequence = "A".repeat(1 << 20);
    let text =
        block(PLACE, "1 2 3").replacen("loop_", &format!("_entity_poly.sequence {sequence}\nloop_"), 1);
    assert_eq!(read(text).unwrap().models[0].points.len(), 1);
}
