//! The contents of mesh streams, checked by exact predicates that share no code with the program.

use std::collections::HashMap;

use spmesh_stream::{Coordinates, Event, Kind, StreamReader};

use super::molecules::{Record, cloud, models, numbers, pdb};
use crate::programs::{Folder, outcome, run};

/// A mesh as read from a stream.
pub struct Mesh {
    pub points: Vec<[i64; 3]>,
    pub labels: Vec<u64>,
    pub tetrahedra: Vec<[usize; 4]>,
    pub merged: u64,
    pub patches: usize,
    /// The greatest number of live vertices.
    pub width: usize,
    pub producer: String,
}

impl Mesh {
    /// Reads a stream of integer coordinates; each vertex must be finalized once, and not be used after that.
    pub fn read(bytes: &[u8]) -> Mesh {
        let mut reader = StreamReader::new(bytes, "mesh").unwrap();
        let header = reader.header().clone();
        assert_eq!(header.kind, Kind::TetrahedralMesh);
        assert_eq!((header.dims, header.has_elevation), (3, false));
        assert!(matches!(header.coordinates, Coordinates::I32 { .. } | Coordinates::F64));
        let mut mesh = Mesh {
            points: Vec::new(),
            labels: Vec::new(),
            tetrahedra: Vec::new(),
            merged: 0,
            patches: 0,
            width: 0,
            producer: header.producer,
        };
        let mut is_final: Vec<bool> = Vec::new();
        let mut live = 0;
        let mut stored: Vec<[f64; 3]> = Vec::new();
        while let Some(event) = reader.next_event().unwrap() {
            match event {
                Event::Patch(patch) => {
                    mesh.patches += 1;
                    stored.extend(&patch.new);
                    mesh.points.extend(patch.new.iter().map(|point| point.map(|value| value as i64)));
                    is_final.resize(mesh.points.len(), false);
                    for tetrahedron in patch.tetrahedra() {
                        let ids = tetrahedron.map(|local| patch.id(local) as usize);
                        assert!(ids.iter().all(|&id| !is_final[id]));
                        mesh.tetrahedra.push(ids);
                    }
                    live += patch.new.len();
                    mesh.width = mesh.width.max(live);
                    live -= patch.finalized.len();
                    for &local in &patch.finalized {
                        let id = patch.id(local) as usize;
                        assert!(!std::mem::replace(&mut is_final[id], true));
                    }
                }
                Event::Labels(labels) => mesh.labels.extend(labels),
                Event::End(totals) => mesh.merged = totals.merged,
                other => panic!("{other:?}"),
            }
        }
        assert!(is_final.iter().all(|&is_final| is_final));
        assert!(mesh.labels.len() == mesh.points.len() || mesh.labels.is_empty());
        if let Some(bounds) = header.bounds {
            for axis in 0..3 {
                let values = || stored.iter().map(|point| point[axis]);
                assert_eq!(values().fold(f64::INFINITY, f64::min), bounds.min[axis]);
                assert_eq!(values().fold(f64::NEG_INFINITY, f64::max), bounds.max[axis]);
            }
        }
        mesh
    }

    /// The tetrahedra as labels, sorted.
    pub fn by_label(&self) -> Vec<[u64; 4]> {
        let sorted = |ids: &[usize; 4]| {
            let mut labels = ids.map(|id| self.labels[id]);
            labels.sort_unstable();
            labels
        };
        let mut all: Vec<_> = self.tetrahedra.iter().map(sorted).collect();
        all.sort_unstable();
        all
    }

    /// Proves that this is a Delaunay triangulation of its vertices: every tetrahedron is positively oriented
    /// and has no vertex inside its sphere, and every facet belongs to two tetrahedra or lies on the hull.
    pub fn prove(&self) {
        let mut facets: HashMap<[usize; 3], Vec<usize>> = HashMap::new();
        for t in &self.tetrahedra {
            let corners = t.map(|id| self.points[id]);
            assert!(orientation(corners) > 0, "{t:?}");
            for (id, &point) in self.points.iter().enumerate() {
                assert!(t.contains(&id) || in_sphere(corners, point) <= 0, "{id} is inside of {t:?}");
            }
            for side in 0..4 {
                let mut facet: Vec<usize> = (0..4).filter(|&i| i != side).map(|i| t[i]).collect();
                facet.sort_unstable();
                facets.entry(facet.try_into().unwrap()).or_default().push(t[side]);
            }
        }
        for (facet, opposite) in facets {
            let [a, b, c] = facet.map(|id| self.points[id]);
            let side = |id: usize| orientation([a, b, c, self.points[id]]).signum();
            match opposite[..] {
                [inner] => assert!((0..self.points.len()).all(|id| side(id) != -side(inner))),
                [one, other] => assert_eq!(side(one), -side(other)),
                _ => panic!("{} tetrahedra at a facet", opposite.len()),
            }
        }
    }
}

type Point = [i64; 3];

fn from(origin: Point, point: Point) -> [i128; 3] {
    std::array::from_fn(|axis| i128::from(point[axis] - origin[axis]))
}

fn determinant([a, b, c]: [[i128; 3]; 3]) -> i128 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// det(b - a, c - a, d - a).
pub fn orientation([a, b, c, d]: [Point; 4]) -> i128 {
    determinant([b, c, d].map(|point| from(a, point)))
}

/// Positive if `e` is inside the sphere of a positively oriented tetrahedron. Evaluates cofactors of the
/// lifts of the differences to `e`.
fn in_sphere(corners: [Point; 4], e: Point) -> i128 {
    let rows = corners.map(|point| from(e, point));
    let lift = |row: [i128; 3]| row.iter().map(|value| value * value).sum::<i128>();
    let [a, b, c, d] = rows;
    lift(a) * determinant([b, c, d]) - lift(b) * determinant([a, c, d]) + lift(c) * determinant([a, b, d])
        - lift(d) * determinant([a, b, c])
}

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
    let mut random = spmesh_core::random::Random::new(4);
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
