//! The alpha complex by its definition: tries all spheres through a simplex that could be the smallest empty
//! one.

use super::mesh::Mesh;
use super::molecules::{Record, Rows, cloud, pdb};
use crate::programs::{outcome, run};

type Point = [f64; 3];

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: Point, b: Point) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

/// The centre of the smallest sphere through points, in their affine hull (from Gram's matrix).
fn centre(points: &[Point]) -> Option<Point> {
    let vectors: Vec<Point> = points[1..].iter().map(|&p| minus(p, points[0])).collect();
    let n = vectors.len();
    let mut rows: Vec<Vec<f64>> = vectors
        .iter()
        .map(|&v| vectors.iter().map(|&w| 2.0 * dot(v, w)).chain([dot(v, v)]).collect())
        .collect();
    for i in 0..n {
        let pivot = (i..n).max_by(|&a, &b| rows[a][i].abs().total_cmp(&rows[b][i].abs()))?;
        rows.swap(i, pivot);
        if rows[i][i].abs() < 1e-9 {
            return None;
        }
        for other in (0..n).filter(|&other| other != i) {
            let factor = rows[other][i] / rows[i][i];
            let pivot_row = rows[i].clone();
            for (value, pivot) in rows[other].iter_mut().zip(pivot_row).skip(i) {
                *value -= factor * pivot;
            }
        }
    }
    let weights = (0..n).map(|i| rows[i][n] / rows[i][i]);
    let offsets = vectors.iter().zip(weights).map(|(v, weight)| v.map(|value| value * weight));
    Some(offsets.fold(points[0], |sum, offset| std::array::from_fn(|axis| sum[axis] + offset[axis])))
}

/// Radius of the smallest sphere through the corners of a simplex that has no point inside.
fn smallest_empty(all: &[Point], simplex: &[usize]) -> f64 {
    let n = all.len();
    let mut best = f64::INFINITY;
    let mut consider = |members: &[usize]| {
        let points: Vec<Point> = members.iter().map(|&i| all[i]).collect();
        let Some(centre) = centre(&points) else { return };
        let square = dot(minus(centre, points[0]), minus(centre, points[0]));
        let is_empty = all.iter().all(|&p| dot(minus(p, centre), minus(p, centre)) > square * (1.0 - 1e-9));
        if is_empty {
            best = best.min(square.sqrt());
        }
    };
    consider(simplex);
    for p in (0..n).filter(|p| simplex.len() < 4 && !simplex.contains(p)) {
        consider(&[simplex, &[p]].concat());
        for q in (p + 1..n).filter(|q| simplex.len() < 3 && !simplex.contains(q)) {
            consider(&[simplex, &[p, q]].concat());
        }
    }
    best
}

fn pairs<const N: usize>(rows: &Rows, columns: [&str; N]) -> Vec<[usize; N]> {
    let row = |row| columns.map(|column| rows.number(row, column) as usize / 10 - 1);
    (0..rows.len()).map(row).collect()
}

