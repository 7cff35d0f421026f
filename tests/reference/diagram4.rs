//! Delaunay diagrams in four dimensions by definition: every five points, tried against all others, in
//! 128-bit integers. Shares no code with the library.

use std::collections::{BTreeMap, BTreeSet};

/// A point with small integer coordinates.
pub type Point = [i64; 4];

/// Whether the cell is infinite, its vertices, and its neighbours.
pub type Cell = (bool, Vec<u32>, Vec<u32>);

/// The points in lexicographic order, without duplicates.
pub fn sorted(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_unstable();
    points.dedup();
    points
}

/// The determinants of the first rows in each set of as many columns, along their last row. A set is the sum
/// of 2^column.
fn minors(rows: &[&[i128]], columns: usize) -> Vec<i128> {
    let mut minors = vec![0; 1 << columns];
    minors[0] = 1;
    for set in 1..minors.len() {
        let size = set.count_ones() as usize;
        let Some(row) = rows.get(size - 1) else { continue };
        let mut sign = if size.is_multiple_of(2) { -1 } else { 1 };
        for column in (0..columns).filter(|column| set >> column & 1 == 1) {
            minors[set] += sign * row[column] * minors[set ^ 1 << column];
            sign = -sign;
        }
    }
    minors
}

/// The signed minors of a matrix with one more column than rows. Their dot product with a row is the
/// determinant of the matrix with that row put first.
fn complement(rows: &[&[i128]]) -> Vec<i128> {
    let minors = minors(rows, rows.len() + 1);
    let all = minors.len() - 1;
    (0..=rows.len()).map(|c| minors[all ^ 1 << c] * if c % 2 == 0 { 1 } else { -1 }).collect()
}

/// The row (1, x, y, z, t), followed by the lift if `is_lifted`.
fn row(point: &Point, is_lifted: bool) -> Vec<i128> {
    let point = point.map(i128::from);
    let lift = point.iter().map(|x| x * x).sum();
    std::iter::once(1).chain(point).chain(is_lifted.then_some(lift)).collect()
}

fn dot(u: &[i128], v: &[i128]) -> i128 {
    u.iter().zip(v).map(|(x, y)| x * y).sum()
}

/// Dimension of the affine hull, by elimination.
pub fn dimension(points: &[Point]) -> usize {
    let mut rows: Vec<Vec<i128>> = points.iter().map(|point| row(point, false)).collect();
    let mut rank = 0;
    for column in 0..5 {
        let Some(pivot) = (rank..rows.len()).find(|&i| rows[i][column] != 0) else { continue };
        rows.swap(rank, pivot);
        let (done, rest) = rows.split_at_mut(rank + 1);
        for other in rest {
            let (by, from) = (done[rank][column], other[column]);
            other.iter_mut().zip(&done[rank]).for_each(|(x, y)| *x = *x * by - from * y);
        }
        rank += 1;
    }
    rank - 1
}

/// All subsets of 0..len with `size` elements.
fn subsets(len: usize, size: usize) -> Vec<Vec<usize>> {
    let mut subsets = vec![Vec::new()];
    for _ in 0..size {
        subsets = subsets
            .iter()
            .flat_map(|subset: &Vec<usize>| {
                let next = subset.last().map_or(0, |last| last + 1);
                (next..len).map(move |i| [&subset[..], &[i]].concat())
            })
            .collect();
    }
    subsets
}

/// The rows on each hyperplane through rows that has no row below, or if `both`, no row on one of its sides.
fn supported(rows: &[Vec<i128>], both: bool) -> BTreeSet<Vec<u32>> {
    let mut found = BTreeSet::new();
    let Some(size) = rows.first().map(Vec::len) else { return found };
    for subset in subsets(rows.len(), size - 1) {
        let chosen: Vec<&[i128]> = subset.iter().map(|&i| &rows[i][..]).collect();
        let form = complement(&chosen);
        if form.iter().all(|&x| x == 0) {
            continue;
        }
        let up = form[size - 1].signum();
        if !both && up == 0 {
            continue;
        }
        let sides: Vec<i128> = rows.iter().map(|row| dot(&form, row).signum()).collect();
        let is_supported = if both {
            sides.iter().all(|&side| side >= 0) || sides.iter().all(|&side| side <= 0)
        } else {
            sides.iter().all(|&side| side * up >= 0)
        };
        if is_supported {
            found.insert((0..).zip(&sides).filter(|(_, side)| **side == 0).map(|(i, _)| i).collect());
        }
    }
    found
}

