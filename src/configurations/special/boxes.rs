//! Configurations whose B-splines sum to box splines, the ZP elements, inside grids (thesis 8.2).
//!
//! Each cell of a grid is split along the same diagonal. The link of a knot amid four cells is then a
//! hexagon. Its two corners that are neighbours along diagonals are cut as ears, and the diamond of the other
//! four corners is split (figure 8.3). Then links of diagonals are null, and the ZP element of a face is half
//! the sum of the B-splines of its four sides, for either diagonal and either split (theorem 8.2.4; the
//! printed factor 1/4! belongs to another normalisation).
//!
//! Constrained Delaunay triangulation and the rule determine the rest: links of knots on the border of a
//! grid, and everything between grids (8.2.5). A face has a box spline if all its corners are surrounded by
//! cells. The thesis drops all B-splines between such knots. Here the half that no box spline takes remains a
//! function, so that all functions sum to one.

use super::Special;
use super::basis::Collection;
use super::constrained::Constrained;
use crate::knots::Knots;
use crate::special::constrained::Diagonals;
use crate::surface::Start;
use foldhash::{HashMap, HashSet};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::{MAX_POINTS, distinct};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};

/// The directions in which cells, and the diamonds in links, are split.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ZpSplit {
    /// Cells are split from (1, 0) to (0, 1) instead of from (0, 0) to (1, 1).
    pub is_falling: bool,
    /// Diamonds are split from (0, -1) to (0, 1) instead of from (-1, 0) to (1, 0).
    pub is_upright: bool,
}

/// A grid of parallelograms: knots at `origin + i steps[0] + j steps[1]`.
///
/// Coordinates are rounded. With steps that make them exact, lines stay straight, and knots of touching
/// patches stay at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// The first knot.
    pub origin: Point2,
    /// The steps to the next knot of a row, and of a column; the second step is counterclockwise of the
    /// first.
    pub steps: [Point2; 2],
    /// Numbers of cells in a row and in a column.
    pub cells: [u32; 2],
}

/// A cell by its corners, counterclockwise from the lower left, in the coordinates of its grid.
type Cell = [u32; 4];

/// ZP configurations where `knots` have integer coordinates. Cells are unit squares whose corners are all
/// knots, none of them repeated. A square that has further knots inside or on its sides is triangulated, but
/// is not a cell.
///
/// # Errors
/// Usage, if no such square exists.
pub fn zp(knots: &Knots, split: ZpSplit) -> Result<Special> {
    let places = distinct(knots.points());
    let repeated: HashSet<u32> =
        (0..).zip(&places).filter(|&(id, &first)| id != first).map(|(_, &first)| first).collect();
    // All integers in this range are exact in f64.
    let whole = |c: f64| (c.fract() == 0.0 && c.abs() < (1u64 << 53) as f64).then_some(c as i64);
    let site = |id: u32| Some([whole(knots.at(id)[0])?, whole(knots.at(id)[1])?]);
    let ids = (0..knots.len() as u32).filter(|&id| places[id as usize] == id && !repeated.contains(&id));
    let sites: HashMap<[i64; 2], u32> = ids.clone().filter_map(|id| Some((site(id)?, id))).collect();
    let cell = |id: u32| -> Option<Cell> {
        let [x, y] = site(id)?;
        let corner = |neighbours, up| sites.get(&[x + neighbours, y + up]).copied();
        Some([id, corner(1, 0)?, corner(1, 1)?, corner(0, 1)?])
    };
    let cells: Vec<Cell> = ids.filter_map(cell).collect();
    if cells.is_empty() {
        let what = "no four knots are the corners of a square of the integer grid: scale the knots";
        return Err(Error::usage(what));
    }
    of_cells(knots.clone(), &[cells], split)
}

