//! Surfaces, contacts and pockets as meshes, read by a plain reader of PLY, against the tables.

use std::collections::HashMap;

use super::molecules::{Record, Rows, pdb};
use crate::programs::{Folder, assert_outcome, outcome, run, sample};

/// The faces of a binary PLY: their corners, and properties by name.
struct Ply {
    header: String,
    points: Vec<[f64; 3]>,
    faces: Vec<(Vec<usize>, HashMap<String, f64>)>,
}

impl Ply {
    fn read(bytes: &[u8]) -> Ply {
        let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
        let header = String::from_utf8(bytes[..end].to_vec()).unwrap();
        let mut rest = &bytes[end..];
        let mut next = |kind: &str| -> f64 {
            let len = match kind {
                "uchar" => 1,
                "int" | "uint" | "float" => 4,
                _ => 8,
            };
            let (own, after) = rest.split_at(len);
            rest = after;
            match kind {
                "uchar" => f64::from(own[0]),
                "float" => f64::from(f32::from_le_bytes(own.try_into().unwrap())),
                "double" => f64::from_le_bytes(own.try_into().unwrap()),
                _ => f64::from(i32::from_le_bytes(own.try_into().unwrap())),
            }
        };
        let mut elements: Vec<(usize, Vec<Vec<&str>>)> = Vec::new();
        for line in header.lines() {
            let words: Vec<&str> = line.split(' ').collect();
            match words[0] {
                "element" => elements.push((words[2].parse().unwrap(), Vec::new())),
                "property" => elements.last_mut().unwrap().1.push(words[1..].to_vec()),
                _ => {}
            }
        }
        let mut points = Vec::new();
        for _ in 0..elements[0].0 {
            let row: Vec<f64> = elements[0].1.iter().map(|property| next(property[0])).collect();
            points.push([row[0], row[1], row[2]]);
        }
        let mut faces = Vec::new();
        for _ in 0..elements[1].0 {
            let list = &elements[1].1[0];
            assert_eq!((list[0], list[3]), ("list", "vertex_indices"));
            let count = next(list[1]) as usize;
            let corners = (0..count).map(|_| next(list[2]) as usize).collect();
            let properties =
                elements[1].1[1..].iter().map(|property| (property[1].to_string(), next(property[0])));
            faces.push((corners, properties.collect()));
        }
        assert!(rest.is_empty());
        Ply { header, points, faces }
    }

    /// Each edge is of two faces, which run along it in opposite directions.
    fn is_closed(&self) -> bool {
        let mut uses: HashMap<[usize; 2], [u32; 2]> = HashMap::new();
        for (corners, _) in &self.faces {
            for (at, &from) in corners.iter().enumerate() {
                let to = corners[(at + 1) % corners.len()];
                uses.entry([from.min(to), from.max(to)]).or_default()[usize::from(from > to)] += 1;
            }
        }
        uses.values().all(|uses| *uses == [1, 1])
    }

    /// Areas by serial numbers.
    fn areas(&self) -> HashMap<u64, f64> {
        let mut areas: HashMap<u64, f64> = HashMap::new();
        for (corners, properties) in &self.faces {
            *areas.entry(properties["serial"] as u64).or_default() += self.area(corners);
        }
        areas
    }

    /// Area of a flat face.
    fn area(&self, corners: &[usize]) -> f64 {
        let mut sum = [0.0; 3];
        let first = self.points[corners[0]];
        for pair in corners[1..].windows(2) {
            let [u, v] = [pair[0], pair[1]].map(|corner| {
                let at = self.points[corner];
                [at[0] - first[0], at[1] - first[1], at[2] - first[2]]
            });
            sum[0] += u[1] * v[2] - u[2] * v[1];
            sum[1] += u[2] * v[0] - u[0] * v[2];
            sum[2] += u[0] * v[1] - u[1] * v[0];
        }
        sum.iter().map(|c| c * c).sum::<f64>().sqrt() / 2.0
    }
}

fn made(folder: &Folder, name: &str, arguments: &[&str]) -> Vec<u8> {
    let path = folder.path(name);
    let output = run("tess3", &[arguments, &["-o", &path]].concat(), b"");
    assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    std::fs::read(path).unwrap()
}

fn table(arguments: &[&str]) -> Rows {
    let output = run("tess3", arguments, b"");
    assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    Rows::new(&String::from_utf8(output.stdout).unwrap())
}