/// Vertices of the finite cells.
fn finite_cells(points: &[Point]) -> Vec<Vec<u32>> {
    let lifted: Vec<Vec<i128>> = points.iter().map(|point| row(point, true)).collect();
    supported(&lifted, false).into_iter().collect()
}

/// Vertices of the facets of a cell.
fn facets(points: &[Point], cell: &[u32]) -> Vec<Vec<u32>> {
    let rows: Vec<Vec<i128>> = cell.iter().map(|&v| row(&points[v as usize], false)).collect();
    let places = supported(&rows, true);
    places.into_iter().map(|list| list.into_iter().map(|i| cell[i as usize]).collect()).collect()
}

/// Ridges of a facet of a cell, of which `facets` lists all.
fn ridges(points: &[Point], facet: &[u32], facets: &[Vec<u32>]) -> BTreeSet<Vec<u32>> {
    let others = facets.iter().filter(|other| *other != facet);
    let shared =
        others.map(|other| facet.iter().copied().filter(|v| other.contains(v)).collect::<Vec<u32>>());
    let is_ridge = |list: &Vec<u32>| {
        let at: Vec<Point> = list.iter().map(|&v| points[v as usize]).collect();
        at.len() >= 3 && dimension(&at) == 2
    };
    shared.filter(is_ridge).collect()
}

/// det(b - a, c - a, d - a, e - a).
pub fn orientation(simplex: [Point; 5]) -> i128 {
    let rows = simplex.map(|point| row(&point, false));
    minors(&rows.each_ref().map(|row| &row[..]), 5)[31]
}

/// The diagram of distinct points in lexicographic order: finite cells sorted by vertices, then infinite
/// cells by facets of finite ones, each with the indices of its neighbours. No cells if all points lie in a
/// hyperplane.
///
/// Domain: coordinates below 1000 in magnitude. Cost: O(n^6), for up to about 30 points.
pub fn diagram(points: &[Point]) -> Vec<Cell> {
    let finite = finite_cells(points);
    let facets: Vec<Vec<Vec<u32>>> = finite.iter().map(|cell| facets(points, cell)).collect();
    let mut cells_of: BTreeMap<&Vec<u32>, Vec<usize>> = BTreeMap::new();
    for (i, list) in facets.iter().enumerate() {
        list.iter().for_each(|facet| cells_of.entry(facet).or_default().push(i));
    }
    let mut cells: Vec<Cell> = finite.iter().map(|list| (false, list.clone(), Vec::new())).collect();
    let mut links = BTreeSet::new();
    let mut infinite_of: BTreeMap<Vec<u32>, Vec<usize>> = BTreeMap::new();
    for (facet, of) in &cells_of {
        match of[..] {
            [one] => {
                let infinite = cells.len();
                cells.push((true, (*facet).clone(), Vec::new()));
                links.insert([one, infinite]);
                for ridge in ridges(points, facet, &facets[one]) {
                    infinite_of.entry(ridge).or_default().push(infinite);
                }
            }
            [one, other] => drop(links.insert([one, other])),
            _ => panic!("{of:?} share {facet:?}"),
        }
    }
    for (ridge, of) in infinite_of {
        assert_eq!(of.len(), 2, "infinite cells {of:?} share {ridge:?}");
        links.insert([of[0], of[1]]);
    }
    for [one, other] in links {
        cells[one].2.push(other as u32);
        cells[other].2.push(one as u32);
    }
    cells.iter_mut().for_each(|(_, _, neighbours)| neighbours.sort_unstable());
    cells
}
