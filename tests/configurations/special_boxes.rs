//! ZP configurations of grids: null links, and theorem 8.2.4 against box splines.

use super::spline::b_spline;
use super::{check_facets, knots};
use spmesh_configurations::special::{self, Function, FunctionKind, Patch, Special, ZpSplit};
use spmesh_configurations::{self as configurations, Links, Rule};
use spmesh_reference::sets::Random;

const SPLITS: [ZpSplit; 4] = [
    ZpSplit { is_falling: false, is_upright: false },
    ZpSplit { is_falling: false, is_upright: true },
    ZpSplit { is_falling: true, is_upright: false },
    ZpSplit { is_falling: true, is_upright: true },
];

/// A box spline of integral one, by its recurrence (de Boor and Höllig, 1982), on coordinates along the first
/// two directions.
fn box_spline(x: [f64; 2], directions: &[[f64; 2]]) -> f64 {
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let pairs = (0..directions.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
    let independent = |&(i, j): &(usize, usize)| cross(directions[i], directions[j]) != 0.0;
    let Some((i, j)) = pairs.into_iter().find(independent) else { return 0.0 };
    let size = cross(directions[i], directions[j]);
    let mut shares = vec![0.0; directions.len()];
    (shares[i], shares[j]) = (cross(x, directions[j]) / size, cross(directions[i], x) / size);
    if directions.len() == 2 {
        return if shares.iter().all(|share| (0.0..=1.0).contains(share)) { 1.0 / size.abs() } else { 0.0 };
    }
    let terms = directions.iter().zip(&shares).enumerate().map(|(at, (direction, share))| {
        let others = [&directions[..at], &directions[at + 1..]].concat();
        let back = [x[0] - direction[0], x[1] - direction[1]];
        share * box_spline(x, &others) + (1.0 - share) * box_spline(back, &others)
    });
    terms.sum::<f64>() / (directions.len() - 2) as f64
}

fn grid(columns: i32, rows: i32, at: [f64; 2]) -> Vec<[f64; 2]> {
    let row = |j: i32| (0..columns).map(move |i| [at[0] + f64::from(i), at[1] + f64::from(j)]);
    (0..rows).flat_map(row).collect()
}

fn links_of(special: &Special, rule: &Rule) -> Links {
    let all = special.generate(rule, 1).expect("links");
    check_facets(&all[0], &all[1]).expect("facets");
    configurations::links(&special.knots, &all[1]).expect("links")
}

fn value(special: &Special, links: &Links, function: &Function, x: [f64; 2]) -> f64 {
    let b = |set: &[u32; 2]| b_spline(&special.knots, links.link(links.find(set).expect("a link")), x);
    function.terms.iter().map(|(set, factor)| factor * b(set)).sum()
}

fn face_functions(functions: &[Function]) -> Vec<([u32; 4], &Function)> {
    let face = |function| match function {
        &Function { kind: FunctionKind::Face(face), .. } => Some((face, function)),
        _ => None,
    };
    functions.iter().filter_map(face).collect()
}

#[test]
fn box_splines_have_known_values() {
    let directions = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    // The ZP element is 1/2 at the middle of its support, and its translates sum to one (Zwart, 1973).
    assert!((box_spline([1.5, 0.5 + 1e-12], &directions) - 0.5).abs() < 1e-9);
    let x = [0.317, 0.291];
    let translates = (-4..5).flat_map(|i| (-4..5).map(move |j| [x[0] + f64::from(i), x[1] + f64::from(j)]));
    let sum: f64 = translates.map(|x| box_spline(x, &directions)).sum();
    assert!((sum - 1.0).abs() < 1e-13, "{sum}");
}

#[test]
fn half_the_sides_of_a_face_are_a_box_spline() {
    let directions = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    let knots = knots(&grid(8, 8, [-3.0, 2.0]));
    for split in SPLITS {
        let zp = special::zp(&knots, split).expect("a grid");
        let links = links_of(&zp, &Rule::Delaunay);
        let functions = zp.functions(&links).expect("pairs");
        let faces = face_functions(&functions);
        assert_eq!(faces.len(), 25);
        let mut random = Random::new(3);
        for (face, function) in faces.iter().filter(|(face, _)| [18, 27, 28].contains(&face[0])) {
            assert_eq!((function.terms.len(), face[2]), (4, face[0] + 9));
            let at = zp.knots.at(face[0]);
            for _ in 0..200 {
                let [u, v] = [random.unit() * 4.0 - 1.5, random.unit() * 4.0 - 1.5];
                let found = value(&zp, &links, function, [at[0] + u, at[1] + v]);
                // The lower left corner of the centre face is at (1, 0) in this box spline.
                let expected = box_spline([u + 1.0, v], &directions);
                assert!((found - expected).abs() < 1e-14, "{split:?} {face:?} {u} {v}: {found} {expected}");
            }
        }
    }
}

#[test]
fn inside_of_a_grid_links_of_diagonals_are_null() {
    let knots = knots(&grid(7, 6, [0.0, 0.0]));
    for (split, is_zp) in SPLITS.iter().map(|&split| (split, true)).chain([(ZpSplit::default(), false)]) {
        let mut zp = special::zp(&knots, split).expect("a grid");
        if !is_zp {
            zp.diagonals = special::Diagonals::default();
        }
        let links = links_of(&zp, &Rule::Ear);
        let mut not_null = 0;
        for (i, j) in (1..5).flat_map(|i| (1..4).map(move |j| (i, j))) {
            let corner = i + 7 * j;
            let [p, q] = if split.is_falling { [corner + 1, corner + 7] } else { [corner, corner + 8] };
            let is_null = |set: [u32; 2]| links.find(&set).is_none_or(|at| links.link(at).is_null());
            not_null += u32::from(!is_null([p, q]));
            assert!(!is_null([corner, corner + 1]) || !is_zp);
        }
        assert_eq!(not_null == 0, is_zp, "{split:?}");
    }
}

#[test]
fn shares_of_b_splines_sum_to_one() {
    let knots = knots(&grid(6, 7, [0.0, 0.0]));
    let zp = special::zp(&knots.clamped(2).expect("a hull"), ZpSplit::default()).expect("a grid");
    let links = links_of(&zp, &Rule::Random(2));
    let functions = zp.functions(&links).expect("pairs");
    let mut random = Random::new(8);
    for _ in 0..30 {
        let x = [random.unit() * 5.0, random.unit() * 6.0];
        let sum: f64 = functions.iter().map(|function| value(&zp, &links, function, x)).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{x:?}: {sum}");
    }
    let shares: Vec<f64> = functions.iter().flat_map(|f| f.terms.iter().map(|term| term.1)).collect();
    assert!(shares.contains(&0.5) && shares.contains(&1.0));
    assert!(
        zp.functions(&configurations::links(&zp.knots, &zp.start.configurations()).expect("links")).is_err()
    );
}

#[test]
fn patches_are_stitched() {
    let square = |origin, cells| Patch { origin, steps: [[1.0, 0.0], [0.0, 1.0]], cells };
    let slanted = Patch { origin: [0.0, 8.0], steps: [[1.0, 0.5], [-0.5, 1.0]], cells: [5, 4] };
    // One on top of the other with T-junctions, one beside them with a gap, and a slanted one.
    let all = [
        square([0.0, 0.0], [4, 4]),
        Patch { origin: [0.0, 4.0], steps: [[0.5, 0.0], [0.0, 0.5]], cells: [8, 5] },
        square([5.5, 1.25], [5, 4]),
        slanted,
    ];
    let stitched = special::patches(&all, &[[4.75, 3.0], [0.0, 0.0]], ZpSplit::default()).expect("patches");
    let expected = 25 + 9 * 6 - 5 + 30 + 30 + 1;
    assert_eq!(stitched.knots.len(), expected, "knots at one place are one");
    let links = links_of(&stitched, &Rule::Delaunay);
    let functions = stitched.functions(&links).expect("pairs");
    let faces = face_functions(&functions);
    // T-junctions take one row of cells from the first patch: its upper cells have knots on their sides.
    let inner = |cells: [usize; 2]| (cells[0] - 2) * (cells[1] - 2);
    assert_eq!(faces.len(), inner([4, 3]) + inner([8, 5]) + inner([5, 4]) + inner([5, 4]));
    let directions = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    let mut random = Random::new(6);
    for (face, function) in faces {
        let [at, e, f] = [face[0], face[1], face[3]].map(|id| stitched.knots.at(id));
        let ([a, c], [b, d]) = ([e[0] - at[0], e[1] - at[1]], [f[0] - at[0], f[1] - at[1]]);
        let x = [random.unit() * 2.0 - 0.5, random.unit() * 2.0 - 0.5];
        let place = [at[0] + a * x[0] + b * x[1], at[1] + c * x[0] + d * x[1]];
        let (found, expected) =
            (value(&stitched, &links, function, place), box_spline([x[0] + 1.0, x[1]], &directions));
        assert!((found - expected).abs() < 1e-13, "{face:?}: {found} {expected}");
    }
}

#[test]
fn knots_that_are_no_grid_are_errors() {
    let triangle = knots(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5]]);
    let error = special::zp(&triangle, ZpSplit::default()).expect_err("no square").to_string();
    assert!(error.contains("no four knots are the corners"), "{error}");
    let mut points = grid(5, 5, [0.0, 0.0]);
    points.push([1.5, 1.25]);
    points.push([2.0, 2.5]);
    let zp = special::zp(&knots(&points), ZpSplit::default()).expect("a grid");
    let links = links_of(&zp, &Rule::Delaunay);
    let functions = zp.functions(&links).expect("pairs");
    assert!(face_functions(&functions).is_empty(), "knots inside and on a side of cells");
}

#[test]
fn bad_patches_are_errors() {
    let patch = Patch { origin: [0.0, 0.0], steps: [[1.0, 0.0], [0.0, 1.0]], cells: [3, 3] };
    let refused = |patches: &[Patch]| {
        special::patches(patches, &[], ZpSplit::default()).expect_err("bad patches").to_string()
    };
    let other = |change: &dyn Fn(&mut Patch)| {
        let mut other = patch;
        change(&mut other);
        refused(&[patch, other])
    };
    assert!(refused(&[]).contains("one line"));
    assert!(other(&|p| p.steps.swap(0, 1)).contains("patch 1: the second step is not counterclockwise"));
    assert!(other(&|p| p.cells = [0, 2]).contains("patch 1: it has no cells"));
    assert!(other(&|p| p.cells = [u32::MAX, u32::MAX]).contains("at most"));
    assert!(other(&|p| p.origin = [f64::NAN, 0.0]).contains("patch 1: a number is not finite"));
    assert!(other(&|p| p.steps[0] = [1e308, 0.0]).contains("coordinate is not finite"));
    assert!(other(&|p| p.origin = [0.5, 0.25]).contains("crosses that of another patch"));
}
