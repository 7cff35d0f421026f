//! The audit of 4D diagrams: it passes the diagrams that brute force finds, at every size of coordinates.

use spmesh_audit::diagram::{Claim, Proof, Violation, check, check_simplices};
use spmesh_stream::model::cells4::Point4;

use spmesh_reference::diagram4::{Cell, Point, diagram, orientation};
use spmesh_reference::sets::Random;
use spmesh_reference::sets4::{cells4, families, floats, grid, random_points};

const SEED: u64 = 20_260_404;

pub fn audit(points: &[Point], cells: &[Cell]) -> Result<Proof, Violation> {
    check(&floats(points), &cells4(cells))
}

#[test]
fn diagrams_by_brute_force_pass() {
    let mut random = Random::new(SEED);
    let mut shapes = [0; 3];
    for points in (0..4).flat_map(|_| families(&mut random)) {
        let cells = diagram(&points);
        let proof = audit(&points, &cells).unwrap_or_else(|e| panic!("{e} of {points:?}: {cells:?}"));
        let infinite = cells.iter().filter(|cell| cell.0).count();
        assert_eq!(
            (proof.vertices, proof.cells, proof.infinite),
            (points.len(), cells.len() - infinite, infinite)
        );
        shapes[usize::from(proof.cells > 0) + usize::from(proof.simplices < proof.cells)] += 1;
    }
    assert!(shapes[1..].iter().all(|&count| count > 10), "{shapes:?}");
}

#[test]
fn faces_of_cubes_are_counted() {
    let expected = [([2, 2, 2, 2], [16, 32, 24, 8, 1, 8]), ([3, 2, 2, 2], [24, 52, 42, 15, 2, 14])];
    for (counts, [vertices, edges, polygons, facets, cells, infinite]) in expected {
        let points = grid(counts);
        let proof = audit(&points, &diagram(&points)).unwrap();
        let Proof { questions, .. } = proof;
        let (simplices, largest, exactly) = (0, 16, 0);
        let expected = Proof {
            vertices,
            edges,
            polygons,
            facets,
            cells,
            infinite,
            simplices,
            largest,
            questions,
            exactly,
        };
        assert_eq!(proof, expected);
    }
}

/// Coordinates of all sizes, and far from the origin, so that the audit decides with 128-bit integers, with
/// the floating-point filter, and with arbitrary precision.
#[test]
fn size_and_place_do_not_matter() {
    let mut random = Random::new(SEED + 1);
    let mut exactly = 0;
    for points in families(&mut random) {
        let cells = cells4(&diagram(&points));
        for scale in [5e-324, 1e-200, 2f64.powi(1000), 2f64.powi(40) + 1.0] {
            let scale = if scale == 1e-200 { 2f64.powi(-660) } else { scale };
            let scaled: Vec<Point4> = points.iter().map(|point| point.map(|x| x as f64 * scale)).collect();
            exactly += check(&scaled, &cells).unwrap_or_else(|e| panic!("{e}: {scaled:?}")).exactly;
        }
        let moved: Vec<Point4> = points.iter().map(|point| point.map(|x| 2f64.powi(50) - x as f64)).collect();
        let moved: Vec<Point4> = moved.iter().map(|point| point.map(|x| 2f64.powi(51) - x)).collect();
        check(&moved, &cells).unwrap_or_else(|e| panic!("{e}: {moved:?}"));
    }
    assert!(exactly > 0, "integers without limit were never asked");
}

/// A box with these sides is one cell. It is none once the last coordinate of any corner has moved by one
/// unit in the last place.
#[test]
fn sides_of_all_sizes_fit_together() {
    for sides in [[1.0; 4], [2f64.powi(70), 1.0, 2f64.powi(-40), 3.0], [1e-300, 1e150, 5e-324, 0.1]] {
        let points: Vec<Point4> =
            grid([2; 4]).iter().map(|point| [0, 1, 2, 3].map(|i| point[i] as f64 * sides[i])).collect();
        let cells = cells4(&diagram(&grid([2; 4])));
        check(&points, &cells).unwrap_or_else(|e| panic!("{e}: {sides:?}"));
        for corner in 0..16 {
            let mut moved = points.clone();
            let last = moved[corner][3];
            moved[corner][3] = if last == 0.0 { -5e-324 } else { last.next_up() };
            let violation = check(&moved, &cells).unwrap_err();
            assert!([Claim::Spheres, Claim::Points].contains(&violation.claim), "{violation}");
        }
    }
}

#[test]
fn points_without_a_volume_have_no_cells() {
    for points in [vec![], vec![[1, 2, 3, 4]], grid([3, 2, 2, 1]), grid([2, 1, 1, 2]), grid([4, 1, 1, 1])] {
        assert_eq!(diagram(&points), []);
        assert_eq!(audit(&points, &[]).map(|proof| proof.cells), Ok(0));
        assert!(check_simplices(&floats(&points), &[]).is_ok());
    }
    let violation = audit(&grid([2; 4]), &[]).unwrap_err();
    assert_eq!((violation.claim, violation.vertices.len()), (Claim::Covering, 5));
    assert_eq!(check_simplices(&floats(&grid([2; 4])), &[]).unwrap_err().claim, Claim::Covering);
}

