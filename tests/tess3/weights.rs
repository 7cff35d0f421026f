//! Meshes of atoms as balls: in memory, streamed, audited, and damaged.

use std::collections::BTreeSet;

use spmesh_stream::{Event, Header, StreamReader, StreamWriter};

use super::mesh::Mesh;
use crate::programs::{Folder, outcome, run};

const FILES: [&str; 4] = ["1aki.cif", "1l2y.pdb.gz", "1pfe.cif.gz", "altloc.cif"];

fn done(name: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(name, arguments, input);
    assert!(output.status.success(), "{name} {arguments:?}: {:?}", outcome(&output));
    output.stdout
}

/// The corners of the tetrahedra.
fn set(mesh: &Mesh) -> BTreeSet<[[i64; 3]; 4]> {
    let corners = |ids: &[usize; 4]| {
        let mut corners = ids.map(|id| mesh.points[id]);
        corners.sort_unstable();
        corners
    };
    mesh.tetrahedra.iter().map(corners).collect()
}

#[test]
fn the_stream_and_the_memory_give_one_regular_mesh() {
    let folder = Folder::new();
    for file in FILES {
        let path = format!("tests/data/{file}");
        for radii in [&["--radii", "protor"][..], &["--radii", "bondi", "--probe", "1.4"]] {
            let of_tess3 = done("tess3", &[&[&path[..]], radii].concat(), b"");
            let points = done("spfinalize", &[&["--octree", &path], radii].concat(), b"");
            let of_pipe = done("spdelaunay3d", &["--weights", "-"], &points);
            let [a, b] = [&of_tess3, &of_pipe].map(|bytes| Mesh::read(bytes));
            assert_eq!(set(&a), set(&b), "{file} {radii:?}");
            assert_eq!(a.points.len(), b.points.len(), "{file} {radii:?}");
            for mesh in [&of_tess3, &of_pipe] {
                let mesh = folder.write("mesh.spm", mesh);
                let report = done("spinfo", &["--audit", "--points", &path, &mesh], b"");
                let report = String::from_utf8(report).unwrap();
                assert!(report.contains("weighted     yes"), "{report}");
            }
            let plain = Mesh::read(&done("tess3", &[&path], b""));
            assert_ne!(set(&a), set(&plain), "{file}: radii make a difference");
        }
    }
}

#[test]
fn weights_of_atoms_are_squares_of_radii_in_steps() {
    let mesh =
        done("tess3", &["tests/data/1aki.pdb", "--chain", "A", "--radii", "protor", "--probe", "1.4"], b"");
    let mut reader = StreamReader::new(&mesh[..], "mesh").unwrap();
    let weights = reader.header().weights().expect("a mesh with weights");
    // Carbons of the greatest radius, 1.88 Å, with the probe.
    assert_eq!(weights.greatest(), 3280.0 * 3280.0);
    while let Some(event) = reader.next_event().unwrap() {
        if let Event::Patch(_) = event {
            let is_known = |weight: f64| (weight.sqrt() / 10.0).fract() == 0.0 && weight >= 2820.0 * 2820.0;
            assert!(weights.read(reader.rows()).all(is_known));
        }
    }
}

/// The stream with the weight of its first vertex changed.
fn with_another_weight(mesh: &[u8]) -> Vec<u8> {
    let mut reader = StreamReader::new(mesh, "mesh").unwrap();
    let mut writer = StreamWriter::new(Vec::new(), Header { ..reader.header().clone() }).unwrap();
    let mut is_first = true;
    while let Some(event) = reader.next_event().unwrap() {
        match event {
            Event::Patch(patch) => {
                let mut rows = reader.rows().to_vec();
                if std::mem::take(&mut is_first) {
                    rows[..8].copy_from_slice(&1e3f64.to_le_bytes());
                }
                writer.patch_with_rows(&patch, &rows).unwrap();
            }
            Event::Labels(labels) => writer.labels(&labels).unwrap(),
            Event::End(totals) => return writer.end(totals.points, totals.merged).unwrap(),
            other => panic!("{other:?} in a mesh"),
        }
    }
    panic!("a mesh without an end");
}

#[test]
fn the_audit_finds_a_wrong_weight() {
    let folder = Folder::new();
    let mesh = done("tess3", &["tests/data/1aki.pdb", "--radii", "bondi"], b"");
    let wrong = folder.write("wrong.spm", with_another_weight(&mesh));
    let (code, message) = outcome(&run("spinfo", &["--audit", &wrong], b""));
    assert_eq!(code, Some(4), "{message}");
    let mesh = folder.write("mesh.spm", mesh);
    let (code, message) = outcome(&run("spinfo", &["--audit", "--count-violations", &mesh], b""));
    assert_eq!(code, Some(2), "{message}");
}