/// Grids, each with ZP configurations inside, that are stitched by a constrained Delaunay triangulation
/// (thesis 8.2.5).
///
/// `more` are knots between the grids. Knots of the patches come first, row by row; where patches touch,
/// knots at one place are merged. A square with knots on its sides (T-junctions of patches) or inside is not
/// a cell.
///
/// # Errors
/// Numbers that are not finite, steps that are not counterclockwise, too many knots, grid lines that cross.
pub fn patches(patches: &[Patch], more: &[Point2], split: ZpSplit) -> Result<Special> {
    let mut merged = Merged::default();
    let mut grids: Vec<Vec<Cell>> = Vec::new();
    let mut expected = more.len() as u64;
    for (number, patch) in patches.iter().enumerate() {
        expected = patch.check(expected).map_err(|error| error.at(format!("patch {number}")))?;
        grids.push(patch.cells(&mut merged));
    }
    more.iter().for_each(|&point| {
        merged.id(point);
    });
    of_cells(Knots::new(merged.points)?, &grids, split)
}

impl Patch {
    /// Checks the patch. Returns the number of knots with this patch; `before` is the number without it.
    fn check(&self, before: u64) -> Result<u64> {
        let [[a, b], [c, d]] = self.steps;
        if !self.steps.iter().chain([&self.origin]).flatten().all(|number| number.is_finite()) {
            let Patch { origin, steps: [u, v], .. } = self;
            let what =
                format!("a number is not finite: the patch starts at {origin:?} with steps {u:?} and {v:?}");
            return Err(Error::malformed(what));
        }
        if FiniteFloatPredicates::default().orient2d([0.0; 2], [a, b], [c, d]) != Sign::Positive {
            let what = "the second step is not counterclockwise of the first: exchange them";
            return Err(Error::usage(what));
        }
        if self.cells.contains(&0) {
            return Err(Error::usage("it has no cells: a row and a column need one at least"));
        }
        let [columns, rows] = self.cells.map(|count| u64::from(count) + 1);
        let count = columns.saturating_mul(rows).saturating_add(before);
        if count > MAX_POINTS as u64 {
            return Err(Error::usage(format!("{count} knots with it, at most {MAX_POINTS} can be handled")));
        }
        Ok(count)
    }

    fn cells(&self, merged: &mut Merged) -> Vec<Cell> {
        let [columns, rows] = self.cells;
        let at = |i: u32, j: u32| {
            [0, 1].map(|axis| {
                let steps = self.steps.map(|step| step[axis]);
                self.origin[axis] + f64::from(i) * steps[0] + f64::from(j) * steps[1]
            })
        };
        let ids: Vec<u32> = (0..=rows)
            .flat_map(|j| (0..=columns).map(move |i| (i, j)))
            .map(|(i, j)| merged.id(at(i, j)))
            .collect();
        let id = |i: u32, j: u32| ids[j as usize * (columns as usize + 1) + i as usize];
        let cell = |(i, j)| [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).map(cell).collect()
    }
}

/// Distinct points.
#[derive(Default)]
struct Merged {
    points: Vec<Point2>,
    ids: HashMap<[u64; 2], u32>,
}

impl Merged {
    fn id(&mut self, point: Point2) -> u32 {
        let next = self.points.len() as u32;
        // Adding zero turns -0 into +0.
        let id = *self.ids.entry(point.map(|c| (c + 0.0).to_bits())).or_insert(next);
        if id == next {
            self.points.push(point);
        }
        id
    }
}

