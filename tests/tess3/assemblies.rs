//! Biological assemblies.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::mesh::Mesh;
use super::molecules::{Rows, cloud, pdb};
use crate::programs::{outcome, run};

/// Points of a mesh by their labels.
fn points(arguments: &[&str], text: &str) -> BTreeMap<u64, [i64; 3]> {
    let output = run("tess3", &[arguments, &["-"]].concat(), text.as_bytes());
    assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    let mesh = Mesh::read(&output.stdout);
    assert_eq!(mesh.merged, 0);
    mesh.labels.into_iter().zip(mesh.points).collect()
}

fn failure(assembly: &str, text: &str) -> (Option<i32>, String) {
    outcome(&run("tess3", &["--assembly", assembly, "-"], text.as_bytes()))
}

/// Operators by their names: the identity, and steps of 100 Å along x, y and z.
const OPERATORS: &str = "\
loop_
_pdbx_struct_oper_list.id
_pdbx_struct_oper_list.matrix[1][1]
_pdbx_struct_oper_list.matrix[1][2]
_pdbx_struct_oper_list.matrix[1][3]
_pdbx_struct_oper_list.vector[1]
_pdbx_struct_oper_list.matrix[2][1]
_pdbx_struct_oper_list.matrix[2][2]
_pdbx_struct_oper_list.matrix[2][3]
_pdbx_struct_oper_list.vector[2]
_pdbx_struct_oper_list.matrix[3][1]
_pdbx_struct_oper_list.matrix[3][2]
_pdbx_struct_oper_list.matrix[3][3]
_pdbx_struct_oper_list.vector[3]
1 1 0 0 0    0 1 0 0    0 0 1 0
2 1 0 0 100  0 1 0 0    0 0 1 0
3 1 0 0 0    0 1 0 100  0 0 1 0
P 1 0 0 0    0 1 0 0    0 0 1 100
Q 0 -1 0 0   1 0 0 0    0 0 1 0
X ? ? ? ?    0 1 0 0    0 0 1 0
";

/// Ten atoms of subchain A, which the authors call U, and ten of subchain B, of theirs too.
fn mmcif(generators: &[[&str; 3]]) -> String {
    mmcif_of(20, generators)
}

/// The same with `atoms` atoms; all but ten are of subchain B.
fn mmcif_of(atoms: u32, generators: &[[&str; 3]]) -> String {
    let mut text = "data_test\nloop_\n_pdbx_struct_assembly_gen.assembly_id\n\
                    _pdbx_struct_assembly_gen.oper_expression\n_pdbx_struct_assembly_gen.asym_id_list\n"
        .to_string();
    for [assembly, expression, subchains] in generators {
        writeln!(text, "{assembly} '{expression}'\n;{subchains}\n;").unwrap();
    }
    text += OPERATORS;
    text += "loop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.label_atom_id\n_atom_site.label_asym_id\n\
             _atom_site.auth_asym_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";
    for (i, atom) in cloud(atoms, 9_000, 60).iter().enumerate() {
        let [x, y, z] = atom.at;
        let subchain = if i < 10 { 'A' } else { 'B' };
        writeln!(text, "ATOM {} CA {subchain} U {x:.3} {y:.3} {z:.3}", i + 1).unwrap();
    }
    text
}

/// The steps of the copies of atom 1 and of atom 11, copy by copy.
fn steps(generators: &[[&str; 3]], assembly: &str) -> [Vec<[i64; 3]>; 2] {
    let text = mmcif(generators);
    let (before, after) = (points(&[], &text), points(&["--assembly", assembly], &text));
    [1, 11].map(|serial| {
        let copies = after.iter().filter(|(label, _)| (*label - 1) % 20 + 1 == serial);
        let step = |point: &[i64; 3]| [0, 1, 2].map(|axis| (point[axis] - before[&serial][axis]) / 1000);
        copies.map(|(_, point)| step(point)).collect()
    })
}

#[test]
fn operators_are_listed_ranges_and_products() {
    let [o, x, y, z] = [[0, 0, 0], [100, 0, 0], [0, 100, 0], [0, 0, 100]];
    let sum = |a: [i64; 3], b: [i64; 3]| [0, 1, 2].map(|axis| a[axis] + b[axis]);
    let both = "A,B";
    let cases: [(&str, Vec<[i64; 3]>); 7] = [
        ("1", vec![o]),
        ("2", vec![x]),
        ("1,2,3", vec![o, x, y]),
        ("(1-3)", vec![o, x, y]),
        ("P, 1-2", vec![z, o, x]),
        ("(1,2)(1,3)", vec![o, y, x, sum(x, y)]),
        ("(1-3) (P)", vec![z, sum(x, z), sum(y, z)]),
    ];
    for (expression, expected) in cases {
        let found = steps(&[["1", expression, both]], "1");
        assert_eq!(found, [expected.clone(), expected], "{expression}");
    }
}