#[test]
fn weights_of_attributes_give_the_same_mesh_as_radii() {
    let folder = Folder::new();
    // The fifth is on the hull, and hides the last.
    let balls: [[f64; 4]; 6] = [
        [0.0, 0.0, 0.0, 1.0],
        [6.0, 0.0, 0.0, 2.0],
        [0.0, 6.0, 0.0, 2.0],
        [0.0, 0.0, 6.0, 1.0],
        [2.0, 2.0, 2.0, 4.0],
        [1.5, 2.0, 2.0, 0.5],
    ];
    let rows = |exponent: i32| -> String {
        let row = |[x, y, z, r]: &[f64; 4]| format!("{x} {y} {z} {}\n", r.powi(exponent));
        "# x y z size\n".to_string() + &balls.iter().map(row).collect::<String>()
    };
    let [radii, weights] =
        [("radii.xyz", 1), ("weights.xyz", 2)].map(|(name, exponent)| folder.write(name, rows(exponent)));
    let mesh = |arguments: &[&str]| {
        let points = done("spfinalize", &[&["--octree", "--attributes", "size"], arguments].concat(), b"");
        done("spdelaunay3d", &["--weights", "-"], &points)
    };
    let [a, b] = [mesh(&["--radii", "size", &radii]), mesh(&["--weights", "size", &weights])];
    assert_eq!(set(&Mesh::read(&a)), set(&Mesh::read(&b)));
    assert_eq!((Mesh::read(&a).points.len(), Mesh::read(&a).tetrahedra.len()), (6, 3));
    let report = done("spinfo", &["--audit", &folder.write("a.spm", a)], b"");
    assert!(String::from_utf8(report).unwrap().contains("no weight is above 16 "));
}

#[test]
fn flags_that_do_not_fit_are_refused() {
    let folder = Folder::new();
    let points = folder.write("points.xyz", "# x y z size weight\n0 0 0 1 1\n1 0 0 -2 2\n");
    let pdb = "tests/data/1aki.pdb";
    for (name, arguments, code, words) in [
        ("spfinalize", &["--radii", "protor", pdb][..], 2, "--octree"),
        ("spfinalize", &["--octree", "--probe", "1", pdb], 2, "--radii"),
        ("spfinalize", &["--octree", "--radii", "protor", &points], 2, "tables of radii are for atoms"),
        ("spfinalize", &["--octree", "--radii", "mass", &points], 2, "mass"),
        ("spfinalize", &["--octree", "--radii", "size", &points], 3, "point 2: -2, expected a radius"),
        ("spfinalize", &["--octree", "--radii", "size", "--attributes", "weight", &points], 2, "already"),
        (
            "spfinalize",
            &["--octree", "--radii", "size", "--weights", "size", &points],
            2,
            "cannot be used with",
        ),
        ("tess3", &[pdb, "--radii", "protor", "--alpha", "4"], 2, "--alpha does not go with --radii"),
        ("tess3", &[pdb, "--radii", "protor", "--table"], 2, "--radii"),
        ("tess3", &[pdb, "--probe", "1"], 2, "--probe needs --radii"),
        ("tess3", &[&points, "--radii", "protor"], 2, "have no elements"),
        (
            "spdelaunay3d",
            &["--weights", "--partial", "--region", "0,0,0,1,1,1", "-"],
            2,
            "cannot be used with",
        ),
    ] {
        let (found, message) = outcome(&run(name, arguments, b""));
        assert_eq!(found, Some(code), "{name} {arguments:?}: {message}");
        assert!(message.contains(words), "{name} {arguments:?}: {message}");
    }
    let plain = done("spfinalize", &["--octree", pdb], b"");
    let (code, message) = outcome(&run("spdelaunay3d", &["--weights", "-"], &plain));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("have no weights"), "{message}");
    let weighted = done("spfinalize", &["--octree", "--radii", "protor", pdb], b"");
    let output = run("spdelaunay3d", &["-"], &weighted);
    assert!(outcome(&output).1.contains("the points have weights"), "{:?}", outcome(&output));
    assert_eq!(set(&Mesh::read(&output.stdout)), set(&Mesh::read(&done("tess3", &[pdb], b""))));
}

#[test]
fn no_points_have_no_weights() {
    let flags = ["--octree", "--skip-invalid", "--radii", "size", "-"];
    let points = done("spfinalize", &flags, b"# x y z size\nnan 0 0 1\n");
    let mesh = done("spdelaunay3d", &["--weights", "-"], &points);
    done("spinfo", &["--audit", "-"], &mesh);
}

#[test]
fn weights_of_a_stream_can_be_kept() {
    let folder = Folder::new();
    let flags = ["--octree", "--radii", "bondi", "--probe", "1.4", "tests/data/1pfe.cif.gz"];
    let points = folder.write("points.spm", done("spfinalize", &flags, b""));
    let again = done("spfinalize", &["--octree", "--weights", "weight", "--cell-points", "50", &points], b"");
    let [a, b] = [std::fs::read(&points).unwrap(), again].map(|points| {
        let mesh = done("spdelaunay3d", &["--weights", "-"], &points);
        done("spinfo", &["--audit", "-"], &mesh);
        mesh
    });
    assert_eq!(set(&Mesh::read(&a)), set(&Mesh::read(&b)));
    let greatest = |mesh: &[u8]| StreamReader::new(mesh, "mesh").unwrap().header().weighted;
    assert_eq!(greatest(&a), greatest(&b), "exact, whatever the unit");
}