const ATOMS: [&str; 3] = ["--hetatm", "off", "--radii=bondi"];

#[test]
fn the_surface_of_a_protein_is_closed_and_has_the_areas_of_the_table() {
    let folder = Folder::new();
    let file = sample("1aki.cif");
    let arguments = [&[&file[..], "--sasa"], &ATOMS[..]].concat();
    let ply = Ply::read(&made(&folder, "a.ply", &[&arguments[..], &["--resolution", "0.2"]].concat()));
    for property in ["float nx", "uchar red", "int serial"] {
        assert!(ply.header.contains(&format!("property {property}\n")), "{}", ply.header);
    }
    assert!(ply.is_closed());
    let areas = ply.areas();
    let rows = table(&arguments);
    for row in 0..rows.len() {
        let (exact, serial) = (rows.number(row, "area"), rows.number(row, "serial") as u64);
        let found = areas.get(&serial).copied().unwrap_or(0.0);
        assert!((exact - found).abs() < 0.02 * exact + 0.05, "{serial}: {exact} {found}");
    }
    // The same in VTU, as far as its head tells.
    let vtu = made(&folder, "a.vtu", &[&arguments[..], &["--resolution", "0.2"]].concat());
    let head = String::from_utf8_lossy(&vtu[..3000]).into_owned();
    let counts = format!("NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", ply.points.len(), ply.faces.len());
    for part in
        [&counts[..], "<CellData", "\"serial\"", "\"element\"", "\"chain\"", "\"residue\"", "\"area\""]
    {
        assert!(head.contains(part), "{part}: {head}");
    }
}

#[test]
fn the_molecular_surface_is_closed_and_has_labels_of_atoms() {
    let folder = Folder::new();
    let file = sample("1aki.cif");
    for (probe, most) in [("1.4", 0.02), ("0", 0.02)] {
        let arguments = [&[&file[..], "--ses", "--probe", probe], &ATOMS[..]].concat();
        let ply = Ply::read(&made(&folder, "a.ply", &[&arguments[..], &["--resolution", "0.3"]].concat()));
        assert!(ply.is_closed());
        let (areas, rows) = (ply.areas(), table(&arguments));
        let exact: HashMap<u64, f64> = (0..rows.len())
            .map(|row| (rows.number(row, "serial") as u64, rows.number(row, "area")))
            .collect();
        let [found, expected] = [areas.values().sum::<f64>(), exact.values().sum()];
        assert!((found - expected).abs() < most * expected, "{found} {expected}");
        assert!(areas.keys().all(|serial| exact.contains_key(serial)));
    }
}

#[test]
fn contacts_are_polygons() {
    let folder = Folder::new();
    let file = sample("1aki.cif");
    let arguments = [&[&file[..], "--contact-areas", "--min-area", "0.5"], &ATOMS[..]].concat();
    let ply = Ply::read(&made(&folder, "a.ply", &[&arguments[..], &["--resolution", "0.1"]].concat()));
    let rows = table(&arguments);
    assert_eq!(ply.faces.len(), rows.len());
    for (row, (corners, properties)) in ply.faces.iter().enumerate() {
        for name in ["serial1", "serial2"] {
            assert_eq!(properties[name], rows.number(row, name));
        }
        let exact = rows.number(row, "area");
        assert!((properties["area"] - exact).abs() < 1e-6 && (ply.area(corners) - exact).abs() < 0.01);
    }
}

