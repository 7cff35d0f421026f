//! The contents of mesh streams.

use super::mesh::{Mesh, in_sphere, orientation};
use super::molecules::{Record, cloud, models, numbers, pdb};
use crate::programs::{Folder, outcome, run};

fn mesh_of(text: &str, arguments: &[&str]) -> Mesh {
    let output = run("tess3", &[arguments, &["-"]].concat(), text.as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    Mesh::read(&output.stdout)
}

#[test]
fn the_in_sphere_test_of_these_tests_has_the_right_sign() {
    let corners = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]];
    assert!(orientation(corners) > 0);
    assert!(in_sphere(corners, [1, 1, 1]) > 0);
    assert!(in_sphere(corners, [2, 2, 2]) == 0);
    assert!(in_sphere(corners, [3, 2, 2]) < 0);
}

#[test]
fn a_cloud_of_atoms_becomes_its_delaunay_triangulation_with_serial_numbers() {
    let atoms = cloud(300, 9_000, 1);
    let mesh = mesh_of(&pdb(&atoms), &[]);
    mesh.prove();
    let mut labels = mesh.labels.clone();
    labels.sort_unstable();
    assert_eq!(labels, (1..=300).map(|i| 10 * i).collect::<Vec<u64>>());
    for (point, label) in mesh.points.iter().zip(&mesh.labels) {
        let atom = &atoms[*label as usize / 10 - 1];
        assert_eq!(atom.at.map(|value| (value * 1000.0).round() as i64), *point);
    }
}

#[test]
fn lattices_become_delaunay_triangulations() {
    let lattice = (0..125).map(|i| Record::carbon(i + 1, [i % 5, i / 5 % 5, i / 25].map(f64::from)));
    let mesh = mesh_of(&pdb(&lattice.collect::<Vec<_>>()), &[]);
    mesh.prove();
    let volume: i128 = mesh.tetrahedra.iter().map(|t| orientation(t.map(|id| mesh.points[id]))).sum();
    assert_eq!(volume, 6 * 4000i128.pow(3));
}

#[test]
fn points_without_names_are_labelled_with_their_numbers() {
    let mut number = numbers(3, 1000);
    let points: Vec<[u64; 3]> = (0..50).map(|_| [number(), number(), number()]).collect();
    let text: String = points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    let mesh = mesh_of(&text, &[]);
    mesh.prove();
    for (point, &label) in mesh.points.iter().zip(&mesh.labels) {
        assert_eq!(points[label as usize - 1].map(|value| value as i64), *point);
    }
}

#[test]
fn coinciding_atoms_are_one_vertex_with_the_first_serial_number() {
    let mut atoms = cloud(30, 9_000, 4);
    atoms.push(Record { serial: 999, ..atoms[7].clone() });
    let output = run("tess3", &["-"], pdb(&atoms).as_bytes());
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(0));
    assert!(message.contains("1 of 31 points coincides with an earlier one"), "{message}");
    let mesh = Mesh::read(&output.stdout);
    mesh.prove();
    assert_eq!((mesh.points.len(), mesh.merged), (30, 1));
    assert!(mesh.labels.contains(&80) && !mesh.labels.contains(&999));
}

#[test]
fn flat_structures_are_all_vertices_with_a_notice() {
    let in_plane = |i: u32| Record::carbon(i, [f64::from(i % 7), f64::from(i / 7), 1.0]);
    let on_line = |i: u32| Record::carbon(i, [f64::from(i), 0.0, 1.0]);
    let plane: Vec<Record> = (1..=40).map(in_plane).collect();
    let line: Vec<Record> = (1..=40).map(on_line).collect();
    for (atoms, count, reason) in [
        (&plane[..], 40, "in a plane"),
        (&line, 40, "in a plane"),
        (&line[..3], 3, "fewer than four"),
        (&line[..1], 1, "fewer than four"),
    ] {
        let output = run("tess3", &["-"], pdb(atoms).as_bytes());
        let (code, message) = outcome(&output);
        assert_eq!(code, Some(0), "{message}");
        assert!(message.contains("no tetrahedra") && message.contains(reason), "{message}");
        let mesh = Mesh::read(&output.stdout);
        assert_eq!((mesh.points.len(), mesh.tetrahedra.len()), (count, 0));
        let quiet = run("tess3", &["-q", "-"], pdb(atoms).as_bytes());
        assert_eq!(outcome(&quiet), (Some(0), String::new()));
        for table in ["--table", "--contacts"] {
            let output = run("tess3", &[table, "-"], pdb(atoms).as_bytes());
            assert_eq!(output.stdout.iter().filter(|&&byte| byte == b'\n').count(), 1);
        }
    }
}

#[test]
fn long_meshes_come_in_patches() {
    let text: String = cloud(30_000, 90_000, 5).iter().map(|atom| format!("{:?}\n", atom.at)).collect();
    let mesh = mesh_of(&text.replace(['[', ']'], ""), &[]);
    assert_eq!(mesh.points.len() as u64 + mesh.merged, 30_000);
    assert!(mesh.patches > 20, "{} patches", mesh.patches);
    // Along the curve few vertices are in use at a time.
    assert!(mesh.width < 12_000, "{} live vertices", mesh.width);
}

#[test]
fn the_bytes_of_a_mesh_do_not_depend_on_the_number_of_threads() {
    let mut random = spmesh_base::random::Random::new(4);
    // Multiples of a tenth, so that many points are cospherical, and some coincide.
    let mut line = || {
        let [x, tenths, y, z] = [60, 10, 60, 60].map(|bound| random.below(bound));
        format!("{x}.{tenths} {y} {z}.5\n")
    };
    let text: String = (0..70_000).map(|_| line()).collect();
    let mesh = |threads| {
        let output = run("tess3", &["--from", "points", "-q", "--threads", threads, "-"], text.as_bytes());
        assert_eq!(outcome(&output).0, Some(0), "{}", outcome(&output).1);
        output.stdout
    };
    let expected = mesh("1");
    for threads in ["2", "3", "8"] {
        assert!(mesh(threads) == expected, "{threads} threads");
    }
}

#[test]
fn one_model_is_chosen_by_its_number_and_the_first_by_default() {
    let text = models(&[cloud(20, 9_000, 6), cloud(30, 9_000, 7), cloud(40, 9_000, 8)]);
    assert_eq!(mesh_of(&text, &[]).points.len(), 20);
    assert_eq!(mesh_of(&text, &["--model", "2"]).points.len(), 30);
    let (code, message) = outcome(&run("tess3", &["--model", "4", "-"], text.as_bytes()));
    assert_eq!(code, Some(2));
    assert!(message.contains("1, 2, 3"), "{message}");
    let (code, message) = outcome(&run("tess3", &["--model", "all", "-"], text.as_bytes()));
    assert_eq!(code, Some(2));
    assert!(message.contains("--out-dir"), "{message}");
    let folder = Folder::new();
    let output = run("tess3", &["--model", "all", "--out-dir", &folder.path("out"), "-"], text.as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    let expected = ["stdin.model1.spm", "stdin.model2.spm", "stdin.model3.spm", "summary.tsv"];
    assert_eq!(folder.names("out"), expected);
    let third = std::fs::read(folder.path("out/stdin.model3.spm")).unwrap();
    assert_eq!(Mesh::read(&third).points.len(), 40);
}
