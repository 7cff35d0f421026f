//! Wrong diagrams are refused: a diagram passes only if it is the diagram of its points.

use std::collections::BTreeMap;

use spmesh_audit::diagram::{Claim, check};

use super::diagram::audit;
use spmesh_reference::diagram4::{Cell, Point, diagram, sorted};
use spmesh_reference::sets::Random;
use spmesh_reference::sets4::{cells4, families, floats, grid, random_points};

const SEED: u64 = 20_260_405;

/// The remaining cells (`None` marks a removed one) in canonical order, with neighbours renumbered and
/// sorted.
fn renumbered(cells: Vec<Option<Cell>>) -> Vec<Cell> {
    let key = |i: &usize| cells[*i].as_ref().map(|(is_infinite, vertices, _)| (*is_infinite, vertices));
    let mut order: Vec<usize> = (0..cells.len()).filter(|&i| cells[i].is_some()).collect();
    order.sort_by(|i, j| key(i).cmp(&key(j)));
    let rename = |old: &u32| order.iter().position(|&i| i == *old as usize).map(|i| i as u32);
    let rewritten =
        order.iter().filter_map(|&i| cells[i].as_ref()).map(|(is_infinite, vertices, neighbours)| {
            let mut neighbours: Vec<u32> = neighbours.iter().filter_map(rename).collect();
            neighbours.sort_unstable();
            neighbours.dedup();
            (*is_infinite, vertices.clone(), neighbours)
        });
    rewritten.collect()
}

/// The cells after `j` is merged into `i`.
fn merge(cells: &[Cell], i: usize, j: usize) -> Vec<Cell> {
    let mut merged = cells[i].clone();
    merged.1.extend(&cells[j].1);
    merged.2.extend(&cells[j].2);
    merged.2.retain(|&neighbour| neighbour as usize != i && neighbour as usize != j);
    merged.1.sort_unstable();
    merged.1.dedup();
    let mut cells: Vec<Option<Cell>> = cells.iter().cloned().map(Some).collect();
    for cell in cells.iter_mut().flatten() {
        cell.2
            .iter_mut()
            .filter(|neighbour| **neighbour == j as u32)
            .for_each(|neighbour| *neighbour = i as u32);
    }
    (cells[i], cells[j]) = (Some(merged), None);
    renumbered(cells)
}

/// Cells without cell `i`.
fn without(cells: &[Cell], i: usize) -> Vec<Cell> {
    let mut cells: Vec<Option<Cell>> = cells.iter().cloned().map(Some).collect();
    cells[i] = None;
    renumbered(cells)
}

#[test]
fn merged_and_missing_cells_are_refused() {
    let mut random = Random::new(SEED);
    for points in families(&mut random).into_iter().chain([grid([3, 2, 2, 2])]) {
        let cells = diagram(&points);
        for i in 0..cells.len() {
            assert!(audit(&points, &without(&cells, i)).is_err(), "without {i}: {cells:?}");
            for &j in cells[i].2.iter().filter(|&&j| cells[j as usize].0 == cells[i].0) {
                assert!(audit(&points, &merge(&cells, i, j as usize)).is_err(), "{i} with {j}: {cells:?}");
            }
            let twice = [&cells[..=i], &cells[i..]].concat();
            assert!(audit(&points, &twice).is_err(), "{i} twice: {cells:?}");
        }
    }
}

/// Hull facets of the two cubes that lie in one hyperplane are two infinite cells.
#[test]
fn coplanar_facets_of_different_cells_stay_apart() {
    let points = grid([3, 2, 2, 2]);
    let cells = diagram(&points);
    let mut merges = 0;
    for i in 2..cells.len() {
        for &j in cells[i].2.iter().filter(|&&j| j as usize > i) {
            let (one, other) = (&cells[i].1, &cells[j as usize].1);
            let is_coplanar = (0..4).any(|axis| {
                let mut all = one.iter().chain(other).map(|&v| points[v as usize][axis]);
                let first = all.next();
                all.all(|x| Some(x) == first)
            });
            if is_coplanar {
                assert_eq!(
                    audit(&points, &merge(&cells, i, j as usize)).unwrap_err().claim,
                    Claim::Neighbours
                );
                merges += 1;
            }
        }
    }
    assert_eq!(merges, 6);
}

/// The points on a grid 20 times as fine, each moved a little. Points that agree in their first coordinates
/// still agree in them, so their order does not change.
fn nudge(points: &[Point], random: &mut Random) -> Vec<Point> {
    let mut steps: BTreeMap<&[i64], i64> = BTreeMap::new();
    let moved = points.iter().map(|point| {
        [0, 1, 2, 3]
            .map(|i| 20 * point[i] + *steps.entry(&point[..=i]).or_insert_with(|| random.integer(-2, 2)))
    });
    moved.collect()
}

/// A cube that is cut as if its corners had moved a little gives a consistent diagram, but its pieces share a
/// sphere.
#[test]
fn diagrams_of_other_points_are_refused() {
    let mut random = Random::new(SEED + 1);
    let (mut refused, mut same) = ([0; Claim::ALL.len()], 0);
    let sets: Vec<Vec<Point>> = (0..6).flat_map(|_| families(&mut random)).collect();
    for points in sets.into_iter().filter(|points| points.len() <= 13) {
        if points.iter().flatten().any(|x| x.abs() > 40) {
            continue;
        }
        let nudged = nudge(&points, &mut random);
        let (expected, other) = (diagram(&points), diagram(&nudged));
        audit(&nudged, &other).unwrap();
        match audit(&points, &other) {
            Ok(_) => {
                assert_eq!(expected, other);
                same += 1;
            }
            Err(violation) => {
                assert_ne!(expected, other, "{violation}");
                assert!(!violation.vertices.is_empty(), "{violation}");
                refused[violation.claim as usize] += 1;
            }
        }
    }
    assert!(refused[Claim::Delaunay as usize] + refused[Claim::Spheres as usize] > 5, "{refused:?}, {same}");
}