/// The Kuhn triangulation of a grid: in each cube, the simplices along the monotone paths between two
/// opposite corners.
fn kuhn(counts: [i64; 4]) -> (Vec<Point>, Vec<[u32; 5]>) {
    let points = grid(counts);
    let number = |point: Point| points.binary_search(&point).ok().map(|i| i as u32);
    let mut simplices = Vec::new();
    for &corner in &points {
        for code in 0..256 {
            let axes = [code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6];
            let mut path = [corner; 5];
            for step in 0..4 {
                path[step + 1] = path[step];
                path[step + 1][axes[step]] += 1;
            }
            let Some(simplex) = path.map(number).into_iter().collect::<Option<Vec<u32>>>() else { continue };
            if path[4] == corner.map(|x| x + 1) {
                simplices.push(oriented(&points, simplex.try_into().unwrap()));
            }
        }
    }
    (points, simplices)
}

fn oriented(points: &[Point], mut simplex: [u32; 5]) -> [u32; 5] {
    if orientation(simplex.map(|v| points[v as usize])) < 0 {
        simplex.swap(3, 4);
    }
    simplex
}

#[test]
fn simplices_with_ties_pass_and_nothing_may_be_amiss() {
    let (points, simplices) = kuhn([3, 2, 2, 2]);
    let points = floats(&points);
    let proof = check_simplices(&points, &simplices).unwrap();
    assert_eq!((proof.cells, proof.simplices, proof.largest, proof.vertices), (48, 48, 5, 24));
    let refuse = |simplices: &[[u32; 5]]| check_simplices(&points, simplices).unwrap_err().claim;
    for i in 0..simplices.len() {
        let mut damaged = simplices.clone();
        damaged.remove(i);
        assert!([Claim::Boundary, Claim::Euler, Claim::Vertices].contains(&refuse(&damaged)));
        damaged.push(simplices[(i + 1) % 48]);
        assert_eq!(refuse(&damaged), Claim::Facets);
        damaged[47] = simplices[i];
        damaged[47].swap(0, 3);
        assert_eq!(refuse(&damaged), Claim::Cells);
        damaged[47][0] = 24;
        assert_eq!(refuse(&damaged), Claim::Cells);
    }
    let mut coincide = points.clone();
    coincide[3] = coincide[20];
    assert_eq!(check_simplices(&coincide, &simplices).unwrap_err().claim, Claim::Points);
    let unused = [&points[..], &[[0.5; 4]]].concat();
    assert_eq!(check_simplices(&unused, &simplices).unwrap_err().claim, Claim::Vertices);
    let apart: Vec<[u32; 5]> = simplices.iter().filter(|s| s.iter().all(|&v| v < 16)).copied().collect();
    check_simplices(&points[..16], &apart).unwrap();
}

/// Tries every set of positive simplices over six points. If all cells are simplices, only the set of the
/// diagram passes; otherwise only the two sets that split the larger cell pass.
#[test]
fn one_of_all_sets_of_simplices_passes() {
    let mut random = Random::new(SEED + 2);
    let mut ties = 0;
    for round in 0..300 {
        let points = random_points(&mut random, 6, 2 + round % 4);
        if points.len() < 6 {
            continue;
        }
        let all: Vec<[u32; 5]> = (0..points.len() as u32)
            .map(|left| (0..points.len() as u32).filter(|&v| v != left).collect::<Vec<u32>>())
            .filter_map(|list| <[u32; 5]>::try_from(list).ok())
            .filter(|simplex| orientation(simplex.map(|v| points[v as usize])) != 0)
            .map(|simplex| oriented(&points, simplex))
            .collect();
        let subset = |set: u32| {
            let chosen = all.iter().enumerate().filter(|(i, _)| set >> i & 1 == 1);
            chosen.map(|(_, simplex)| *simplex).collect::<Vec<_>>()
        };
        let sets = (0..1u32 << all.len()).map(subset);
        let passed: Vec<_> = sets.filter(|set| check_simplices(&floats(&points), set).is_ok()).collect();
        let cells = diagram(&points);
        let finite = || cells.iter().filter(|cell| !cell.0);
        if finite().all(|cell| cell.1.len() == 5) {
            let mut expected: Vec<Vec<u32>> = finite().map(|cell| cell.1.clone()).collect();
            expected.sort_unstable();
            let sort = |simplex: &[u32; 5]| {
                let mut list = simplex.to_vec();
                list.sort_unstable();
                list
            };
            let mut found: Vec<Vec<u32>> = passed.iter().flatten().map(sort).collect();
            found.sort_unstable();
            assert_eq!((passed.len(), found), (1, expected), "{points:?}");
        } else {
            ties += 1;
            assert_eq!(passed.len(), 2, "{points:?}");
        }
    }
    assert!(ties > 3, "{ties}");
}