/// Combines the cells of grids into one triangulation.
fn of_cells(knots: Knots, grids: &[Vec<Cell>], split: ZpSplit) -> Result<Special> {
    let mut predicates = FiniteFloatPredicates::default();
    let mut mesh = Constrained::new(&knots, Start::delaunay(&knots)?, &mut predicates);
    let sides = |cell: &Cell| [0, 1, 2, 3].map(|i| [cell[i], cell[(i + 1) % 4]]);
    for (number, grid) in grids.iter().enumerate() {
        for [a, b] in grid.iter().flat_map(sides) {
            if !mesh.is_fixed([a, b]) {
                mesh.fix(a, b).map_err(|_| crossing(number, [a, b].map(|id| knots.at(id))))?;
            }
        }
    }
    let (mut rows, mut collection) = (Vec::new(), Collection::default());
    let mut taken: HashMap<u32, usize> = HashMap::default();
    for (number, grid) in grids.iter().enumerate() {
        let cells: Vec<Cell> = grid.iter().copied().filter(|cell| is_empty(&mesh, cell)).collect();
        for [a, b, c, d] in &cells {
            if split.is_falling {
                mesh.fix(*b, *d)?
            } else {
                mesh.fix(*a, *c)?
            };
        }
        let inner = inner_knots(&cells);
        for &knot in inner.keys() {
            if let Some(other) = taken.insert(knot, number) {
                return Err(overlap(other, number, knots.at(knot)));
            }
        }
        rows.extend(inner.iter().flat_map(|(&knot, &around)| diagonals_around(knot, around, split)));
        collection.faces.extend(cells.iter().filter(|cell| cell.iter().all(|knot| inner.contains_key(knot))));
    }
    let start = mesh.into_start();
    Ok(Special { knots, start, diagonals: Diagonals::new(rows), collection })
}

/// The error for a side of a cell that crosses a side of another grid's cell.
#[cold]
fn crossing(patch: usize, [p, q]: [Point2; 2]) -> Error {
    let ([a, b], [c, d]) = (p, q);
    let what = format!(
        "the side of a cell from ({a}, {b}) to ({c}, {d}) crosses that of another patch: patches may touch along whole sides"
    );
    Error::usage(what).at(format!("patch {patch}"))
}

/// The error for two grids whose cells share an inner knot.
#[cold]
fn overlap(first: usize, second: usize, [x, y]: Point2) -> Error {
    let what =
        format!("patches {first} and {second} overlap at ({x}, {y}): patches may touch along whole sides");
    Error::usage(what)
}

/// Whether all sides of a cell are edges, and it consists of just two triangles.
fn is_empty(mesh: &Constrained, &[a, b, c, d]: &Cell) -> bool {
    let has_sides = [[a, b], [b, c], [c, d], [d, a]].iter().all(|&side| mesh.is_fixed(side));
    let [lower, upper] = [mesh.apex(a, b), mesh.apex(c, d)];
    let [right, left] = [mesh.apex(b, c), mesh.apex(d, a)];
    let rising = lower == Some(c) && upper == Some(a) && right == Some(a) && left == Some(c);
    let falling = lower == Some(d) && upper == Some(b) && right == Some(d) && left == Some(b);
    has_sides && (rising || falling)
}

/// Knots amid four cells of one grid, with their neighbours to the right, above, to the left and below.
fn inner_knots(cells: &[Cell]) -> HashMap<u32, [u32; 4]> {
    let mut corners: Vec<(u32, usize, usize)> = Vec::with_capacity(4 * cells.len());
    for (number, cell) in cells.iter().enumerate() {
        corners.extend(cell.iter().enumerate().map(|(corner, &knot)| (knot, corner, number)));
    }
    corners.sort_unstable();
    let around = |of_knot: &[(u32, usize, usize)]| match of_knot {
        &[(knot, 0, first), (_, 1, _), (_, 2, third), (_, 3, _)] => {
            let ([_, right, _, above], [_, below, _, left]) = (cells[first], cells[third]);
            Some((knot, [right, above, left, below]))
        }
        _ => None,
    };
    corners.chunk_by(|p, q| p.0 == q.0).filter_map(around).collect()
}

/// The diagonals of figure 8.3: two ears and a diamond.
fn diagonals_around(knot: u32, around: [u32; 4], split: ZpSplit) -> [(u32, [u32; 2]); 3] {
    let [right, above, left, below] = around;
    let ears =
        if split.is_falling { [[above, left], [below, right]] } else { [[right, above], [left, below]] };
    let diamond = if split.is_upright { [below, above] } else { [left, right] };
    [ears[0], ears[1], diamond].map(|edge| (knot, edge))
}