/// The first factor moves last: a step along x, then the turn from x to y.
#[test]
fn the_right_operator_of_a_product_moves_first() {
    let text = mmcif(&[["1", "(Q)(2)", "A"]]);
    let (before, after) = (points(&[], &text), points(&["--assembly", "1"], &text));
    for (label, [x, y, z]) in after {
        let [a, b, c] = before[&label];
        assert_eq!([x, y, z], [-b, a + 100_000, c]);
    }
}

#[test]
fn an_operator_moves_the_chains_of_all_its_generators() {
    let generators = [["1", "1,2", "A"], ["2", "3", "B"], ["1", "2", "B, C"]];
    let [o, x, y] = [[0, 0, 0], [100, 0, 0], [0, 100, 0]];
    assert_eq!(steps(&generators, "1"), [vec![o, x], vec![x]]);
    assert_eq!(steps(&generators, "2"), [vec![], vec![y]]);
    let text = mmcif(&generators);
    // Both subchains are of chain U, so a copy of B belongs to the copy of A by the same operator.
    let output = run("tess3", &["--assembly", "1", "--chain", "U-2", "--table", "-"], text.as_bytes());
    let rows = Rows::new(&String::from_utf8(output.stdout).unwrap());
    assert!((0..rows.len()).all(|row| rows.text(row, "atom1").starts_with("U-2/")));
    assert_eq!(points(&["--assembly", "1", "--chain", "U-2"], &text).len(), 20);
    assert_eq!(points(&["--assembly", "1", "--chain", "U"], &text).len(), 10);
}

/// A chain of the file may have the name that a copy would have.
#[test]
fn copies_have_names_of_their_own() {
    let text = mmcif(&[["1", "1-3", "A,B"]]).replace(" CA B U ", " CA B U-2 ");
    let flags = ["--assembly", "1", "--sasa", "--radii", "bondi", "--per", "chain", "-"];
    let output = run("tess3", &flags, text.as_bytes());
    let rows = Rows::new(&String::from_utf8(output.stdout).unwrap());
    let chains: Vec<&str> = (0..rows.len()).map(|row| rows.text(row, "chain")).collect();
    assert_eq!(chains, ["U", "U-2", "U-3", "U-2-2", "U-4", "U-2-3"]);
    assert!((0..6).all(|row| rows.text(row, "atoms") == "10"));
}

#[test]
fn a_missing_assembly_is_an_error_that_lists_those_there_are() {
    let text = mmcif(&[["1", "1", "A"], ["PAU", "1", "B"], ["1", "2", "B"]]);
    let (code, message) = failure("3", &text);
    assert_eq!(code, Some(2));
    assert!(message.contains("has no assembly \"3\", only 1, PAU"), "{message}");
    let (code, message) = failure("1", &pdb(&cloud(5, 9_000, 61)));
    assert_eq!(code, Some(2));
    assert!(message.contains("states no assembly"), "{message}");
    let (code, message) = failure("1", &mmcif(&[["1", "1", "C"]]));
    assert_eq!(code, Some(2));
    assert!(message.contains("has no atom of the assembly"), "{message}");
}

#[test]
fn malformed_operators_are_errors() {
    let cases = [
        ("7", "\"7\" of an assembly is missing"),
        ("1-7", "\"4\" of an assembly is missing"),
        ("X", "twelve numbers"),
        ("1,,2", "expected such as"),
        ("", "expected such as"),
        ("(1", "expected such as"),
        ("(1)2(3)", "expected such as"),
        ("((1))", "expected such as"),
        ("1-18446744073709551615", "maximum"),
        (
            "(1,1,1,1,1,1,1,1)(1,1,1,1,1,1,1,1)(1,1,1,1,1,1,1,1)(1,1,1,1,1,1,1,1)(1,1,1,1,1,1,1,1)\
          (1,1,1,1,1,1,1,1)",
            "maximum",
        ),
    ];
    for (expression, words) in cases {
        let (code, message) = failure("1", &mmcif(&[["1", expression, "A"]]));
        assert_eq!(code, Some(3), "{expression}: {message}");
        assert!(message.contains(words), "{expression}: {message}");
    }
}

#[test]
fn equal_operators_make_one_copy_and_all_operators_are_limited() {
    let twelve = "(1,1,1,1,1,1,1,1,1,1,1,2)";
    let text = mmcif_of(40, &[["1", &twelve.repeat(3), "B"]]);
    // Equal operators make one copy.
    assert_eq!(points(&["--assembly", "1"], &text).len(), 30 * 4);
    let (code, message) = failure("1", &mmcif_of(40, &[["1", &twelve.repeat(4), "B"]]));
    assert_eq!(code, Some(3), "{message}");
    assert!(message.contains("more than 16384 operators"), "{message}");
}