#[test]
fn a_cube_in_two_prisms_is_refused() {
    let points = grid([2; 4]);
    let nudged: Vec<Point> =
        points.iter().map(|&[x, y, z, t]| [20 * x + x * y, 20 * y + x * y, 20 * z, 20 * t]).collect();
    let split = diagram(&nudged);
    assert_eq!(split.iter().filter(|cell| !cell.0).count(), 2);
    assert_eq!(audit(&points, &split).unwrap_err().claim, Claim::Delaunay);
}

#[test]
fn every_mutation_is_refused() {
    let mut random = Random::new(SEED + 2);
    let (mut refused, mut by_claim) = (0, [0; Claim::ALL.len()]);
    for round in 0..60 {
        let side = [2, 3, 4, 30][round % 4];
        let count = 7 + round % 5;
        let points = random_points(&mut random, count, side);
        let correct = diagram(&points);
        if correct.is_empty() {
            continue;
        }
        for _ in 0..60 {
            let mut cells = correct.clone();
            for _ in 0..=random.integer(0, 2) {
                mutate(&mut cells, points.len(), &mut random);
            }
            match audit(&points, &cells) {
                Ok(_) => assert_eq!(cells, correct, "round {round}: {points:?}"),
                Err(violation) => {
                    assert_ne!(cells, correct, "round {round}: {violation} of {points:?}");
                    refused += 1;
                    by_claim[violation.claim as usize] += 1;
                }
            }
        }
    }
    assert!(refused > 2_000, "{refused}");
    for claim in [Claim::Cells, Claim::Order, Claim::Neighbours, Claim::Facets, Claim::Spheres] {
        assert!(by_claim[claim as usize] > 0, "{claim:?} found nothing: {by_claim:?}");
    }
}

/// One point moves: the old cells pass only if they are still the diagram.
#[test]
fn moved_points_are_refused_unless_the_diagram_is_theirs() {
    let mut random = Random::new(SEED + 3);
    let mut passed = [0; 2];
    for round in 0..250 {
        let count = 6 + round % 4;
        let points = random_points(&mut random, count, [2, 3, 6, 20][round % 4]);
        let cells = diagram(&points);
        let mut moved = points.clone();
        let i = random.integer(0, points.len() as i64 - 1) as usize;
        moved[i][random.integer(0, 3) as usize] += random.integer(-1, 1);
        let is_right = sorted(moved.clone()) == moved && diagram(&moved) == cells;
        let found = audit(&moved, &cells);
        assert_eq!(found.is_ok(), is_right, "{found:?} of {moved:?}: {cells:?}");
        passed[usize::from(is_right)] += 1;
    }
    assert!(passed.iter().all(|&count| count > 20), "{passed:?}");
}

#[test]
fn points_out_of_order_or_not_finite_are_refused() {
    let points = floats(&grid([2; 4]));
    let cells = cells4(&diagram(&grid([2; 4])));
    for value in [f64::NAN, f64::INFINITY, -1.0, 1.0] {
        let mut damaged = points.clone();
        damaged[5][0] = value;
        let violation = check(&damaged, &cells).unwrap_err();
        assert_eq!(violation.claim, Claim::Points, "{violation}");
        assert!(violation.to_string().contains(" at ("), "{violation}");
    }
    let mut unused = points.clone();
    unused.push([2.0; 4]);
    assert_eq!(check(&unused, &cells).unwrap_err().claim, Claim::Vertices);
}

fn pick(random: &mut Random, len: usize) -> usize {
    random.integer(0, len as i64 - 1) as usize
}

fn mutate(cells: &mut Vec<Cell>, points: usize, random: &mut Random) {
    let (i, j) = (pick(random, cells.len()), pick(random, cells.len()));
    let vertex = pick(random, points + 1) as u32;
    let place = pick(random, cells[i].1.len());
    match random.integer(0, 9) {
        0 => cells[i].1[place] = vertex,
        1 => {
            cells[i].1[place] = vertex;
            cells[i].1.sort_unstable();
            *cells = renumbered(cells.iter().cloned().map(Some).collect());
        }
        2 => drop(cells[i].1.remove(place)),
        3 => {
            cells[i].1.push(vertex);
            cells[i].1.sort_unstable();
            cells[i].1.dedup();
            *cells = renumbered(cells.iter().cloned().map(Some).collect());
        }
        4 => drop(cells[i].2.pop()),
        5 => {
            cells[i].2.retain(|&k| k as usize != j);
            cells[j].2.retain(|&k| k as usize != i);
        }
        6 => {
            for (one, other) in [(i, j), (j, i)] {
                cells[one].2.push(other as u32);
                cells[one].2.sort_unstable();
                cells[one].2.dedup();
            }
        }
        7 => cells.swap(i, j),
        8 => cells[i].0 = !cells[i].0,
        _ if cells.len() > 1 => *cells = merge_or_drop(cells, i, j),
        _ => (),
    }
    // Further mutations need a cell, and cells with vertices.
    cells.retain(|cell| !cell.1.is_empty());
    if cells.is_empty() {
        cells.push((false, vec![0], vec![0]));
    }
}

fn merge_or_drop(cells: &[Cell], i: usize, j: usize) -> Vec<Cell> {
    if i == j { without(cells, i) } else { merge(cells, i, j) }
}