#[test]
fn pockets_have_bodies_linings_and_mouths() {
    let range = || 0..=6;
    let sites = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
    let shell = sites.filter(|p: &[i32; 3]| p.iter().any(|&c| c == 0 || c == 6) && *p != [3, 3, 0]);
    let atoms: Vec<Record> =
        (1..).zip(shell).map(|(serial, p)| Record::carbon(serial, p.map(|c| f64::from(c) * 2.0))).collect();
    let folder = Folder::new();
    let file = folder.path("cage.pdb");
    folder.file("cage.pdb", pdb(&atoms));
    let arguments = [&file[..], "--pockets", "--radii=bondi", "--probe", "0"];
    let rows = table(&arguments);
    let mouths = table(&[&arguments[..], &["--mouths"]].concat());
    assert_eq!(mouths.text(0, "mouth"), "1");
    assert!((mouths.number(0, "area") - rows.number(0, "mouth_area")).abs() < 1e-9);
    let around = table(&[&arguments[..], &["--mouths", "--per", "atom"]].concat());
    let at_first = (0..around.len()).filter(|&row| around.text(row, "pocket") == "1").count();
    assert_eq!(at_first.to_string(), mouths.text(0, "atoms"));
    // The nearest atoms around the one that is missing.
    assert_eq!(at_first, 4);
    let lining = Ply::read(&made(&folder, "a.ply", &[&arguments[..], &["--resolution", "0.2"]].concat()));
    let of_first = lining.faces.iter().filter(|(_, properties)| properties["pocket"] == 1.0);
    let area: f64 = of_first.map(|(corners, _)| lining.area(corners)).sum();
    let exact = rows.number(0, "area");
    assert!((area - exact).abs() < 0.05 * exact, "{area} {exact}");
    let vtu = made(&folder, "a.vtu", &arguments);
    let tetrahedra: f64 = (0..rows.len()).map(|row| rows.number(row, "tetrahedra")).sum();
    let head = String::from_utf8_lossy(&vtu[..1000]).into_owned();
    assert!(head.contains(&format!("NumberOfCells=\"{tetrahedra}\"")), "{head}");
    // Without the lining of pockets, their triangles are grey.
    let arguments = [&file[..], "--sasa", "--radii=bondi", "--probe", "0", "--colour-by", "pocket"];
    let whole = Ply::read(&made(&folder, "whole.ply", &arguments));
    let grey = |(_, properties): &&(_, HashMap<String, f64>)| properties["pocket"] == 0.0;
    let outside = whole.faces.iter().filter(grey).count();
    assert!(outside > 0 && outside < whole.faces.len());
}

#[test]
fn spview_draws_surfaces() {
    let folder = Folder::new();
    made(&folder, "a.ply", &[&sample("1aki.cif"), "--sasa", "--colour-by", "chain"]);
    let (ply, png) = (folder.path("a.ply"), folder.path("a.png"));
    for eye in [&[][..], &["--eye", "-90,45"]] {
        let output = run("spview", &[&["--width", "320", &ply, "-o", &png], eye].concat(), b"");
        assert!(output.status.success(), "{:?}", outcome(&output));
        let bytes = std::fs::read(&png).unwrap();
        assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 10_000);
    }
    let content = std::fs::read(&ply).unwrap();
    assert_outcome("spview", &["--fill", "none", &ply], b"", 2, "--fill is for streams");
    assert_outcome("spview", &["--eye", "nan,0", &ply], b"", 2, "two angles");
    assert_outcome("spview", &["-"], &content[..content.len() - 1], 3, "truncated");
    let empty = b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                  property float z\nend_header\n0 0 0\n";
    assert_outcome("spview", &["-"], empty, 2, "no triangles");
    let wrong = b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                  property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
                  0 0 0\n3 0 0 1\n";
    assert_outcome("spview", &["-"], wrong, 3, "face with vertex 1 of 1");
}

#[test]
fn flags_of_tables_and_meshes_do_not_mix() {
    let folder = Folder::new();
    let file = sample("1aki.cif");
    let ply = folder.path("a.ply");
    for (arguments, part) in [
        (&["--sasa", "--per", "residue", "-o", &ply][..], "--per is for tables"),
        (&["--sasa", "--volumes", "-o", &ply], "--volumes is a table"),
        (&["--pockets", "--mouths", "-o", &ply], "--mouths is a table"),
        (&["--sasa", "--resolution", "0.4"], "--resolution needs -o FILE.ply"),
        (&["--sasa", "--resolution", "0.001", "-o", &ply], "too fine"),
        (&["--sasa", "--resolution", "0", "-o", &ply], "too fine"),
        (&["--volumes", "--mouths"], "--mouths goes with --pockets"),
        (&["--contacts", "-o", &ply], "the name is that of a mesh"),
        (&["--sasa", "--colour-by", "chain", "--out-dir", "x"], "does not go with sweeps"),
    ] {
        assert_outcome("tess3", &[&[&file[..]], arguments].concat(), b"", 2, part);
    }
    let models = sample("1l2y.pdb.gz");
    assert_outcome("tess3", &[&models, "--sasa", "--model", "all", "-o", &ply], b"", 2, "2 models");
    assert!(!std::path::Path::new(&ply).exists());
}