#[test]
fn pdb_files_state_assemblies_in_remarks() {
    let mut atoms = cloud(15, 9_000, 62);
    atoms[5..10].iter_mut().for_each(|atom| atom.chain = 'B');
    atoms[10..].iter_mut().for_each(|atom| atom.chain = 'C');
    let remark = "\
REMARK 350 COORDINATES FOR A COMPLETE MULTIMER REPRESENTING THE KNOWN
REMARK 350 BIOMOLECULE: 1
REMARK 350 AUTHOR DETERMINED BIOLOGICAL UNIT: TETRAMERIC
REMARK 350 APPLY THE FOLLOWING TO CHAINS: A,
REMARK 350                    AND CHAINS: B
REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000
REMARK 350   BIOMT1   2 -1.000000  0.000000  0.000000       25.00050
REMARK 350   BIOMT2   2  0.000000 -1.000000  0.000000      -30.00000
REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        0.25000
REMARK 350 BIOMOLECULE: 2
REMARK 350 APPLY THE FOLLOWING TO CHAINS: C
REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000
";
    let text = remark.to_string() + &pdb(&atoms);
    let before = points(&[], &text);
    let after = points(&["--assembly", "1"], &text);
    assert_eq!(after.len(), 20);
    for (label, &[x, y, z]) in &after {
        let [a, b, c] = before[&((label - 1) % 150 + 1)];
        // 25.0005 Å is no multiple of 0.001 Å; halves are rounded away from zero.
        let away = i64::from(25_000 - a >= 0);
        let moved = if *label > 150 { [25_000 - a + away, -30_000 - b, c + 250] } else { [a, b, c] };
        assert_eq!([x, y, z], moved);
    }
    assert_eq!(
        points(&["--assembly", "2"], &text).into_keys().collect::<Vec<_>>(),
        [110, 120, 130, 140, 150]
    );
    let (_, message) = failure("3", &text);
    assert!(message.contains("only 1, 2"), "{message}");
}

/// Half of the atoms of 1PFE are those of the file, and half are moved by its crystallographic dyad.
#[test]
fn the_assembly_of_an_entry() {
    let output = run("tess3", &["--assembly", "1", "tests/data/1pfe.cif.gz"], b"");
    assert!(output.status.success(), "{:?}", outcome(&output));
    let mesh = Mesh::read(&output.stdout);
    let by_label: BTreeMap<u64, [i64; 3]> = mesh.labels.iter().copied().zip(mesh.points.clone()).collect();
    let greatest = 342;
    let mut moved = 0;
    for (label, point) in by_label.range(greatest + 1..) {
        let Some([x, y, z]) = by_label.get(&(label - greatest)).map(|p| p.map(|value| value as f64)) else {
            continue;
        };
        let expected = [-0.5 * x - 0.866_025_403_8 * y, -0.866_025_403_8 * x + 0.5 * y, -z];
        assert!((0..3).all(|axis| (point[axis] as f64 - expected[axis]).abs() <= 0.501), "{label}");
        moved += 1;
    }
    assert!(moved > 280, "{moved}");
}

/// An mmCIF file of `atoms` atoms with `(1-N)(1-N)` of `N` operators, which all move differently.
fn products(atoms: usize, operators: usize) -> String {
    let (head, names) = OPERATORS.split_at(OPERATORS.find("1 1 0").expect("the first operator"));
    assert!(names.starts_with("1 1 0"));
    let mut text = format!(
        "data_test\nloop_\n_pdbx_struct_assembly_gen.assembly_id\n_pdbx_struct_assembly_gen.oper_expression\n\
         _pdbx_struct_assembly_gen.asym_id_list\n1 '(1-{operators})(1-{operators})' A\n{head}"
    );
    for i in 1..=operators {
        let [x, y] = if i % 2 == 0 { [i, 0] } else { [0, i * i] };
        writeln!(text, "{i} 1 0 0 {x} 0 1 0 {y} 0 0 1 {}", i * i * i).unwrap();
    }
    text += "loop_\n_atom_site.id\n_atom_site.label_asym_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";
    (0..atoms).for_each(|i| writeln!(text, "{i} A {i} {} {}", i % 7, i % 5).unwrap());
    text
}

#[test]
fn a_few_atoms_do_not_become_millions() {
    for (atoms, is_refused) in [(1, false), (200, true)] {
        let text = products(atoms, 40);
        let output = run("tess3", &["--assembly", "1", "--table", "-"], text.as_bytes());
        let (code, message) = outcome(&output);
        assert_eq!(code == Some(3), is_refused, "{message}");
        assert_eq!(message.contains("leave out --assembly"), is_refused, "{message}");
    }
}
