//! Structures in streaming pipes, and meshes that become points again.

use std::collections::BTreeSet;

use super::mesh::Mesh;
use super::molecules::{Rows, cloud, models, pdb};
use crate::programs::{Folder, outcome, run};

fn done(name: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(name, arguments, input);
    assert!(output.status.success(), "{name} {arguments:?}: {:?}", outcome(&output));
    output.stdout
}

#[test]
fn spfinalize_reads_the_atoms_that_tess3_takes_by_default() {
    let folder = Folder::new();
    for file in ["1aki.pdb", "1aki.cif", "1l2y.pdb.gz", "1pfe.cif.gz", "altloc.cif"] {
        let path = format!("tests/data/{file}");
        let points = done("spfinalize", &["--octree", &path], b"");
        let mesh = folder.write("mesh.spm", done("spdelaunay3d", &["-"], &points));
        done("spinfo", &["--audit", "--points", &path, &mesh], b"");
        let mut of_tess3 = Mesh::read(&done("tess3", &[&path], b"")).points;
        let mut of_pipe = Mesh::read(&done("tess3", &[&mesh], b"")).points;
        of_tess3.sort_unstable();
        of_pipe.sort_unstable();
        assert_eq!(of_tess3, of_pipe, "{file}");
    }
}

#[test]
fn spfinalize_says_which_atoms_it_leaves_out() {
    let mut twice = cloud(12, 9_000, 70);
    (twice[0].altloc, twice[1].altloc) = ('A', 'B');
    twice[1].number = twice[0].number;
    let text = models(&[twice.clone(), twice]);
    let output = run("spfinalize", &["--octree", "-"], text.as_bytes());
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("first of 2 models"), "{message}");
    assert!(message.contains("1 atom at another alternate location is left out"), "{message}");
    let (code, message) = outcome(&run("spfinalize", &["--octree", "-"], b"ATOM  none\n"));
    assert_eq!(code, Some(3), "{message}");
    assert!(message.contains("line 1"), "{message}");
}

#[test]
fn an_audit_compares_a_mesh_with_the_atoms_of_a_file() {
    let folder = Folder::new();
    let mesh = folder.write("mesh.spm", done("tess3", &["tests/data/1aki.cif"], b""));
    for twin in ["1aki.cif", "1aki.pdb"] {
        done("spinfo", &["--audit", "--points", &format!("tests/data/{twin}"), &mesh], b"");
    }
    let other = folder.write("other.pdb", pdb(&cloud(170, 9_000, 71)));
    let (code, message) = outcome(&run("spinfo", &["--audit", "--points", &other, &mesh], b""));
    assert_ne!(code, Some(0), "{message}");
}

/// Pairs of serial numbers, each with the rest of its row.
fn contacts(table: Vec<u8>) -> BTreeSet<(u64, u64, String, String)> {
    let rows = Rows::new(&String::from_utf8(table).unwrap());
    let row = |row| {
        let [a, b] = ["serial1", "serial2"].map(|column| rows.text(row, column).parse::<u64>().unwrap());
        let [distance, count] = ["distance", "tetrahedra"].map(|column| rows.text(row, column).to_string());
        (a.min(b), a.max(b), distance, count)
    };
    (0..rows.len()).map(row).collect()
}

#[test]
fn meshes_become_points_with_their_labels() {
    let folder = Folder::new();
    let path = "tests/data/1aki.pdb";
    let mesh = folder.write("mesh.spm", done("tess3", &[path, "--chain", "A"], b""));
    let of_file = contacts(done("tess3", &[path, "--contacts", "--alpha", "4"], b""));
    assert_eq!(contacts(done("tess3", &[&mesh, "--contacts", "--alpha", "4"], b"")), of_file);
    let twin = folder.write("twin.txt", done("spconvert", &["--to", "text", &mesh], b""));
    assert_eq!(contacts(done("tess3", &[&twin, "--contacts", "--alpha", "4"], b"")), of_file);
    let (before, again) =
        (std::fs::read(&mesh).unwrap(), done("tess3", &["-"], &std::fs::read(&mesh).unwrap()));
    assert_eq!(Mesh::read(&before).by_label(), Mesh::read(&again).by_label());
    assert_eq!(Mesh::read(&again).labels.len(), 170);
}

/// The mesh of `spdelaunay3d` has no labels: vertices are counted.
#[test]
fn meshes_without_labels_become_points_that_are_counted() {
    let points = done("spfinalize", &["--octree", "-"], b"0 0 0\n9 0 0\n0 9 0\n0 0 9\n5 5 5\n9 0 0\n");
    let mesh = done("spdelaunay3d", &["-"], &points);
    let output = run("tess3", &["-"], &mesh);
    let mut labels = Mesh::read(&output.stdout).labels;
    labels.sort_unstable();
    assert_eq!(labels, [1, 2, 3, 4, 5]);
    let (_, message) = outcome(&output);
    assert!(message.contains("1 coinciding points are one with others"), "{message}");
    let cut = &mesh[..mesh.len() - 30];
    let (code, message) = outcome(&run("tess3", &["-"], cut));
    assert_eq!(code, Some(3), "{message}");
}

#[test]
fn files_of_other_programs_are_recognized() {
    for (bytes, words) in [
        (&b"\x1f\x9d\x90abc\0"[..], "uncompress -c"),
        (b"\x83\xa7encoder\xa5mol*\0", "byte 15: truncated"),
        (b"\x81\xaadataBlocks\x90", "found no atom"),
        (b"\0\0\x07\xcb\0\0\0\x02", "an XTC trajectory of GROMACS"),
        (b"\x54\0\0\0CORD\x01\0\0\0", "--top FILE"),
        (b"water\n1\n    1SOL     OW    1   0.560   0.049   0.540\n", "expected the vectors of the box"),
        (b"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\n", "LAMMPS"),
    ] {
        let (code, message) = outcome(&run("tess3", &["-"], bytes));
        assert_eq!(code, Some(3), "{message}");
        assert!(message.contains(words), "{message}");
    }
}