fn table(text: &str, arguments: &[&str]) -> Rows {
    let output = run("tess3", &[arguments, &["-"]].concat(), text.as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    Rows::new(&String::from_utf8(output.stdout).unwrap())
}

#[test]
fn simplices_are_those_with_a_small_empty_sphere() {
    for seed in 0..4 {
        let atoms = cloud(16, 9_000, 20 + seed);
        let text = pdb(&atoms);
        let points: Vec<Point> = atoms.iter().map(|atom| atom.at).collect();
        let edges = pairs(&table(&text, &["--contacts"]), ["serial1", "serial2"]);
        let tetrahedra = pairs(&table(&text, &["--table"]), ["serial1", "serial2", "serial3", "serial4"]);
        let of_edges: Vec<f64> = edges.iter().map(|edge| smallest_empty(&points, edge)).collect();
        let of_tetrahedra: Vec<f64> = tetrahedra.iter().map(|t| smallest_empty(&points, t)).collect();
        let mut radii: Vec<f64> = of_edges.iter().chain(&of_tetrahedra).copied().collect();
        radii.sort_unstable_by(f64::total_cmp);
        for radius in [0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 1000.0] {
            // Away from any threshold, because the radii here are rounded.
            let radius = radius + 1e-5;
            assert!(radii.iter().all(|r| (r - radius).abs() > 1e-6));
            let flag = format!("{radius}");
            let kept = |all: &[f64]| (0..all.len()).filter(|&i| all[i] < radius).collect::<Vec<_>>();
            let found = table(&text, &["--contacts", "--alpha", &flag]);
            let expected: Vec<[usize; 2]> = kept(&of_edges).into_iter().map(|i| edges[i]).collect();
            assert_eq!(pairs(&found, ["serial1", "serial2"]), expected, "{radius}");
            let expected: Vec<[usize; 4]> = kept(&of_tetrahedra).into_iter().map(|i| tetrahedra[i]).collect();
            for (row, [a, b]) in pairs(&found, ["serial1", "serial2"]).into_iter().enumerate() {
                let around = expected.iter().filter(|t| t.contains(&a) && t.contains(&b)).count();
                assert_eq!(found.number(row, "tetrahedra") as usize, around);
            }
            let found = table(&text, &["--table", "--alpha", &flag]);
            assert_eq!(pairs(&found, ["serial1", "serial2", "serial3", "serial4"]), expected, "{radius}");
        }
    }
}

/// A box of 1 x 2 x 2 Å: its diagonal is 3, so all tetrahedra have the circumradius 1.5 exactly.
fn brick() -> String {
    let corner = |i: u32| Record::carbon(10 * i + 10, [i & 1, i & 2, i >> 1 & 2].map(f64::from));
    pdb(&(0..8).map(corner).collect::<Vec<_>>())
}

#[test]
fn a_radius_on_the_threshold_is_enough_and_nothing_less_is() {
    let all = table(&brick(), &["--table"]).len();
    let contacts = table(&brick(), &["--contacts"]);
    let diagonals = (0..contacts.len()).filter(|&row| contacts.number(row, "distance") == 3.0).count();
    assert!(all >= 5 && contacts.len() >= 18);
    for radius in ["1.5", "1.50", "15e-1", ".15E+1"] {
        assert_eq!(table(&brick(), &["--table", "--alpha", radius]).len(), all, "{radius}");
        assert_eq!(table(&brick(), &["--contacts", "--alpha", radius]).len(), contacts.len(), "{radius}");
    }
    let less = "1.4999999999999999999999999999";
    assert_eq!(table(&brick(), &["--table", "--alpha", less]).len(), 0);
    assert_eq!(table(&brick(), &["--contacts", "--alpha", less]).len(), contacts.len() - diagonals);
    // The edges of the brick: four of length 1 and eight of length 2. Each has an empty sphere of half its
    // length as radius.
    for (radius, edges) in
        [("0.5", 4), ("0.49999999999999999999", 0), ("0.99999999999999999999", 4), ("1", 12)]
    {
        assert_eq!(table(&brick(), &["--contacts", "--alpha", radius]).len(), edges, "{radius}");
    }
}

#[test]
fn meshes_of_alpha_complexes_keep_all_points() {
    let text = pdb(&cloud(100, 9_000, 30));
    let output = run("tess3", &["--alpha", "1.8", "-"], text.as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    let mesh = Mesh::read(&output.stdout);
    assert_eq!(mesh.points.len(), 100);
    assert_eq!(mesh.tetrahedra.len(), table(&text, &["--table", "--alpha", "1.8"]).len());
    assert!(mesh.producer.contains("alpha complex of radius 1.8"), "{}", mesh.producer);
}

#[test]
fn other_numbers_than_positive_ones_are_no_radius() {
    for radius in ["0", "-1", "nan", "inf", "1.5A", "", "1e999", "1e-999"] {
        let flag = format!("--alpha={radius}");
        assert_eq!(outcome(&run("tess3", &[&flag, "-"], brick().as_bytes())).0, Some(2), "{radius}");
    }
}
