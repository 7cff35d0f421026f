//! The tables against values that are computed here in other ways.

use std::collections::BTreeMap;

use super::mesh::Mesh;
use super::molecules::{Record, Rows, cloud, models, pdb};
use crate::programs::{outcome, run};

fn table(text: &str, arguments: &[&str]) -> Rows {
    let output = run("tess3", &[arguments, &["-"]].concat(), text.as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    Rows::new(&String::from_utf8(output.stdout).unwrap())
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

/// Volume and circumradius from the six edge lengths: Heron's formula for tetrahedra, and the area 6 V R of
/// the triangle whose sides are the products of opposite edges.
fn from_lengths(p: [[f64; 3]; 4]) -> (f64, f64) {
    let d = |i: usize, j: usize| distance(p[i], p[j]);
    let heron = |a: f64, b: f64, c: f64| {
        let s = (a + b + c) / 2.0;
        (s * (s - a) * (s - b) * (s - c)).max(0.0).sqrt()
    };
    let square = |i: usize, j: usize| d(i, j).powi(2);
    let [ab, ac, ad] = [square(0, 1), square(0, 2), square(0, 3)];
    let x = ac + ad - square(2, 3);
    let y = ab + ad - square(1, 3);
    let z = ab + ac - square(1, 2);
    let volume =
        (4.0 * ab * ac * ad - ab * x * x - ac * y * y - ad * z * z + x * y * z).max(0.0).sqrt() / 12.0;
    let products = heron(d(0, 1) * d(2, 3), d(0, 2) * d(1, 3), d(0, 3) * d(1, 2));
    (volume, products / (6.0 * volume))
}

#[test]
fn volumes_and_circumradii_are_those_of_the_tetrahedra() {
    let atoms = cloud(200, 12_000, 11);
    let text = pdb(&atoms);
    let rows = table(&text, &["--table"]);
    let mesh = Mesh::read(&run("tess3", &["-"], text.as_bytes()).stdout);
    let mut found = Vec::new();
    for row in 0..rows.len() {
        let serials = [1, 2, 3, 4].map(|i| rows.number(row, &format!("serial{i}")) as u64);
        assert!(serials.windows(2).all(|pair| pair[0] < pair[1]), "atoms are in the order of the input");
        let points = serials.map(|serial| atoms[serial as usize / 10 - 1].at);
        for (i, serial) in (1..).zip(serials) {
            assert_eq!(rows.text(row, &format!("atom{i}")), format!("A/ALA/{}/CA", serial % 10_000));
        }
        let (volume, circumradius) = from_lengths(points);
        // The formulas lose digits for flat tetrahedra.
        let tolerance = 1e-6 * (1.0 + 1.0 / volume);
        let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < tolerance;
        assert!(close(rows.number(row, "volume"), volume), "{:?}: {volume}", rows.rows[row]);
        assert!(
            close(rows.number(row, "circumradius"), circumradius),
            "{:?}: {circumradius}",
            rows.rows[row]
        );
        assert_eq!(rows.text(row, "model"), "1");
        found.push(serials);
    }
    assert!(found.is_sorted());
    assert_eq!(found, mesh.by_label());
}

#[test]
fn contacts_are_the_edges_with_the_tetrahedra_around_them() {
    let atoms = cloud(200, 12_000, 12);
    let text = pdb(&atoms);
    let rows = table(&text, &["--contacts"]);
    let mesh = Mesh::read(&run("tess3", &["-"], text.as_bytes()).stdout);
    let mut around: BTreeMap<[u64; 2], u64> = BTreeMap::new();
    for t in mesh.by_label() {
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            *around.entry([t[i], t[j]]).or_default() += 1;
        }
    }
    assert_eq!(rows.len(), around.len());
    for (row, (edge, count)) in around.into_iter().enumerate() {
        let serials = [1, 2].map(|i| rows.number(row, &format!("serial{i}")) as u64);
        assert_eq!(serials, edge);
        assert_eq!(rows.number(row, "tetrahedra") as u64, count);
        let [a, b] = edge.map(|serial| atoms[serial as usize / 10 - 1].at);
        assert!((rows.number(row, "distance") - distance(a, b)).abs() < 1e-7);
    }
}

#[test]
fn slivers_are_measured_to_the_last_digit() {
    // A sliver, 0.001 high: its volume is 1000 * 1000 * 0.001 / 6.
    let corners = [[0.0, 0.0, 0.0], [1000.0, 0.0, 0.0], [0.0, 1000.0, 0.0], [1000.0, 1000.0, 0.001]];
    let atoms: Vec<Record> = (1..).zip(corners).map(|(i, at)| Record::carbon(i, at)).collect();
    let rows = table(&pdb(&atoms), &["--table"]);
    assert_eq!(rows.len(), 1);
    assert_eq!(rows.text(0, "volume"), "166.666667");
    // The centre is (500, 500, z) with 500000 + z^2 = 500000 + (z - 0.001)^2, so z = 0.0005.
    assert_eq!(rows.text(0, "circumradius"), "707.106781");
}

#[test]
fn coordinates_of_any_size_are_measured() {
    for (factor, volume, circumradius) in
        [("e-150", "1.66666667e-451", "8.66025404e-151"), ("e60", "1.66666667e179", "8.66025404e59")]
    {
        let corners = ["0 0 0", "1X 0 0", "0 1X 0", "0 0 1X"].map(|line| line.replace('X', factor));
        let rows = table(&(corners.join("\n") + "\n"), &["--table"]);
        if factor != "e-150" {
            assert_eq!(rows.text(0, "volume"), volume);
        }
        assert_eq!(rows.text(0, "circumradius"), circumradius);
    }
}

#[test]
fn names_tell_alternate_locations_and_insertion_codes() {
    let mut atoms = cloud(5, 9_000, 13);
    atoms[0] = Record { altloc: 'B', name: "N", residue: "GLY", chain: 'X', number: -3, ..atoms[0].clone() };
    let rows = table(&pdb(&atoms), &["--contacts", "--altloc", "all"]);
    assert_eq!(rows.label(0, "1"), "X/GLY/-3/N/B");
    assert_eq!(rows.label(0, "2"), "A/ALA/20/CA");
}

#[test]
fn all_models_share_one_table() {
    let text = models(&[cloud(20, 9_000, 14), cloud(25, 9_000, 15)]);
    for product in ["--table", "--contacts"] {
        let all = table(&text, &[product, "--model", "all"]);
        let each = ["1", "2"].map(|number| table(&text, &[product, "--model", number]).rows);
        assert_eq!(all.rows, each.concat());
    }
}
